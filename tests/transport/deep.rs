//! Where paths hardly ever find the light: an error bar that few of them made is none.
//!
//! The void problem of Kobayashi, Sugimura and Nagaya (OECD/NEA 2000), number 1, half scattering: a source in the middle of
//! a void in a shield of ten mean free paths, its reflecting planes unfolded.

use crate::checks::glass;
use crate::checks::slab::{exact, referee};
use crate::support::run::{histories, numbers, paths};
use crate::support::scenes::{
    Incidence, bounded, cuboid, dielectric, emitting_sphere, filled, fresnel_slab, homogeneous, lambertian,
    point_light, rectangle, region, slab, sphere, transmittance,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::Guides;
use turbid::light::{Light, Sun, VolumeSource};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Orders, Quantity, Region, Scene, SceneParts, Sensor};
use turbid::sensor::{NoError, PathSettings, by_paths, sample_guided};
use turbid::stats::Moments;
use turbid::transport::{NoProgress, WeightWindows};

/// Places along the diagonal and the fluences of GMVP there, known to 0.1 % and 0.4 %.
const SHALLOW: (f64, f64) = (55.0, 3.02145e-2);
const DEEP: (f64, f64) = (95.0, 1.12892e-5);
const BETWEEN: f64 = 75.0;

fn shield(at: f64) -> Scene {
    let box_of = |half: f64| cuboid(DVec3::splat(-half), DVec3::splat(half));
    let source = VolumeSource::new(box_of(10.0), Spectrum::ONE).unwrap();
    let quantity = Quantity::Fluence(DVec3::splat(at));
    Scene::new(SceneParts {
        regions: vec![
            region(box_of(100.0), 0.1, 0.5, 0.0),
            region(box_of(50.0), 1e-4, 0.5, 0.0),
            region(box_of(10.0), 0.1, 0.5, 0.0),
        ],
        lights: vec![Light::VolumeSource(source)],
        sensors: vec![Sensor { name: "deep".into(), label: "fluence".into(), quantity, orders: Orders::ALL }],
        ..SceneParts::default()
    })
    .unwrap()
}

fn measured(at: f64, samples: u64, seed: u64) -> (f64, Result<f64, NoError>) {
    let settings = PathSettings { samples, seed, replicate: 0, orders: Orders::ALL };
    let measurement = by_paths(&shield(at), &settings, &NoProgress).unwrap().remove(0);
    (measurement.mean, measurement.std_error.ok_or_else(|| measurement.no_error.unwrap()))
}

/// Deep in the shield most of the light comes by rare paths, through the void, of large weight. Connections to the source
/// bring a little in every path, so that the variance of variance of some runs is small, and a third of the light is
/// missing: the shape of their tail tells.
#[test]
fn few_paths_make_no_error_bar() {
    for seed in 1..=24 {
        let (mean, error) = measured(DEEP.0, 10_000, seed);
        assert!(error.is_err(), "seed {seed}: {mean:e} +- {error:?} for {:e}", DEEP.1);
    }
}

/// With more than a thousand of them, their tail tells.
#[test]
fn a_tail_that_was_not_drawn_makes_no_error_bar() {
    for seed in 1..=3 {
        let (mean, error) = measured(BETWEEN, 300_000, seed);
        assert_eq!(error, Err(NoError::HeavyTail), "seed {seed}: {mean:e}");
    }
}

/// Behind a wall of half a mean free path paths are good enough, and have their error.
#[test]
fn enough_paths_have_their_error() {
    for seed in 1..=3 {
        let (mean, error) = measured(SHALLOW.0, 100_000, seed);
        let z = (mean - SHALLOW.1) / error.unwrap();
        assert!(z.abs() < 4.9, "seed {seed}: {mean:e} is {z} errors off");
    }
}

fn guided(scene: &Scene, quantity: &Quantity, n: u64, seed: u64) -> Moments {
    let windows = WeightWindows::new(scene).unwrap();
    let guides = Guides { windows: Some(&windows), learned: None };
    let moments = numbers(n, seed, |s| sample_guided(scene, quantity, Orders::ALL, guides, s).0[0]);
    let relative = moments.std_error() / moments.mean();
    assert!(relative < 0.05, "windows do not help: {relative}");
    moments
}

/// Weight windows reach the deep place, and one behind the shield's side, within GMVP's own errors; fewer paths of the same kind
/// than are refused without them. The negative control leaves out light that scattered.
#[test]
fn windows_reach_the_deep_place() {
    let aside = (DVec3::new(95.0, 55.0, 5.0), 7.93924e-4, 0.0089);
    for ((at, value, relative), seed) in [((DVec3::splat(DEEP.0), DEEP.1, 0.00383), 31), (aside, 32)] {
        let scene = shield(DEEP.0);
        let moments = guided(&scene, &Quantity::Fluence(at), 150_000, seed);
        verdict::agrees(&format!("fluence at {at}"), &moments, (value, relative * value), 0.25 * value, seed);
        if seed == 31 {
            verdict::rejects("uncollided alone", &moments, 3.01032e-6, seed);
        }
    }
}

