//! Points along a ray, each with a radius of its own: sums by hand.

use crate::support::scenes::homogeneous;
use glam::{DVec3, Vec3};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Kernel, RayEstimator};
use turbid::math::{Interval, Positive, Ray, exp};
use turbid::photons::{Flags, Photon, PhotonMap};

/// A photon of power 1 that comes straight from a light.
pub fn photon(position: DVec3, dir: Vec3) -> Photon {
    Photon { position, dir, normal: Vec3::ZERO, power: Vec3::ONE, order: 0, flags: Flags::NONE }
}

/// An estimator of points along rays that is not clipped.
pub fn reading(kernel: Kernel, radius: f64) -> RayEstimator {
    RayEstimator { kernel, radius: Positive::new("the radius", radius).unwrap(), is_clipped: false }
}

/// A photon beside a ray whose fourth neighbour is a tenth away: the products of five factors of a fixed radius of a tenth, published;
/// with fewer neighbours it does not reach the ray, with more it has the radius of the cap. Its neighbours have their feet behind the
/// end of the stretch.
pub fn own_radii_by_hand() {
    let ray = Ray::new(DVec3::new(-2.0, 0.03, 0.7), DVec3::X);
    let span = Interval { start: 0.0, end: 2.51 };
    let place = DVec3::new(0.5, 0.06, 0.74);
    let neighbors = [0.02, 0.04, 0.08, 0.1].map(|x| photon(place + DVec3::X * x, Vec3::Z));
    let photons = [&[photon(place, Vec3::Z)], &neighbors[..]].concat();
    let map = PhotonMap::new(photons, 1).unwrap();
    let even = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.5);
    let beer = |t: f64| Spectrum::grey(exp(-t));
    for (kernel, k, cap, expected) in [
        (Kernel::Uniform, 4, 0.3, 0.055_791_79),
        (Kernel::Epanechnikov, 4, 0.3, 0.083_687_69),
        (Kernel::Biweight, 4, 0.3, 0.094_148_65),
        (Kernel::Uniform, 1, 0.3, 0.0),
        (Kernel::Uniform, 2, 0.3, 0.0),
        (Kernel::Uniform, 5, 0.2, 0.055_791_79 / 4.0),
        (Kernel::Uniform, 4, 0.0499, 0.0),
    ] {
        let radii = map.radii(k, cap);
        let read = reading(kernel, cap);
        let of = (&map, &radii);
        let estimate = read.radiance_by_radii(of, (&ray, span), &even, &Boundary::UNKNOWN, &beer);
        let found = estimate.value[0];
        assert!((found - expected).abs() <= 1e-6 * expected, "{kernel:?} k={k} cap {cap}: {found}");
        assert_eq!(estimate.found, usize::from(expected > 0.0), "k={k} cap {cap}");
    }
}
