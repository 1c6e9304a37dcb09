//! Densities and their media: bounds hold everywhere, flights and transmittances are those of the exact integral,
//! emission is collected in full, and homogeneous media cost nothing of it.

use crate::checks::fog;
use crate::checks::media;
use crate::checks::media::{layered, varying};
use crate::common::config as properties;
use crate::support::quadrature::integrate;
use crate::support::run::{histories, numbers, paths, tallies};
use crate::support::scenes::{
    CELL, bounded, cuboid, dielectric, filled, layer, octahedron, outflow, point_light, region, sphere,
    transmittance,
};
use crate::support::{unit_vector, verdict};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};
use turbid::Spectrum;
use turbid::geometry::{Mesh, Revolution, Shape};
use turbid::light::{Light, VolumeSource};
use turbid::math::{FOUR_PI, Frame, Interval, Ray, exp, exp_m1, warp};
use turbid::medium::{Density, Grid, Heterogeneous, Homogeneous, Medium};
use turbid::phase::{Isotropic, Phase};
use turbid::photons::{Emitter, Histories, shoot};
use turbid::rng::{Purpose, Stream, Work};
use turbid::scene::{Interior, Object, Orders, Quantity, Region, SURROUNDINGS, Scene, SceneParts};
use turbid::stats::Moments;
use turbid::transport::{Flight, NoProgress, free_flight, segment_transmittance};

#[test]
fn samples_lie_in_the_middles_of_cells() {
    media::samples_lie_in_the_middles_of_cells();
}

#[test]
fn each_channel_passes_as_its_depth_says() {
    media::each_channel_passes_as_its_depth_says();
}

/// Histories of a test of emission.
const MANY: u64 = 1 << 16;

static SPECIMENS: LazyLock<Vec<Density>> = LazyLock::new(Density::specimens);

proptest! {
    #![proptest_config(properties(4000))]

    /// No point of a ray has a density outside the bounds of its stretch, whatever the density; stretches follow on
    /// each other and fill the part.
    #[test]
    fn bounds_hold_at_every_point(
        which: prop::sample::Index, place in prop::array::uniform3(-2.5..2.5f64),
        z in -1.0..=1.0f64, azimuth in 0.0..6.3f64, axis in 0..6usize, length in 0.01..6.0f64, u in 0.0..1.0f64,
    ) {
        let density = &SPECIMENS[which.index(SPECIMENS.len())];
        let dir = if axis < 3 { DVec3::AXES[axis] } else { unit_vector(z, azimuth) };
        let ray = Ray::new(place.into(), dir);
        let part = Interval { start: 0.1, end: 0.1 + length };
        let mut at = part.start;
        for bound in density.along(&ray, part) {
            prop_assert_eq!(bound.interval.start, at);
            at = bound.interval.end;
            // At a jump the point belongs to one side.
            let inside = [0.0, u, 0.5, 1.0].map(|part| if has_jumps(density) { 0.01 + 0.98 * part } else { part });
            for part in inside {
                if has_jumps(density) && bound.interval.length() < 1e-9 {
                    continue;
                }
                let t = bound.interval.start + part * bound.interval.length();
                let value = density.at(ray.at(t));
                // At a face between cells a point may round into the next cell: by an ulp of its coordinates, over which
                // the steepest specimen (slope 200) changes by less than 1e-12.
                prop_assert!(bound.low - 1e-12 <= value && value <= bound.high + 1e-12, "{value} {bound:?}");
                prop_assert!(bound.high <= density.high() * (1.0 + 1e-12));
            }
        }
        prop_assert_eq!(at, part.end);
    }
}

/// Whether a density is constant in blocks, and jumps between them.
fn has_jumps(density: &Density) -> bool {
    match density {
        Density::Blocks(_) => true,
        Density::Repeated(repeated) => has_jumps(repeated.density()),
        _ => false,
    }
}

/// A long ray through each specimen, aslant, with the distance at which it is over.
fn across() -> (Ray, Interval) {
    let from = DVec3::new(-1.9, -1.3, -1.6);
    (Ray::new(from, DVec3::new(0.62, 0.5, 0.6).normalize()), Interval { start: 0.0, end: 5.5 })
}

