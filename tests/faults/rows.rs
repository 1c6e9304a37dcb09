//! One row a fault: where it was seen, what it is here, and which check catches it.

use crate::checks::{
    along_rays, beams, cell, color, connected, emitters, flights, fog, gathers, glass, guided, ledger, light,
    media, numbers, outputs, phase, planes, point_light, points, progressive, shading, slab, threads, walls,
    weights,
};
use crate::support::scenes::{area_light, cuboid, rectangle};
use glam::DVec3;
use turbid::Spectrum;
use turbid::faults::Fault;
use turbid::photons::is_indirect;
use turbid::scene::Orders;
use turbid::stats::{normal_p, student_p};

/// A fault, inside or outside the library.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Planted {
    /// By a switch.
    Inside(Fault),
    /// Done to the library's raw numbers, as a user could.
    Outside,
}

impl Planted {
    /// The switch, if it has one.
    pub fn switch(self) -> Option<Fault> {
        match self {
            Planted::Inside(fault) => Some(fault),
            Planted::Outside => None,
        }
    }
}

/// A row of the table.
pub struct Row {
    /// What is planted.
    pub fault: Planted,
    /// What it is, as the document names it.
    pub title: &'static str,
    /// The check, as the document names it: its function.
    pub check_name: &'static str,
    /// Runs the check; told whether to do an outside fault.
    pub check: fn(bool),
}

const fn outside(title: &'static str, check_name: &'static str, check: fn(bool)) -> Row {
    Row { fault: Planted::Outside, title, check_name, check }
}

