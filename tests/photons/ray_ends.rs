//! Rays that end for each photon and beam where its own parallel leaves the medium: exact slabs at any radius, rays from inside, behind and
//! past a ball, and what is refused.

use crate::against_exact::henyey_greenstein::{medium, referee};
use crate::checks::beams::{across, by_maps, looked_into, means_by_maps};
use crate::checks::ledger;
use crate::checks::slab::exact;
use crate::support::run::{paths, sensor};
use crate::support::scenes::{Incidence, bounded, cuboid, homogeneous, point_light, region, sphere};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use turbid::Spectrum;
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::path;
use turbid::math::{Frame, Positive, Ray};
use turbid::photons::beams::BeamLength;
use turbid::photons::maps::{Indirect, MapSettings, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

fn of_points(kernel: Kernel, radius: f64) -> Estimator {
    let radius = Positive::new("the radius", radius).unwrap();
    Estimator::new(kernel, Gather::Radius(radius)).along_rays(radius).ending(RayEnds::Own)
}

fn of_beams(radius: f64, blur: BeamBlur) -> Estimator {
    across(Kernel::Uniform, radius).blurred(blur).ending(RayEnds::Own)
}

/// What leaves a slab aslant: the published exact value, the same for every radius, by points, beams in one dimension and in two, drawn
/// and long; from the face, and from outside it. Cut, it is another.
#[test]
fn radiance_of_a_slab_knows_no_radius() {
    for (mu, expected, seed) in [(0.5, 0.094_904_494, 51), (0.2, 0.115_644_004, 52)] {
        for depth in [0.0, -0.3] {
            let scene = looked_into((Incidence::Beam(1.0), 0.9, 0.0), (mu, depth));
            let points = [of_points(Kernel::Uniform, 0.1), of_points(Kernel::Biweight, 0.2)];
            let beams = [(0.1, BeamBlur::OneD), (0.2, BeamBlur::OneD), (0.2, BeamBlur::TwoD)];
            let beams = beams.map(|(radius, blur)| of_beams(radius, blur));
            let cut = points[1].ending(RayEnds::Cut);
            let all: Vec<Estimator> = points.into_iter().chain(beams).chain([cut]).collect();
            let measured = means_by_maps(&scene, (2500, 120), seed, &all);
            for (estimator, moments) in all.iter().zip(&measured).take(5) {
                let what = format!("mu {mu}, depth {depth}, {}", estimator.name());
                verdict::agrees(&what, moments, (expected, 1e-8), 0.09 * expected, seed);
            }
        }
    }
    let scene = looked_into((Incidence::Beam(1.0), 0.9, 0.0), (0.5, 0.0));
    let specimens = [
        of_beams(0.2, BeamBlur::OneD).of_length(BeamLength::Whole),
        of_points(Kernel::Uniform, 0.4).ending(RayEnds::Cut),
    ];
    let measured = means_by_maps(&scene, (1200, 100), 53, &specimens);
    verdict::agrees("long", &measured[0], (0.094_904_494, 1e-8), 0.06 * 0.094_904_494, 53);
    verdict::rejects("cut", &measured[1], 0.094_904_494, 53);
}

/// What leaves a slab of peaked scattering on the side that the peak points to, under diffuse light: the exact value at any radius, by
/// points. Beams nearly along the ray count 1/sin of their angle, and the peak is there: their tail is too heavy for 200 maps.
#[test]
fn peaked_slabs_know_no_radius() {
    for (g, mu, depth) in [(0.95, -0.5, 1.0), (-0.95, 0.5, 0.0)] {
        let scene = looked_into((Incidence::Diffuse, 0.9, g), (mu, depth));
        let expected =
            exact(referee(&medium(0.9, g), 1.0, Incidence::Diffuse).radiance(depth, mu, 0.0).unwrap());
        let all = [of_points(Kernel::Uniform, 0.3), of_points(Kernel::Biweight, 0.5)];
        let measured = means_by_maps(&scene, (10_000, 140), 55, &all);
        for (estimator, moments) in all.iter().zip(&measured) {
            let what = format!("g {g}, {}", estimator.name());
            verdict::agrees(&what, moments, expected, 0.15 * expected.0, 55);
        }
    }
}

/// In a furnace, where all is the same everywhere, photons with radii of their own lose nothing at the middle of faces either but what
/// their radii differ by: a slab along its normal.
#[test]
fn own_radii_with_own_ends() {
    let scene = looked_into((Incidence::Both, 1.0, 0.0), (1.0, 0.0));
    let own = of_points(Kernel::Uniform, 0.5).of_nearest(NonZeroUsize::new(10).unwrap());
    let measured = means_by_maps(&scene, (1500, 100), 54, &[own]);
    let expected = -turbid::math::exp_m1(-1.0) / PI;
    verdict::agrees("normal", &measured[0], (expected, 1e-9), 0.08 * expected, 54);
}

/// Rays that begin in a ball, behind it, and pass it nearer than the radius: from inside what is ahead counts, all of it from in front,
/// nothing where all is behind, and beside it what the blur brings.
#[test]
fn rays_begin_anywhere() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let medium = homogeneous(Spectrum::ONE, Spectrum::grey(0.8), 0.4);
    let light = point_light(DVec3::new(0.2, 0.3, -0.1), Spectrum::ONE);
    let orders = Orders { min: 2, max: None };
    let looks = [
        Ray::new(DVec3::new(0.0, 0.0, -3.0), DVec3::Z),
        Ray::new(DVec3::new(0.0, -0.1, 0.0), DVec3::Z),
        Ray::new(DVec3::new(0.0, 0.0, 1.5), DVec3::Z),
        Ray::new(DVec3::new(1.02, 0.0, -3.0), DVec3::Z),
        Ray::new(DVec3::new(1.02, 0.0, 3.0), DVec3::Z),
    ];
    let regions = vec![Region { shape: ball, medium }];
    let scene = Scene::new(SceneParts {
        regions: regions.clone(),
        lights: vec![light.clone()],
        sensors: looks.iter().map(|ray| sensor(Quantity::Radiance(*ray), orders)).collect(),
        ..SceneParts::default()
    })
    .unwrap();
    let plain = bounded(regions, vec![], vec![light]);
    let estimators = [of_points(Kernel::Epanechnikov, 0.08), of_beams(0.05, BeamBlur::OneD)];
    for (estimator, measured) in estimators.iter().zip(&by_maps(&scene, (12_000, 100), 55, &estimators)) {
        for which in 0..2 {
            let reference = paths(&plain, Quantity::Radiance(looks[which]), orders, 1 << 16, 55)[0];
            let expected = reference.mean();
            // The blur of a field that bends by a few per cent over the radius.
            let error = libm::hypot(reference.std_error(), 0.01 * expected);
            let what = format!("look {which}, {}", estimator.name());
            verdict::agrees(&what, &measured[which][0], (expected, error), 0.4 * expected, 55);
        }
        for behind in [2, 4] {
            assert_eq!(measured[behind][0].mean(), 0.0, "{behind}, {}", estimator.name());
        }
        let beside = measured[3][0];
        assert!(beside.mean() > 5.0 * beside.std_error(), "{beside:?}");
        assert!(beside.mean() < 0.3 * measured[0][0].mean(), "{beside:?}");
    }
}