/// The optical depth from the start of a part, by steps between which it is nearly a line.
fn cumulated_depth(medium: &Medium, ray: &Ray, part: Interval) -> impl Fn(f64) -> f64 {
    const STEPS: usize = 2048;
    let step = part.length() / STEPS as f64;
    let mut sums = vec![0.0];
    for i in 0..STEPS {
        let piece = Interval { start: part.start + step * i as f64, end: part.start + step * (i + 1) as f64 };
        sums.push(sums[i] + medium.integrated_depth(ray, piece)[0]);
    }
    move |t: f64| {
        let place = (t - part.start) / step;
        let i = (place as usize).min(STEPS - 1);
        sums[i] + (sums[i + 1] - sums[i]) * (place - i as f64)
    }
}

/// Distances of collisions have the exact distribution, and ratio tracking the exact mean, for every density. The
/// quadrature of clouds is good to 1e-4 of their extent, far below what is detectable.
#[test]
fn tracking_follows_the_exact_integral() {
    const N: u64 = 1 << 15;
    let (ray, part) = across();
    for (i, density) in SPECIMENS.iter().cloned().enumerate() {
        let sigma_t = 2.0 / density.integral(&ray, part);
        let medium = varying(Spectrum::grey(sigma_t), 0.5, density);
        let ball = sphere(DVec3::ZERO, 6.0);
        let light = point_light(DVec3::splat(5.0), Spectrum::ONE);
        let scene = bounded(vec![Region { shape: ball, medium: medium.clone() }], Vec::new(), vec![light]);
        let mut flown = Vec::new();
        for history in 0..N {
            let mut stream = Stream::new(31, Purpose::Synthetic, 0, history);
            let flight = free_flight(&scene, &ray, part.end, SURROUNDINGS, Spectrum::ONE, false, &mut stream);
            if let Flight::Collision { t, weight, .. } = flight {
                assert_eq!(weight, Spectrum::ONE);
                flown.push(t);
            }
        }
        let depth = cumulated_depth(&medium, &ray, part);
        let share = -exp_m1(-2.0);
        verdict::rate(&format!("collisions, density {i}"), flown.len() as u64, N, share, 0.03, 31);
        let cdf = |t: f64| -exp_m1(-depth(t)) / share;
        verdict::fits(&format!("distances, density {i}"), verdict::cumulated(&flown, cdf), 0.03, 31);
        let estimated = histories(N, 32, |stream| {
            let value = segment_transmittance(&medium, &ray, part, stream);
            assert!((0.0..=1.0).contains(&value[0]));
            value
        });
        verdict::agrees(&format!("passed, density {i}"), &estimated[0], (exp(-2.0), 2e-5), 0.05, 32);
    }
}

fn matter(sigma_t: Spectrum, emission: Spectrum) -> Homogeneous {
    let plain = Homogeneous::new(sigma_t, Spectrum::ZERO, Phase::Isotropic(Isotropic)).unwrap();
    plain.with_emission(emission).unwrap()
}

/// The radiance that a box of a medium sends up its height of 2, with a faint light beside it.
fn seen(medium: Medium, lights: Vec<Light>, seed: u64) -> [turbid::stats::Moments; 3] {
    let shape = cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0));
    let scene = bounded(vec![Region { shape, medium }], Vec::new(), lights);
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z);
    paths(&scene, Quantity::Radiance(ray), Orders::ALL, 1 << 16, seed)
}

fn faint() -> Vec<Light> {
    vec![point_light(DVec3::splat(9.0), Spectrum::grey(1e-12))]
}

/// What absorbs and emits in proportion sends B (1 - e^-tau), B = emission over extinction, whatever the density.
#[test]
fn an_emitting_absorber_is_as_bright_as_its_source_function() {
    let (sigma_t, source) = (Spectrum::rgb(0.3, 1.0, 2.0), Spectrum::rgb(1.0, 2.0, 0.5));
    let homogeneous = seen(matter(sigma_t, source * sigma_t).into(), faint(), 41);
    let corners = (DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0));
    let density = || layered(corners, 16, |z| if z < 0.6 { 0.0 } else { z });
    let length = density().integral(&Ray::new(DVec3::ZERO, DVec3::Z), Interval { start: 0.0, end: 2.0 });
    let grid = Heterogeneous::new(matter(sigma_t, Spectrum::ZERO), density());
    let grid = seen(grid.with_emission_by_density(source * sigma_t).unwrap().into(), faint(), 42);
    for c in 0..3 {
        let bright = |depth: f64| source[c] * -exp_m1(-depth);
        // In closed form: only the point light's single scattering would vary, and nothing scatters.
        let expected = bright(sigma_t[c] * 2.0);
        assert!((homogeneous[c].mean() / expected - 1.0).abs() < 1e-12, "{}", homogeneous[c].mean());
        verdict::agrees(
            &format!("grid, channel {c}"),
            &grid[c],
            (bright(sigma_t[c] * length), 1e-9),
            0.05,
            42,
        );
    }
}

