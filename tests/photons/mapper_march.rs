//! The march through media against closed forms: rules of steps, segments one behind the other, media without end.

use crate::checks::gathers::steps_that_share_a_gather_have_their_sum;
use crate::checks::media::{layered, varying};
use crate::support::quadrature::integrate;
use crate::support::run::sensor;
use crate::support::scenes::{bounded, cuboid, homogeneous, lambertian, point_light, region, sphere};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Shape, Slab};
use turbid::integrators::mapper::{Mapper, Settings, scene_size};
use turbid::integrators::{March, StepRule, path};
use turbid::light::{Light, Sun};
use turbid::math::{FOUR_PI, Positive, Ray, exp, exp_m1};
use turbid::medium::{Density, Grid, HeightFog, Heterogeneous, Medium};
use turbid::photons::maps::{Indirect, Maps};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Maps for what needs none.
fn nothing() -> Maps {
    Maps::none(Indirect::Seen)
}

fn marching(scene: &Scene, march: March) -> Settings {
    Settings { march, ..Settings::for_scene(scene, 10).unwrap() }
}

/// Single scattering of one ray, and the steps of all.
fn single(scene: &Scene, march: March, ray: &Ray, count: u64, seed: u64) -> (Moments, u64) {
    let (maps, settings) = (nothing(), marching(scene, march));
    let mapper = Mapper::new(scene, &maps, &settings);
    let (mut moments, mut steps) = (Moments::new(), 0);
    for history in 0..count {
        let mut stream = Stream::new(seed, Purpose::Paths, 0, history);
        let (layers, report) = mapper.radiance(*ray, None, 0, &mut stream);
        moments.push(layers.single[1]);
        steps += report.steps;
    }
    (moments, steps)
}

fn march(step: f64, rule: StepRule, is_jittered: bool) -> March {
    March { step: Positive::new("the step", step).unwrap(), rule, is_jittered, adaptive: None }
}

/// Light of one from a direction.
fn sun(dir: DVec3) -> Light {
    Light::Sun(Sun::new(dir, Spectrum::ONE, 0.0).unwrap())
}

/// What steps of at most `x`, the first of length `first`, make of a source of 1 per mean free path over a depth.
fn by_steps(rule: StepRule, (x, first): (f64, f64), depth: f64) -> f64 {
    let (mut at, mut dx, mut sum) = (0.0, first, 0.0);
    while at < depth {
        dx = dx.min(depth - at);
        let weight = match rule {
            StepRule::NearEnd => dx,
            StepRule::Middle => dx * exp(-0.5 * dx),
            StepRule::Integrated => -exp_m1(-dx),
        };
        sum += exp(-at) * weight;
        at += dx;
        dx = x;
    }
    sum
}

/// A source that is the same all along the ray, read in steps of several mean free paths: each rule reads it as it says, with a
/// first step of random length or without, in a medium that is homogeneous and in one that could vary.
#[test]
fn rules_of_steps_are_followed() {
    let (depth, height, x) = (6.0, 0.3, 2.5);
    let corners = (DVec3::ZERO, DVec3::new(depth, 1.0, 1.0));
    let ray = Ray::new(DVec3::new(-1.0, 0.5, 1.0 - height), DVec3::X);
    let even = varying(Spectrum::ONE, 0.8, layered(corners, 1, |_| 1.0));
    for (kind, medium) in
        [("even", homogeneous(Spectrum::ONE, Spectrum::grey(0.8), 0.0)), ("could vary", even)]
    {
        let shape = cuboid(corners.0, corners.1);
        let scene = bounded(vec![Region { shape, medium }], Vec::new(), vec![sun(-DVec3::Z)]);
        let source = 0.8 * exp(-height) / FOUR_PI;
        for rule in [StepRule::NearEnd, StepRule::Middle, StepRule::Integrated] {
            for is_jittered in [false, true] {
                let expected = source
                    * match is_jittered {
                        // The fewest equal steps that are no longer.
                        false => by_steps(rule, (2.0, 2.0), depth),
                        true => integrate(0.0, 1.0, 50, |u| by_steps(rule, (x, x * u), depth)),
                    };
                let count = if is_jittered { 20_000 } else { 100 };
                let (found, _) = single(&scene, march(x, rule, is_jittered), &ray, count, 5);
                let what = format!("{kind}, {rule:?}, jittered {is_jittered}");
                verdict::agrees(&what, &found, (expected, 1e-4 * expected), 0.04 * expected, 5);
            }
        }
    }
}

/// In a density that falls and rises along the ray, lit across it, random steps of any length have the mean of the integral.
#[test]
fn random_steps_are_unbiased_where_density_varies() {
    let corners = (DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0));
    let density = layered(corners, 8, |z| 0.2 + (z - 1.7) * (z - 1.7));
    let at = |z: f64| density.at(DVec3::new(0.5, 0.5, z));
    let depth = |z: f64| integrate(0.0, z, 64, at);
    let expected = integrate(0.0, 4.0, 64, |z| at(z) * exp(-depth(z)) * exp(-0.25 * at(z))) * 0.8 / FOUR_PI;
    let shape = cuboid(corners.0, corners.1);
    let medium = varying(Spectrum::ONE, 0.8, density.clone());
    let scene = bounded(vec![Region { shape, medium }], Vec::new(), vec![sun(-DVec3::X)]);
    let ray = Ray::new(DVec3::new(0.75, 0.5, -1.0), DVec3::Z);
    for step in [0.3, 1.5, 9.0] {
        let (found, _) = single(&scene, march(step, StepRule::Integrated, true), &ray, 100_000, 6);
        verdict::agrees(&format!("steps of {step}"), &found, (expected, 1e-6), 0.08 * expected, 6);
    }
}