/// The row of a switch. A new fault does not compile until it has one.
const fn inside(fault: Fault) -> Row {
    let (title, check_name, check): (&str, &str, fn(bool)) = match fault {
        Fault::AlbedoTwice => {
            ("albedo applied twice", "single_scattering_is_the_closed_form", |_| single_scattering())
        }
        Fault::AlbedoNever => {
            ("albedo not applied", "single_scattering_is_the_closed_form", |_| single_scattering())
        }
        Fault::CosineTwice => {
            ("cosine counted twice on a diffuse surface", "irradiance_under_an_area_light", |_| {
                light::irradiance_under_an_area_light()
            })
        }
        Fault::EmissionUniform => {
            ("area light emits uniformly, not as the cosine", "photons_and_paths_cross_a_box_alike", |_| {
                lamp()
            })
        }
        Fault::BackwardIsotropic => {
            ("negative g sampled as isotropic", "drawn_moments_are_those_stated", |_| {
                phase::drawn_moments_are_those_stated()
            })
        }
        Fault::AsymmetryClamped => ("g cut at 0.99", "density_has_the_moments_it_states", |_| {
            phase::density_has_the_moments_it_states()
        }),
        Fault::SmallAsymmetryIgnored => {
            ("g below 1e-3 taken for 0", "density_has_the_moments_it_states", |_| {
                phase::density_has_the_moments_it_states()
            })
        }
        Fault::EvaluationMirrored => {
            ("sampling right, evaluation mirrored", "density_between_samples_is_the_step_in_u", |_| {
                phase::density_between_samples_is_the_step_in_u()
            })
        }
        Fault::UnitReachesOne => ("the largest random word gives 1", "the_largest_word_is_below_one", |_| {
            numbers::the_largest_word_is_below_one()
        }),
        Fault::TransmittanceUnderflows => {
            ("transmittance in single precision", "transmittance_keeps_its_digits", |_| {
                numbers::transmittance_keeps_its_digits()
            })
        }
        Fault::NonFiniteDropped => ("non-finite samples dropped", "nothing_non_finite_is_dropped", |_| {
            numbers::nothing_non_finite_is_dropped()
        }),
        Fault::SinglePrecisionMean => {
            ("running mean in single precision", "a_long_mean_does_not_drift", |_| {
                numbers::a_long_mean_does_not_drift()
            })
        }
        Fault::DepthForgotten => {
            ("flight forgets its depth between regions", "a_region_in_two_pieces_is_one", |_| {
                slab::a_region_in_two_pieces_is_one()
            })
        }
        Fault::AxisRaysMiss => ("rays along an axis miss a box", "a_box_is_seen_along_its_axes", |_| {
            numbers::a_box_is_seen_along_its_axes()
        }),
        Fault::NoRoulette => {
            ("no roulette in photon tracing", "collisions_are_the_integral_of_the_fluence", |_| {
                slab::collisions_are_the_integral_of_the_fluence(slab::by_histories)
            })
        }
        Fault::AreaForgotten => {
            ("direct light forgets the light's area", "a_light_is_the_sum_of_its_quarters", |_| {
                light::a_light_is_the_sum_of_its_quarters()
            })
        }
        Fault::BlocksByThreads => {
            ("as many blocks as threads", "moments_do_not_depend_on_the_threads", |_| {
                threads::moments_do_not_depend_on_the_threads()
            })
        }
        Fault::OrderOffByOne => {
            ("paths count an order too few", "single_scattering_is_the_closed_form", |_| single_scattering())
        }
        Fault::AbsoluteDeviation => {
            ("mean absolute deviation for the variance", "moments_by_hand", |_| numbers::moments_by_hand())
        }
        Fault::RootForgotten => {
            ("standard error without the root of n", "moments_by_hand", |_| numbers::moments_by_hand())
        }
        Fault::RejectedSetRadius => ("rejected photons set the radius", "the_k_nearest_are_accepted", |_| {
            walls::the_k_nearest_are_accepted()
        }),
        Fault::GridHalfCellOff => {
            ("a grid's samples half a cell off", "samples_lie_in_the_middles_of_cells", |_| {
                media::samples_lie_in_the_middles_of_cells()
            })
        }
        Fault::NullWeightForgotten => (
            "weights unchanged where a tentative collision is none",
            "each_channel_passes_as_its_depth_says",
            |_| media::each_channel_passes_as_its_depth_says(),
        ),
        Fault::StepForgotten => {
            ("a march forgets its step", "a_constant_source_is_marched_to_its_integral", |_| {
                walls::a_constant_source_is_marched_to_its_integral()
            })
        }
        Fault::SharedForOne => {
            ("a gather that steps share counts for one", "steps_that_share_a_gather_have_their_sum", |_| {
                gathers::steps_that_share_a_gather_have_their_sum()
            })
        }
        Fault::LobeForgotten => {
            ("learned directions weighted as though they were not", "guided_paths_find_as_much", |_| {
                guided::guided_paths_find_as_much()
            })
        }
        Fault::PartLost => ("one part of a heavy path lost", "guided_paths_stay_light", |_| {
            guided::guided_paths_stay_light()
        }),
        Fault::LedFlightsForgotten => {
            ("flights led to bright places keep their weight", "led_flights_are_as_many", |_| {
                flights::led_flights_are_as_many()
            })
        }
        Fault::RadianceUnscaled => {
            ("radiance not scaled by a refraction", "a_cavity_is_brighter_by_the_squared_index", |_| {
                glass::a_cavity_is_brighter_by_the_squared_index()
            })
        }
        Fault::PhotonPowerScaled => {
            ("photons scaled by a refraction", "photons_in_a_cavity_collide_as_its_fluence", |_| {
                glass::photons_in_a_cavity_collide_as_its_fluence()
            })
        }
        Fault::FresnelForgotten => {
            ("a dielectric reflects nothing", "photons_cross_a_refracting_slab", |_| {
                glass::photons_cross_a_refracting_slab()
            })
        }
        Fault::DirectInVolumeMap => {
            ("direct light in the volume map and by shadow rays", "a_foggy_room_keeps_its_ledger", |_| {
                ledger::a_foggy_room_keeps_its_ledger()
            })
        }
        Fault::CausticTwice => ("caustics in two maps", "a_clear_room_keeps_its_ledger", |_| {
            ledger::a_clear_room_keeps_its_ledger()
        }),
        Fault::StoredOnSurfaces => {
            ("surface estimates divided by stored photons", "a_clear_room_keeps_its_ledger", |_| {
                ledger::a_clear_room_keeps_its_ledger()
            })
        }
        Fault::LightColorIgnored => {
            ("a scene is grey whatever the colour of its lights", "two_lights_keep_their_colors", |_| {
                color::two_lights_keep_their_colors()
            })
        }
        Fault::LightByLargestChannel => (
            "lights chosen by their largest channel, weighted for the sum",
            "photons_carry_each_lights_power",
            |_| color::photons_carry_each_lights_power(),
        ),
        Fault::FillingColorIgnored => {
            ("a coloured filling of glass taken as grey", "a_colored_filling_passes_each_channel", |_| {
                color::a_colored_filling_passes_each_channel()
            })
        }
        Fault::StretchColorIgnored => (
            "a coloured homogeneous medium beside a varying one taken as grey",
            "colored_media_beside_a_varying_one",
            |_| color::colored_media_beside_a_varying_one(),
        ),
        Fault::EmissionColorIgnored => (
            "a medium is grey whatever the colour of its emission",
            "emission_is_reported_by_channel",
            |_| color::emission_is_reported_by_channel(),
        ),
        Fault::GlowColorOfAll => (
            "photons of an emitting medium in its mean colour",
            "medium_emission_has_the_color_of_its_place",
            |_| color::medium_emission_has_the_color_of_its_place(),
        ),
        Fault::GentleFogLevel => {
            ("height fog with a slope below 1e-3 taken for level", "gentle_slopes_have_their_depth", |_| {
                fog::gentle_slopes_have_their_depth()
            })
        }
        Fault::GridScaleForgotten => {
            ("a grid's scale forgotten beside its box", "a_grid_is_scaled_and_placed", |_| {
                fog::a_grid_is_scaled_and_placed()
            })
        }
        Fault::EmitterShareForgotten => {
            ("volumes of light counted aimed at and by chance", "a_furnace_is_as_bright_everywhere", |_| {
                emitters::a_furnace_is_as_bright_everywhere()
            })
        }
        Fault::WallForgotten => {
            ("the share of equal angles ignores the wall behind", "a_wall_ends_the_angles", |_| {
                fog::a_wall_ends_the_angles()
            })
        }
        Fault::FlightStretched => {
            ("free flights 0.3 % too long, in closed form", "flights_are_the_exact_inverse", |_| {
                flights::flights_are_the_exact_inverse()
            })
        }
        Fault::PieceStretched => ("the same, piece by piece", "flights_are_the_exact_inverse", |_| {
            flights::flights_are_the_exact_inverse()
        }),
        Fault::TrackStretched => {
            ("the same, by tentative collisions", "flights_are_the_exact_inverse", |_| {
                flights::flights_are_the_exact_inverse()
            })
        }
        Fault::WindowUnfair => {
            ("a split photon's weight shared among a rounded number", "a_window_keeps_the_weight", |_| {
                weights::a_window_keeps_the_weight()
            })
        }
        Fault::ClustersForgotten => (
            "the noise that is advised without the photons of one history",
            "advised_noise_is_that_of_maps",
            |_| weights::advised_noise_is_that_of_maps(),
        ),
        Fault::FreedomOfThree => (
            "1/(k-1) for 1/(k-2) in the variance of the k nearest",
            "the_k_nearest_vary_as_their_volume",
            |_| weights::the_k_nearest_vary_as_their_volume(),
        ),
        Fault::VarianceOfRed => (
            "variances of a picture's file all of the first channel",
            "each_channel_has_its_own_variance",
            |_| outputs::each_channel_has_its_own_variance(),
        ),
        Fault::LuminanceReversed => {
            ("weights of luminance in reverse order", "channels_weigh_as_the_eye_has_it", |_| {
                outputs::channels_weigh_as_the_eye_has_it()
            })
        }
        Fault::AlbedoLowered => ("the albedo 0.3 % too low", "photons_survive_as_the_albedo_says", |_| {
            weights::photons_survive_as_the_albedo_says()
        }),
        Fault::PowerRaised => {
            ("photons with 0.3 % too much power", "photons_carry_the_power_of_all_lights", |_| {
                color::photons_carry_the_power_of_all_lights()
            })
        }
        Fault::PhaseTurned => (
            "scattering 0.003 too far forwards in the mean cosine",
            "density_between_samples_is_the_step_in_u",
            |_| phase::density_between_samples_is_the_step_in_u(),
        ),
        Fault::KernelRaised => {
            ("kernels that weigh 0.3 % too much", "one_photon_is_one_over_its_ball", |_| {
                weights::one_photon_is_one_over_its_ball()
            })
        }
        Fault::ShadingFactorForgotten => {
            ("photons on smooth meshes as on flat ones", "smooth_meshes_scatter_photons_as_radiance", |_| {
                shading::smooth_meshes_scatter_photons_as_radiance()
            })
        }
        Fault::NearParallelDropped => {
            ("beams nearly parallel to a ray dropped", "a_laser_end_on_counts_in_full", |_| {
                beams::a_laser_end_on_counts_in_full()
            })
        }
        Fault::SineClamped => {
            ("the sine between beam and ray no less than 0.01", "a_laser_end_on_counts_in_full", |_| {
                beams::a_laser_end_on_counts_in_full()
            })
        }
        Fault::BeamsArrive => (
            "beams with the power with which their flights end",
            "light_scattered_once_in_three_channels",
            |_| beams::light_scattered_once_in_three_channels(),
        ),
        Fault::LineHalved => {
            ("the kernel of beams over half the line", "one_beam_by_hand", |_| beams::one_beam_by_hand())
        }
        Fault::ScheduleOfSpace => (
            "progressive tubes and strips that shrink as balls do",
            "each_map_is_read_within_the_radius_that_is_due",
            |_| progressive::each_map_is_read_within_the_radius_that_is_due(),
        ),
        Fault::RadiiExtrapolated => {
            ("radii of photons extrapolated from their sqrt(k) nearest", "own_radii_by_hand", |_| {
                along_rays::own_radii_by_hand()
            })
        }
        Fault::PlanesCollided => ("planes on flights that collided only", "a_laser_scattered_twice", |_| {
            planes::a_laser_scattered_twice()
        }),
        Fault::PlanesUnseen => ("planes that walls and other media do not stop", "one_plane_by_hand", |_| {
            planes::one_plane_by_hand()
        }),
        Fault::DeterminantClamped => {
            ("the determinant of plane and ray no less than 0.01", "a_plane_end_on_counts_in_full", |_| {
                planes::a_plane_end_on_counts_in_full()
            })
        }
        Fault::NextEventForgotten => (
            "weights of connections without next-event estimation",
            "a_furnace_of_lamps_is_as_bright_everywhere",
            |_| connected::a_furnace_of_lamps_is_as_bright_everywhere(),
        ),
        Fault::ConnectionCosineForgotten => (
            "a connection without the cosine on the side of the light",
            "two_reflections_are_those_of_paths",
            |_| connected::two_reflections_are_those_of_paths(),
        ),
        Fault::LightIndexForgotten => (
            "the density of light behind glass without the squared index",
            "a_furnace_of_lamps_is_as_bright_everywhere",
            |_| connected::a_furnace_of_lamps_is_as_bright_everywhere(),
        ),
    };
    Row { fault: Planted::Inside(fault), title, check_name, check }
}

