//! A point light in fog: single scattering along a ray against its closed form, and intervals that can be trusted.
//!
//! Connections from free flights alone have an infinite variance: they are the wrong twin. A ray that passes
//! the light at a distance b sees it as 1/b; over all directions from a point that leaves a variance that diverges,
//! if only as a logarithm, so that intervals are promised for radiances and for lights with an extent.

use crate::support::quadrature::integrate;
use crate::support::run::{numbers, paths};
use crate::support::scenes::{bounded, homogeneous, point_light, sphere};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{FOUR_PI, Ray, exp};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene};
use turbid::stats::{Moments, mean_interval, wilson_interval};
use turbid::transport::{Flight, free_flight};

/// Sets of paths, and paths a set.
const SETS: u64 = 2000;
const PER_SET: u64 = 1000;
/// How far rays pass from the light [L]: beside it, and so close that free flights hardly ever find it.
const BESIDE: f64 = 0.05;
const CLOSE: f64 = 1e-3;

fn fog(sigma_t: Spectrum, albedo: Spectrum) -> Scene {
    let ball = sphere(DVec3::ZERO, 1.0);
    let region = Region { shape: ball, medium: homogeneous(sigma_t, albedo, 0.0) };
    bounded(vec![region], Vec::new(), vec![point_light(DVec3::ZERO, Spectrum::ONE)])
}

/// Starts inside, so that both parts of the way, towards the light and past it, are in the fog.
fn ray(nearest: f64) -> Ray {
    Ray::new(DVec3::new(nearest, 0.0, -0.6), DVec3::Z)
}

/// The integral of sigma_s e^(-sigma_t (t + r)) / (16 pi^2 r^2) along the ray. With the distance past the nearest point
/// as b sinh x, r is b cosh x, and what is left is smooth in x.
fn single_scattering(sigma_t: f64, albedo: f64, nearest: f64) -> f64 {
    let end = (1.0 - nearest * nearest).sqrt();
    let integrand = |x: f64| {
        let (along, r) = (nearest * libm::sinh(x), nearest * libm::cosh(x));
        exp(-sigma_t * (0.6 + along + r)) / r
    };
    let ends = (libm::asinh(-0.6 / nearest), libm::asinh(end / nearest));
    sigma_t * albedo / (FOUR_PI * FOUR_PI) * integrate(ends.0, ends.1, 64, integrand)
}

fn sample(scene: &Scene, nearest: f64, stream: &mut Stream) -> f64 {
    turbid::sensor::sample(scene, &Quantity::Radiance(ray(nearest)), Orders::only(1), stream)[0]
}

/// The same from a free flight alone.
fn by_free_flight(scene: &Scene, nearest: f64, stream: &mut Stream) -> f64 {
    match free_flight(scene, &ray(nearest), f64::INFINITY, Spectrum::ONE, false, stream) {
        Flight::Passed(_) => 0.0,
        Flight::Collision { t, .. } => {
            let r2 = ray(nearest).at(t).length_squared();
            let medium = &scene.regions()[0].medium;
            medium.albedo()[0] / FOUR_PI * exp(-medium.sigma_t()[0] * r2.sqrt()) / (FOUR_PI * r2)
        }
    }
}

/// How many of the sets' 95 % intervals contain the reference, and the largest variance of variance.
fn coverage(reference: f64, sample: impl Fn(&mut Stream) -> f64) -> (u64, f64) {
    let (mut covered, mut vov) = (0, 0.0f64);
    for set in 0..SETS {
        let values = (0..PER_SET).map(|h| sample(&mut Stream::new(1, Purpose::Synthetic, set, h)));
        let moments: Moments = values.collect();
        covered += u64::from(mean_interval(&moments, 0.95).contains(reference));
        vov = vov.max(moments.vov());
    }
    (covered, vov)
}

#[test]
fn intervals_cover_with_equal_angles_and_not_without() {
    let scene = fog(Spectrum::ONE, Spectrum::grey(0.9));
    let reference = single_scattering(1.0, 0.9, CLOSE);
    let (covered, vov) = coverage(reference, |s| sample(&scene, CLOSE, s));
    let interval = wilson_interval(covered, SETS, 1.0 - 1e-6);
    verdict::println_line(&format!(
        "equal angles cover {covered} of {SETS}, variance of variance at most {vov:.3}"
    ));
    assert!(interval.contains(0.95), "equal angles cover {covered} of {SETS}; {interval:?}");
    assert!(vov < 0.1, "variance of variance {vov}");
    let (covered, vov) = coverage(reference, |s| by_free_flight(&scene, CLOSE, s));
    let interval = wilson_interval(covered, SETS, 1.0 - 1e-6);
    verdict::println_line(&format!(
        "free flights cover {covered} of {SETS}, variance of variance up to {vov:.3}"
    ));
    assert!(interval.high < 0.95, "free flights alone cover {covered} of {SETS}: a wrong twin passes");
}

/// Grey and in colour, thin (forced flights) and thick: the shares of the two ways to find the light add up to one. A
/// share that differed between them by channel weights would show here.
#[test]
fn single_scattering_is_the_integral() {
    let albedo = Spectrum::rgb(0.9, 0.5, 1.0);
    let cases = [
        Spectrum::ONE,
        Spectrum::rgb(0.2, 1.0, 5.0),
        Spectrum::rgb(8.0, 0.3, 0.1),
        Spectrum::grey(1e-3),
        Spectrum::rgb(1e-3, 1e-2, 3e-2),
    ];
    for sigma_t in cases {
        let scene = fog(sigma_t, albedo);
        let moments = paths(&scene, Quantity::Radiance(ray(BESIDE)), Orders::only(1), 1 << 19, 2);
        for c in 0..3 {
            let expected = single_scattering(sigma_t[c], albedo[c], BESIDE);
            verdict::agrees(
                &format!("sigma_t {}, channel {c}", sigma_t.0),
                &moments[c],
                (expected, 1e-12 * expected),
                0.02 * expected,
                2,
            );
        }
    }
    let scene = fog(Spectrum::ONE, Spectrum::grey(0.9));
    let twice = numbers(1 << 19, 3, |s| sample(&scene, BESIDE, s) + by_free_flight(&scene, BESIDE, s));
    assert!(twice.mean() > 1.5 * single_scattering(1.0, 0.9, BESIDE), "both in full must differ");
}