/// A picture of a cube, looked at aslant by parallel rays that pass it farther than the radius: nothing is lost of the light that is
/// scattered twice and more, whatever the radius, by points of one radius and of their own, by beams drawn and long. Cut, a part is.
#[test]
fn a_picture_loses_nothing() {
    let medium = homogeneous(Spectrum::grey(2.0), Spectrum::grey(0.8), 0.3);
    let regions = vec![Region { shape: cuboid(DVec3::ZERO, DVec3::ONE), medium }];
    let scene = bounded(regions, vec![], vec![point_light(DVec3::new(0.3, 0.6, 2.5), Spectrum::ONE)]);
    let frame = Frame::new(DVec3::new(0.48, 0.6, 0.64));
    // One in each cell of a grid.
    let ray = |history: u64, stream: &mut Stream| {
        let ([u, v], [i, j]) = (stream.pair(), [history % 20, history / 20 % 20].map(|cell| cell as f64));
        let [x, y] = [i + u, j + v].map(|cells| 2.5 * (cells / 20.0 - 0.5));
        Ray::new(DVec3::splat(0.5) + frame.to_world(DVec3::new(x, y, -3.0)), frame.to_world(DVec3::Z))
    };
    let mut reference = Moments::new();
    for history in 0..1 << 16 {
        let stream = &mut Stream::new(57, Purpose::Paths, 0, history);
        reference.push(path::layers(&scene, ray(history, stream), None, 0, stream).0.multiple[0]);
    }
    let (expected, error) = (reference.mean(), reference.std_error());
    let [points, beams] = [of_points(Kernel::Uniform, 0.3), of_beams(0.3, BeamBlur::OneD)];
    let of_nearest = points.of_nearest(NonZeroUsize::new(20).unwrap());
    let cut = points.ending(RayEnds::Cut);
    for volume in [points, of_nearest, beams, beams.of_length(BeamLength::Whole), cut] {
        let settings = Settings { volume, ..ledger::settings(1) };
        let mut moments = Moments::new();
        for replicate in 0..64 {
            let filling = ledger::filling(2000, Indirect::Seen, 57, replicate);
            let filling = MapSettings { media: settings.media(), ..filling };
            let maps = fill(&scene, &filling, &NoProgress).unwrap();
            let mapper = Mapper::new(&scene, &maps, &settings);
            mapper.check_radii().unwrap();
            let seen = (0..400).map(|history| {
                let stream = &mut Stream::new(57, Purpose::Paths, replicate + 1, history);
                mapper.radiance(ray(history, stream), None, 0, stream).0.multiple[0]
            });
            moments.push(seen.sum::<f64>() / 400.0);
        }
        match volume.ray_ends {
            RayEnds::Own => verdict::agrees(&volume.name(), &moments, (expected, error), 0.15 * expected, 57),
            RayEnds::Cut => verdict::rejects(&volume.name(), &moments, expected, 57),
        }
    }
}