/// Faults that shipped elsewhere, in the order of TESTING.md.
pub const ROWS: &[Row] = &[
    outside("all k photons over the ball of the k-th", "a_uniform_field_is_read_as_it_is", |wrong| {
        points::a_uniform_field_is_read_as_it_is(if wrong {
            points::nearest_biased()
        } else {
            points::nearest()
        })
    }),
    outside("divided by stored photons", "a_thinned_field_is_read_as_what_is_left", |wrong| {
        points::a_thinned_field_is_read_as_what_is_left(match wrong {
            true => |map| map.emitted() as f64 / map.stored() as f64,
            false => |_| 1.0,
        })
    }),
    outside(
        "traced until 16 photons are stored, the last path cut",
        "collisions_are_the_integral_of_the_fluence",
        |wrong| {
            let count = if wrong { slab::until_so_many_are_stored } else { slab::by_histories };
            slab::collisions_are_the_integral_of_the_fluence(count)
        },
    ),
    inside(Fault::AlbedoTwice),
    inside(Fault::AlbedoNever),
    outside("divided by sigma_s", "stored_power_over_extinction_is_the_fluence", |wrong| {
        slab::stored_power_over_extinction_is_the_fluence(if wrong { 0.5 } else { 1.0 })
    }),
    inside(Fault::CosineTwice),
    inside(Fault::EmissionUniform),
    outside("direct light in the map and beside it", "the_map_and_direct_light_add_up", |wrong| {
        slab::the_map_and_direct_light_add_up(if wrong { |_| true } else { is_indirect })
    }),
    inside(Fault::BackwardIsotropic),
    inside(Fault::AsymmetryClamped),
    inside(Fault::SmallAsymmetryIgnored),
    inside(Fault::EvaluationMirrored),
    inside(Fault::UnitReachesOne),
    inside(Fault::TransmittanceUnderflows),
    inside(Fault::NonFiniteDropped),
    inside(Fault::SinglePrecisionMean),
    inside(Fault::DepthForgotten),
    inside(Fault::AxisRaysMiss),
    inside(Fault::NoRoulette),
    inside(Fault::AreaForgotten),
    inside(Fault::BlocksByThreads),
    inside(Fault::OrderOffByOne),
    inside(Fault::AbsoluteDeviation),
    inside(Fault::RootForgotten),
    inside(Fault::RejectedSetRadius),
    inside(Fault::StepForgotten),
    inside(Fault::RadianceUnscaled),
    inside(Fault::PhotonPowerScaled),
    inside(Fault::FresnelForgotten),
    inside(Fault::DirectInVolumeMap),
    inside(Fault::CausticTwice),
    inside(Fault::StoredOnSurfaces),
    inside(Fault::GridHalfCellOff),
    inside(Fault::NullWeightForgotten),
    outside("normal quantiles for 8 numbers", "false_alarms_are_as_rare_as_promised", |wrong| {
        numbers::false_alarms_are_as_rare_as_promised(if wrong { normal_p } else { |z| student_p(z, 7) })
    }),
    outside("photons of one history taken for independent", "counts_vary_as_poisson", |wrong| {
        slab::counts_vary_as_poisson(if wrong { Orders::ALL } else { Orders::only(0) })
    }),
    outside("an oblique beam between mirrors", "an_oblique_beam_fills_the_cell_evenly", |wrong| {
        cell::an_oblique_beam_fills_the_cell_evenly(if wrong { cell::mirrored } else { cell::wrapped })
    }),
    outside("next events to a point light from free flights alone", "intervals_cover", |wrong| {
        point_light::intervals_cover(if wrong { point_light::by_free_flight } else { point_light::by_both })
    }),
    inside(Fault::ScheduleOfSpace),
    inside(Fault::RadiiExtrapolated),
];