/// Emission that is the same everywhere, and a source light that fills the box, are attenuated by what is before them:
/// int e^-tau(z) dz, also where nothing collides.
#[test]
fn uniform_emission_is_attenuated_by_a_varying_density() {
    let corners = (DVec3::ZERO, DVec3::new(1.0, 1.0, 2.0));
    let density = || layered(corners, 8, |z| (z - 0.5).max(0.0));
    let sigma_t = Spectrum::rgb(0.5, 1.0, 3.0);
    let medium = |emission: f64| -> Medium {
        Heterogeneous::new(matter(sigma_t, Spectrum::grey(emission)), density()).into()
    };
    let own = seen(medium(1.0), faint(), 43);
    let shape = cuboid(corners.0, corners.1);
    let source = Light::VolumeSource(VolumeSource::new(shape, Spectrum::grey(FOUR_PI)).unwrap());
    let light = seen(medium(0.0), vec![source], 44);
    let up = Ray::new(DVec3::new(0.5, 0.5, 0.0), DVec3::Z);
    for c in 0..3 {
        let depth = |z: f64| medium(0.0).integrated_depth(&up, Interval { start: 0.0, end: z })[c];
        // Kinks of the depth lie at multiples of 1/8.
        let expected = integrate(0.0, 2.0, 16, |z| exp(-depth(z)));
        verdict::agrees(&format!("medium, channel {c}"), &own[c], (expected, 1e-8), 0.1, 43);
        verdict::agrees(&format!("source, channel {c}"), &light[c], (expected, 1e-8), 0.1, 44);
    }
}

/// Photons of an emitting medium start where it emits, whatever its density, and as often as its power says: in half of the
/// ball that it fills, which a clear region cuts. What they bring to a box is what paths do.
#[test]
fn photons_start_where_media_emit() {
    let (whole, cut) = (sphere(DVec3::ZERO, 1.5), cuboid(DVec3::new(0.2, -2.0, -2.0), DVec3::splat(2.0)));
    let beside = outflow(cuboid(DVec3::new(-0.8, -2.0, -0.5), DVec3::new(-0.2, 2.0, 0.9)));
    for (i, density) in SPECIMENS.iter().enumerate() {
        let fog = matter(Spectrum::rgb(0.2, 0.4, 0.6), Spectrum::rgb(0.1, 0.0, 0.05));
        let fog = Heterogeneous::new(fog, density.clone());
        let fog = fog.with_emission_by_density(Spectrum::rgb(1.0, 2.0, 0.5)).unwrap();
        let clear = Region { shape: cut.clone(), medium: matter(Spectrum::ZERO, Spectrum::ZERO).into() };
        let fog = Region { shape: whole.clone(), medium: fog.into() };
        let scene = bounded(vec![fog, clear], Vec::new(), Vec::new());
        let emitter = Emitter::by_power(&scene);
        let sent = numbers(MANY / 2, 46, |stream| {
            f64::from(u8::from(emitter.emit(&scene, stream).is_some_and(|walker| {
                let p = walker.ray.origin;
                assert!(whole.contains(p) && !cut.contains(p));
                true
            })))
        });
        // The power is known to a few ten-thousandths.
        let share = scene.power().sum() / scene.power_bound().sum();
        verdict::agrees(&format!("sent, density {i}"), &sent, (share, 1e-3 * share), 0.2 * share, 46);
        let photons = tallies(&scene, &[(beside.clone(), Orders::ALL)], MANY / 2, 47);
        let paths = paths(&scene, beside.clone(), Orders::ALL, MANY / 2, 48);
        for c in 0..3 {
            verdict::agree(
                &format!("density {i}, channel {c}"),
                &photons[0][c],
                &paths[c],
                0.3 * paths[c].mean(),
                47,
            );
        }
    }
}