/// In more than one homogeneous region, beside a lamp's body, and where rays are read point by point it is refused, by name.
#[test]
fn what_has_no_own_ends_is_refused() {
    let look = sensor(Quantity::Radiance(Ray::new(DVec3::splat(0.5), DVec3::Z)), Orders::SCATTERED);
    let of = |regions: Vec<Region>, estimator: Estimator| {
        let scene = Scene::new(SceneParts {
            regions,
            lights: vec![point_light(DVec3::splat(0.4), Spectrum::ONE)],
            sensors: vec![look.clone()],
            ..SceneParts::default()
        })
        .unwrap();
        let settings = PhotonSettings { photons: 200, maps: 1, seed: 1, orders: Orders::ALL, estimator };
        by_photons(&scene, &settings, &NoProgress)
    };
    let outer = region(cuboid(DVec3::ZERO, DVec3::ONE), 1.0, 0.5, 0.0);
    let inner = region(cuboid(DVec3::ZERO, DVec3::splat(0.5)), 2.0, 0.5, 0.0);
    assert!(of(vec![outer.clone()], of_points(Kernel::Uniform, 0.1)).is_ok());
    // However large the radius.
    assert!(of(vec![outer.clone()], of_points(Kernel::Uniform, 1e6)).is_ok());
    let told = of(vec![outer.clone(), inner], of_points(Kernel::Uniform, 0.1)).unwrap_err().to_string();
    assert!(told.contains("one homogeneous region with nothing in it"), "{told}");
    let balls = Estimator::new(Kernel::Uniform, Gather::radius(0.1).unwrap()).ending(RayEnds::Own);
    let told = of(vec![outer], balls).unwrap_err().to_string();
    assert!(told.contains("allowed: a ray radius or a beam radius"), "{told}");
}