/// A slab of twenty mean free paths that scatters half lets 1e-8 of a beam pass and less of slanted and of diffuse light.
#[test]
fn windows_cross_twenty_mean_free_paths() {
    let (tau, albedo) = (20.0, 0.5);
    for (how, seed) in [(Incidence::Beam(1.0), 33), (Incidence::Beam(0.6), 34), (Incidence::Diffuse, 35)] {
        let moments = guided(&slab(tau, albedo, 0.0, how), &transmittance(tau), 40_000, seed);
        let value = exact(referee(tau, albedo, how).transmittance());
        verdict::agrees(&format!("{how:?}"), &moments, value, 0.25 * value.0, seed);
    }
}

/// A slab of five mean free paths that absorbs a third and refracts, and a thin one, whose media fill bodies: paths enter them from outside.
#[test]
fn windows_enter_a_refracting_slab() {
    for (tau, albedo, g, index, seed) in [(1.0, 0.9, 0.6, 1.33, 38), (5.0, 0.7, 0.0, 1.5, 40)] {
        let scene = fresnel_slab(tau, albedo, g, index, Incidence::Diffuse);
        let exact = glass::referee(tau, albedo, g, index, Incidence::Diffuse);
        let values = [exact.reflectance(), exact.transmittance()];
        for ((quantity, value), seed) in glass::faces(tau).iter().zip(values).zip(seed..) {
            let moments = guided(&scene, quantity, 40_000, seed);
            verdict::agrees(
                &format!("{quantity:?}"),
                &moments,
                (value.value, value.error),
                0.15 * value.value,
                seed,
            );
        }
    }
}

/// Balls about one another, and a wall beside them: where media fill bodies that do not refract light is guessed as where they are regions.
#[test]
fn windows_guess_alike_in_bodies_and_regions() {
    let balls =
        [(DVec3::new(0.2, 0.1, 0.0), 1.0), (DVec3::new(0.3, -0.1, 0.2), 0.5)].map(|(c, r)| sphere(c, r));
    let media = [2.0, 0.5].map(|sigma_t| homogeneous(Spectrum::grey(sigma_t), Spectrum::grey(0.8), 0.5));
    let wall = (
        Shape::Rectangle(rectangle(DVec3::new(-2.0, -2.0, 1.4), DVec3::X * 4.0, DVec3::Y * 4.0)),
        lambertian(Spectrum::grey(0.5)),
    );
    let lights = || {
        vec![
            point_light(DVec3::new(1.0, 2.0, 0.5), Spectrum::ONE),
            point_light(DVec3::new(0.35, -0.1, 0.25), Spectrum::grey(0.1)),
            emitting_sphere(DVec3::new(0.0, 0.0, 3.0), 0.3),
            Light::Sun(Sun::new(DVec3::new(0.6, 0.0, -0.8), Spectrum::grey(0.01), 0.0).unwrap()),
        ]
    };
    let regions = balls
        .iter()
        .zip(&media)
        .map(|(shape, medium)| Region { shape: shape.clone(), medium: medium.clone() });
    let by_regions = bounded(regions.collect(), vec![wall.clone()], lights());
    let filled = Scene::new(SceneParts {
        interiors: vec![
            Interior::surroundings(),
            filled("outer", 1.0, media[0].clone()),
            filled("inner", 1.0, media[1].clone()),
        ],
        objects: vec![
            Object { shape: balls[0].clone(), surface: dielectric(1, 0) },
            Object { shape: balls[1].clone(), surface: dielectric(2, 1) },
            Object { shape: wall.0, surface: wall.1 },
        ],
        lights: lights(),
        ..SceneParts::default()
    })
    .unwrap();
    let guess = |scene: &Scene, p: DVec3| {
        WeightWindows::new(scene).unwrap().ln_fluence(scene, p, scene.interior_at(p))
    };
    let mut stream = Stream::new(42, Purpose::Synthetic, 0, 0);
    let mut inside = [0; 3];
    for _ in 0..2000 {
        let p = 4.0 * DVec3::from(stream.triple()) - 2.0;
        inside[filled.interior_at(p)] += 1;
        let (expected, found) = (guess(&by_regions, p), guess(&filled, p));
        assert!((found - expected).abs() < 1e-9, "{p}: {found}, not {expected}");
    }
    assert!(inside.iter().all(|count| *count > 10), "{inside:?}");
}

/// Paths that a black body has ended go no further, whatever the windows: there is nothing to choose a channel by.
#[test]
fn windows_end_where_a_colored_body_absorbs_everything() {
    let coated = |radius: f64, albedo: f64| Region {
        shape: sphere(DVec3::ZERO, radius),
        medium: homogeneous(Spectrum::rgb(1.0, 2.0, 3.0), Spectrum::grey(albedo), 0.0),
    };
    let lamp = emitting_sphere(DVec3::new(0.0, 2.0, 0.5), 0.4);
    let scene = bounded(vec![coated(1.0, 0.0), coated(0.3, 0.9)], vec![], vec![lamp]);
    let quantity = Quantity::Fluence(DVec3::new(0.2, 0.1, 0.05));
    let windows = WeightWindows::new(&scene).unwrap();
    let guides = Guides { windows: Some(&windows), learned: None };
    let by_windows = histories(1 << 13, 36, |s| sample_guided(&scene, &quantity, Orders::ALL, guides, s).0);
    let by_paths = paths(&scene, quantity, Orders::ALL, 1 << 13, 37);
    for (channel, (a, b)) in by_windows.iter().zip(&by_paths).enumerate() {
        verdict::agree(&format!("channel {channel}"), a, b, 0.02, 36);
    }
}