/// A slab that emits sends photons if a cell stands for it; one without end and cell sends none, and says so.
#[test]
fn photons_of_unbounded_media_need_a_cell() {
    let medium = || -> Medium { matter(Spectrum::ONE, Spectrum::ONE).into() };
    let scene = |cell| {
        let regions = vec![Region { shape: layer(2.0), medium: medium() }];
        Scene::new(SceneParts { regions, cell, ..SceneParts::default() }).unwrap()
    };
    let open = scene(None);
    let histories = Histories { count: 1, seed: 1, replicate: 0, max_order: None };
    let refused = shoot(&open, histories, &[], |_| true, &NoProgress).unwrap_err().to_string();
    assert!(refused.contains("no end"), "{refused}");
    // Power 4 pi in each volume, of which each face lets 2 pi (1/2 - E3(2)) E out, E the emission: E3(2) = 0.030133.
    let closed = scene(Some(DVec2::splat(CELL)));
    let power = FOUR_PI * 2.0 * CELL * CELL;
    assert!((closed.power()[0] / power - 1.0).abs() < 1e-12);
    let out = tallies(&closed, &[(transmittance(2.0), Orders::ALL)], MANY, 49);
    let expected = PI * (1.0 - 2.0 * 0.030_133_4) * CELL * CELL / power;
    verdict::agrees("emitted by a face", &out[0][0], (expected, 1e-6 * expected), 0.1 * expected, 49);
}

/// Homogeneous media look up no majorants and estimate no transmittances; grey ones choose no channels. A grid does.
#[test]
fn what_is_not_required_is_not_done() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let light = || vec![point_light(DVec3::new(0.0, 0.0, 3.0), Spectrum::ONE)];
    let work = |medium: Region| {
        let scene: Scene = bounded(vec![medium], Vec::new(), light());
        let mut stream = Stream::new(45, Purpose::Paths, 0, 0);
        for _ in 0..500 {
            turbid::sensor::sample(&scene, &Quantity::Fluence(DVec3::ZERO), Orders::ALL, &mut stream);
        }
        stream.work
    };
    assert_eq!(work(region(ball.clone(), 1.0, 0.9, 0.5)), Work::default());
    let coloured = media_of(Spectrum::rgb(1.0, 2.0, 3.0));
    let done = work(Region { shape: ball.clone(), medium: coloured });
    assert!(
        done.channel_flights > 500
            && done == Work { channel_flights: done.channel_flights, ..Work::default() }
    );
    let grid = layered((DVec3::splat(-1.0), DVec3::ONE), 8, |z| 1.0 + z);
    let done = work(Region { shape: ball, medium: varying(Spectrum::ONE, 0.9, grid) });
    assert!(done.majorants > 500 && done.transmittances > 500 && done.densities > 100, "{done:?}");
    assert_eq!(done.channel_flights, 0);
}

fn media_of(sigma_t: Spectrum) -> Medium {
    Homogeneous::new(sigma_t, Spectrum::grey(0.9), Phase::Isotropic(Isotropic)).unwrap().into()
}

/// A grid is what its file says, to the bit, and a file what the grid says.
#[test]
fn grids_go_through_their_files() {
    let corners = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.5, 0.25, 8.0));
    for (count, channels) in [([1, 1, 1], 1), ([3, 2, 5], 1), ([4, 1, 2], 3)] {
        let number = count.iter().product::<usize>() * channels;
        let values = (0..number).map(|i| (i as f32).sqrt() / (number as f32)).collect();
        let grid = Grid::new(corners, count, channels, values).unwrap();
        let bytes = grid.to_bytes();
        assert_eq!(bytes.len(), 48 + 4 * number);
        let again = Grid::from_bytes(&bytes).unwrap();
        assert_eq!(again, grid);
        assert_eq!(again.to_bytes(), bytes);
        // The first sample of the second channel, byte by byte.
        if channels == 3 {
            let second = f32::from_le_bytes([bytes[52], bytes[53], bytes[54], bytes[55]]);
            assert_eq!(f64::from(second), grid.color_at(corners.0)[1]);
        }
    }
}

#[test]
fn gentle_slopes_have_their_depth() {
    fog::gentle_slopes_have_their_depth();
}

#[test]
fn a_grid_is_scaled_and_placed() {
    fog::a_grid_is_scaled_and_placed();
}

#[test]
fn a_wall_ends_the_angles() {
    fog::a_wall_ends_the_angles();
}