#[test]
fn steps_share_gathers_without_a_bias() {
    steps_that_share_a_gather_have_their_sum();
}

/// Fog behind a medium whose transmittance is estimated, often by 0: what lies behind is seen through it none the less.
#[test]
fn what_lies_behind_a_varying_medium_is_seen() {
    let (front, behind) = (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::X, DVec3::new(3.0, 1.0, 1.0)));
    // Its upper layer is as dense as the bound of its cells, so that every tentative collision is real.
    let layers = Grid::new((DVec3::ZERO, DVec3::ONE), [1, 2, 1], 1, vec![0.0, 1.0]).unwrap();
    let dense = |sigma_t: f64| varying(Spectrum::grey(sigma_t), 0.5, Density::grid(layers.clone()).unwrap());
    let far = region(behind, 0.7, 0.9, 0.0);
    let regions = vec![Region { shape: front, medium: dense(1.5) }, far];
    let scene = bounded(regions, Vec::new(), vec![sun(-DVec3::Z)]);
    let ray = Ray::new(DVec3::new(-1.0, 0.9, 0.6), DVec3::X);
    let part = |sigma_t: f64, albedo: f64, length: f64| {
        albedo * exp(-0.4 * sigma_t) * -exp_m1(-sigma_t * length) / FOUR_PI
    };
    let expected = part(1.5, 0.5, 1.0) + exp(-1.5) * part(0.7, 0.9, 2.0);
    for step in [0.1, 2.0] {
        let (found, _) = single(&scene, march(step, StepRule::Integrated, true), &ray, 50_000, 7);
        verdict::agrees(&format!("steps of {step}"), &found, (expected, 1e-12), 0.05 * expected, 7);
    }
}

/// Thin fog without end, a lamp and a ball in it: a ray along it takes some hundred steps, however thin the fog and whichever
/// channel meets none, and has the radiance that paths have.
#[test]
fn rays_without_end_take_some_hundred_steps() {
    let scene = |sigma_t: Spectrum| {
        let medium: Medium = homogeneous(sigma_t, Spectrum::grey(0.9), 0.0);
        let shape = Shape::Slab(Slab::new(-1.0, 2.0).unwrap());
        let ball = (sphere(DVec3::new(0.0, 0.5, 0.0), 0.1), lambertian(Spectrum::grey(0.5)));
        let lamp = point_light(DVec3::new(3.0, 1.0, 0.2), Spectrum::ONE);
        bounded(vec![Region { shape, medium }], vec![ball], vec![lamp])
    };
    let ray = Ray::new(DVec3::new(-0.5, 0.0, 0.1), DVec3::new(1.0, 0.1, 0.0).normalize());
    let defaults = |scene: &Scene| march(0.05 * scene_size(scene), StepRule::Integrated, true);
    for sigma_t in [1e-3, 1e-6, 1e-12] {
        let scene = scene(Spectrum::rgb(0.0, sigma_t, 2.0 * sigma_t));
        let (_, steps) = single(&scene, defaults(&scene), &ray, 10, 8);
        assert!(steps < 10 * 1500, "{sigma_t}: {steps}");
    }
    let scene = scene(Spectrum::grey(0.05));
    let (found, _) = single(&scene, defaults(&scene), &ray, 20_000, 8);
    let mut expected = Moments::new();
    for history in 0..20_000 {
        let mut stream = Stream::new(9, Purpose::Paths, 0, history);
        expected.push(path::layers(&scene, ray, None, 0, &mut stream).0.single[1]);
    }
    verdict::agree("a ray without end", &found, &expected, 0.05 * expected.mean(), 8);
}

/// Fog without end whose density is 1 where the ray runs, but could vary: `measure` finds along a level ray by photons what it
/// finds in a homogeneous one.
#[test]
fn level_rays_in_varying_fog_without_end() {
    let read = |medium: Medium, seed: u64| {
        let shape = Shape::Slab(Slab::new(-1.0, 2.0).unwrap());
        let ray = Ray::new(DVec3::new(0.0, 0.3, 0.0), DVec3::X);
        let parts = SceneParts {
            regions: vec![Region { shape, medium }],
            lights: vec![point_light(DVec3::X, Spectrum::ONE)],
            sensors: vec![sensor(Quantity::Radiance(ray), Orders::ALL)],
            ..SceneParts::default()
        };
        let settings = PhotonSettings {
            photons: 1 << 14,
            maps: 32,
            seed,
            orders: Orders::ALL,
            estimator: Estimator::new(Kernel::Uniform, Gather::nearest(50, 1.0).unwrap()),
        };
        let measurements =
            by_photons(&Scene::new(parts).unwrap(), &settings, &NoProgress).unwrap().measurements;
        (measurements[0].mean, measurements[0].std_error.unwrap())
    };
    let matter = homogeneous(Spectrum::grey(0.5), Spectrum::grey(0.9), 0.0);
    let fog =
        Density::HeightFog(HeightFog::new(DVec3::Z, 2.0, Positive::new("scale", 1.0).unwrap()).unwrap());
    let varying = Heterogeneous::new(matter.matter().clone(), fog).into();
    let (even, could_vary) = (read(matter, 1), read(varying, 2));
    let error = libm::hypot(even.1, could_vary.1);
    assert!(error < 0.05 * even.0, "{even:?} {could_vary:?}");
    assert!((even.0 - could_vary.0).abs() < 4.0 * error, "{even:?} {could_vary:?}");
}