/// Changes by hand that no test had noticed, in the order of their own document.
pub const BY_HAND: &[Row] = &[
    inside(Fault::LightColorIgnored),
    inside(Fault::LightByLargestChannel),
    inside(Fault::FillingColorIgnored),
    inside(Fault::StretchColorIgnored),
    inside(Fault::EmissionColorIgnored),
    inside(Fault::GlowColorOfAll),
    inside(Fault::GentleFogLevel),
    inside(Fault::GridScaleForgotten),
    inside(Fault::WallForgotten),
    inside(Fault::FlightStretched),
    inside(Fault::PieceStretched),
    inside(Fault::TrackStretched),
    inside(Fault::WindowUnfair),
    inside(Fault::PartLost),
    inside(Fault::LedFlightsForgotten),
    inside(Fault::SharedForOne),
    inside(Fault::LobeForgotten),
    inside(Fault::ClustersForgotten),
    inside(Fault::FreedomOfThree),
    inside(Fault::VarianceOfRed),
    inside(Fault::LuminanceReversed),
    inside(Fault::AlbedoLowered),
    inside(Fault::PowerRaised),
    inside(Fault::PhaseTurned),
    inside(Fault::KernelRaised),
    inside(Fault::EmitterShareForgotten),
    inside(Fault::ShadingFactorForgotten),
    inside(Fault::NearParallelDropped),
    inside(Fault::SineClamped),
    inside(Fault::BeamsArrive),
    inside(Fault::LineHalved),
    inside(Fault::PlanesCollided),
    inside(Fault::PlanesUnseen),
    inside(Fault::DeterminantClamped),
    inside(Fault::NextEventForgotten),
    inside(Fault::ConnectionCosineForgotten),
    inside(Fault::LightIndexForgotten),
];

fn single_scattering() {
    slab::single_scattering_is_the_closed_form();
}

/// A lamp of area 0.8 and a box before it.
fn lamp() {
    let corner = DVec3::new(-0.5, -0.4, 0.1);
    let lamp = area_light(rectangle(corner, DVec3::X, DVec3::Y * 0.8), Spectrum::rgb(1.0, 2.0, 0.5));
    let shape = cuboid(DVec3::new(-0.7, -0.6, 0.4), DVec3::new(0.9, 0.5, 1.6));
    light::photons_and_paths_cross_a_box_alike("lamp", lamp, shape, 1 << 18);
}