/// A closed body whose normals point inwards has its inside where they point from: the same scene with both names exchanged.
#[test]
fn bodies_turned_inside_out_part_the_same_places() {
    let (corners, faces) = octahedron();
    let turned = faces.map(|[a, b, c]| [a, c, b]);
    let mesh = |faces: &[[u32; 3]]| Shape::Mesh(Arc::new(Mesh::new(&corners, faces, None).unwrap()));
    let profile = [DVec2::new(0.0, -1.0), DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)];
    let back = [profile[2], profile[1], profile[0]];
    let lathe = |profile: &[DVec2]| {
        Shape::Revolution(Arc::new(Revolution::new(DVec3::ZERO, DVec3::Z, profile).unwrap()))
    };
    for (right, wrong) in [(mesh(&faces), mesh(&turned)), (lathe(&profile), lathe(&back))] {
        let scene = |shape: Shape, inside: usize| {
            let objects = vec![Object { shape, surface: dielectric(inside, 1 - inside) }];
            let interiors = vec![
                Interior::surroundings(),
                filled("glass", 1.5, matter(Spectrum::ONE, Spectrum::ONE).into()),
            ];
            Scene::new(SceneParts { interiors, objects, ..SceneParts::default() }).unwrap()
        };
        let (one, other) = (scene(right, 1), scene(wrong, 0));
        let mut stream = Stream::new(14, Purpose::Synthetic, 0, 0);
        for _ in 0..20_000 {
            let p = 3.0 * (2.0 * DVec3::from_array(stream.triple()) - 1.0);
            assert_eq!(one.interior_at(p), other.interior_at(p), "{p}");
        }
    }
}

/// What fills a closed body, whatever its shape and however it is turned, sends out 4 pi times its emission and its volume: as the
/// scene states it, and in photons.
#[test]
fn filled_bodies_emit_by_their_volume() {
    let mut turned = Stream::new(12, Purpose::Synthetic, 0, 0);
    let at = DVec3::new(0.4, -0.2, 0.3);
    let ring = |r: f64, h: f64| DVec2::new(r, h);
    let profiles = [
        vec![ring(0.0, -0.5), ring(0.5, -0.5), ring(0.5, 0.5), ring(0.0, 0.5)],
        vec![ring(0.0, -0.1), ring(0.8, 0.0), ring(0.0, 0.3)],
        vec![ring(0.4, -0.2), ring(0.6, -0.2), ring(0.6, 0.2), ring(0.4, 0.2), ring(0.4, -0.2)],
    ];
    let mut shapes = vec![sphere(at, 0.5), cuboid(at, at + DVec3::new(0.3, 0.1, 1.0))];
    for _ in 0..4 {
        let axis = warp::square_to_sphere(turned.pair());
        for profile in &profiles {
            shapes.push(Shape::Revolution(Arc::new(Revolution::new(at, axis, profile).unwrap())));
        }
        let frame = Frame::new(axis.normalize());
        let place = |x: f64, y: f64, z: f64| at + frame.to_world(DVec3::new(x, y, z));
        let corners =
            [place(0.0, 0.0, 0.0), place(1.0, 0.0, 0.0), place(0.0, 0.5, 0.0), place(0.1, 0.1, 0.4)];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        shapes.push(Shape::Mesh(Arc::new(Mesh::new(&corners, &faces, None).unwrap())));
    }
    // Of places on a lattice many see an edge of this one in directions of rational ratios.
    let (corners, faces) = octahedron();
    let corners = corners.map(|p| at + 0.5 * p);
    shapes.push(Shape::Mesh(Arc::new(Mesh::new(&corners, &faces, None).unwrap())));
    for (i, shape) in shapes.into_iter().enumerate() {
        let glow = matter(Spectrum::ONE, Spectrum::rgb(1.0, 2.0, 0.5));
        let glass = filled("glass", 1.5, glow.into());
        let expected = FOUR_PI * shape.volume();
        let parts = SceneParts {
            interiors: vec![Interior::surroundings(), glass],
            objects: vec![Object { shape, surface: dielectric(1, 0) }],
            ..SceneParts::default()
        };
        let scene = Scene::new(parts).unwrap();
        let emitter = Emitter::by_power(&scene);
        let mut emitted = Moments::new();
        for history in 0..1 << 15 {
            let mut stream = Stream::new(13, Purpose::Photons, i as u64, history);
            emitted.push(emitter.emit(&scene, &mut stream).map_or(0.0, |photon| photon.weight[0]));
        }
        verdict::agrees(&format!("body {i}"), &emitted, (expected, 1e-9 * expected), 0.2 * expected, 13);
        let power = scene.power();
        let (off, known) = (power[0] / expected - 1.0, scene.power_error()[0]);
        assert!(
            off.abs() <= 4.0 * known + 1e-12 && known < 1e-3 && power[1] == 2.0 * power[0],
            "body {i}: {power:?} for {expected}"
        );
    }
}
