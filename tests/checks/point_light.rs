//! Single scattering near a point light: intervals that cover, and those of free flights alone, which do not.

use crate::support::quadrature::integrate;
use crate::support::scenes::{bounded, homogeneous, point_light, sphere};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{FOUR_PI, Ray, exp};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, SURROUNDINGS, Scene};
use turbid::stats::{Moments, mean_interval};
use turbid::transport::{Flight, free_flight};

/// Sets of paths, and paths a set.
const SETS: u64 = 2000;
const PER_SET: u64 = 1000;
/// How far rays pass from the light [L]: beside it, and so close that free flights hardly ever find it.
pub const BESIDE: f64 = 0.05;
const CLOSE: f64 = 1e-3;

/// A ball of fog about a point light.
pub fn fog(sigma_t: Spectrum, albedo: Spectrum) -> Scene {
    let ball = sphere(DVec3::ZERO, 1.0);
    let region = Region { shape: ball, medium: homogeneous(sigma_t, albedo, 0.0) };
    bounded(vec![region], Vec::new(), vec![point_light(DVec3::ZERO, Spectrum::ONE)])
}

/// Starts inside, so that both parts of the way, towards the light and past it, are in the fog.
pub fn ray(nearest: f64) -> Ray {
    Ray::new(DVec3::new(nearest, 0.0, -0.6), DVec3::Z)
}

/// The integral of sigma_s e^(-sigma_t (t + r)) / (16 pi^2 r^2) along the ray. With the distance past the nearest point
/// as b sinh x, r is b cosh x, and what is left is smooth in x.
pub fn single_scattering(sigma_t: f64, albedo: f64, nearest: f64) -> f64 {
    single_scattering_up_to((1.0 - nearest * nearest).sqrt(), sigma_t, albedo, nearest)
}

/// The same up to a wall at the height `end` \[L\], inside the fog.
pub fn single_scattering_up_to(end: f64, sigma_t: f64, albedo: f64, nearest: f64) -> f64 {
    let integrand = |x: f64| {
        let (along, r) = (nearest * libm::sinh(x), nearest * libm::cosh(x));
        exp(-sigma_t * (0.6 + along + r)) / r
    };
    let ends = (libm::asinh(-0.6 / nearest), libm::asinh(end / nearest));
    sigma_t * albedo / (FOUR_PI * FOUR_PI) * integrate(ends.0, ends.1, 64, integrand)
}

/// One path's single scattering: equal angles and free flight share.
pub fn by_both(scene: &Scene, nearest: f64, stream: &mut Stream) -> f64 {
    turbid::sensor::sample(scene, &Quantity::Radiance(ray(nearest)), Orders::only(1), stream)[0]
}

/// The same from a free flight alone: its variance is infinite.
pub fn by_free_flight(scene: &Scene, nearest: f64, stream: &mut Stream) -> f64 {
    match free_flight(scene, &ray(nearest), f64::INFINITY, SURROUNDINGS, Spectrum::ONE, false, stream) {
        Flight::Uncollided(_) => 0.0,
        Flight::Collision { t, .. } => {
            let r2 = ray(nearest).at(t).length_squared();
            let medium = scene.regions()[0].medium.matter();
            medium.albedo()[0] / FOUR_PI * exp(-medium.sigma_t()[0] * r2.sqrt()) / (FOUR_PI * r2)
        }
    }
}

/// 95 % intervals of 2,000 sets of paths cover their level, and no set's variance is carried by a few paths.
pub fn intervals_cover(sample: fn(&Scene, f64, &mut Stream) -> f64) {
    let scene = fog(Spectrum::ONE, Spectrum::grey(0.9));
    let reference = single_scattering(1.0, 0.9, CLOSE);
    let (mut covered, mut vov) = (0, 0.0f64);
    for set in 0..SETS {
        let values =
            (0..PER_SET).map(|h| sample(&scene, CLOSE, &mut Stream::new(1, Purpose::Synthetic, set, h)));
        let moments: Moments = values.collect();
        covered += u64::from(mean_interval(&moments, 0.95).contains(reference));
        vov = vov.max(moments.vov());
    }
    verdict::rate("coverage of 95 % intervals", covered, SETS, 0.95, 0.04, 1);
    assert!(vov < 0.1, "variance of variance {vov}");
}
