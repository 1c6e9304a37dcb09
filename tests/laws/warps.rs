//! Warps and frames: density = 1 / Jacobian, the right support, orthonormal at the poles.

use crate::common::config as properties;
use crate::support::unit_vector;
use glam::DVec3;
use proptest::prelude::*;
use std::f64::consts::PI;
use turbid::math::{FOUR_PI, Frame, warp};

/// Step of the central differences: the azimuth's third derivative makes a relative error of (2 pi h)^2/6 each way.
const STEP: f64 = 1e-6;

/// Area on the target per area of the square, by central differences.
fn jacobian(warp: impl Fn([f64; 2]) -> DVec3, [u, v]: [f64; 2]) -> f64 {
    let du = (warp([u + STEP, v]) - warp([u - STEP, v])) / (2.0 * STEP);
    let dv = (warp([u, v + STEP]) - warp([u, v - STEP])) / (2.0 * STEP);
    du.cross(dv).length()
}

/// Differences of numbers of size s lose eps s / h: 2e-10; the third derivatives give 7e-12, more where roots bend:
/// u stays 0.02 away from the ends, where (h/u)^2 = 2.5e-9.
const TOLERANCE: f64 = 5e-9;

proptest! {
    #![proptest_config(properties(2000))]

    #[test]
    fn densities_are_the_inverse_of_the_jacobian(u in 0.02..0.98f64, v in 0.02..0.98f64, log_cone in -30.0..0.69f64) {
        let sphere = jacobian(warp::square_to_sphere, [u, v]) * warp::pdf_sphere();
        prop_assert!((sphere - 1.0).abs() < TOLERANCE, "sphere {sphere}");
        let mu = warp::square_to_cosine_hemisphere([u, v]).z;
        let hemisphere = jacobian(warp::square_to_cosine_hemisphere, [u, v]) * warp::pdf_cosine_hemisphere(mu);
        prop_assert!((hemisphere - 1.0).abs() < TOLERANCE, "hemisphere {hemisphere}");
        let disc = jacobian(|u| warp::square_to_disc(u).extend(0.0), [u, v]) * warp::pdf_disc();
        prop_assert!((disc - 1.0).abs() < TOLERANCE, "disc {disc}");
        let open = turbid::math::exp(log_cone);
        let cone = jacobian(|u| warp::square_to_cone(u, open), [u, v]) * warp::pdf_cone(open);
        prop_assert!((cone - 1.0).abs() < TOLERANCE, "cone {cone} of {open}");
    }

    #[test]
    fn warps_stay_on_their_targets(u in 0.0..1.0f64, v in 0.0..1.0f64, open in 0.0..2.0f64) {
        for u in [u, 0.0, f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0] {
            for v in [v, 0.0, 1.0 - f64::EPSILON / 2.0] {
                let hemisphere = warp::square_to_cosine_hemisphere([u, v]);
                let cone = warp::square_to_cone([u, v], open);
                for dir in [warp::square_to_sphere([u, v]), hemisphere, cone] {
                    prop_assert!((dir.length() - 1.0).abs() <= 4.0 * f64::EPSILON);
                }
                prop_assert!(hemisphere.z >= 0.0);
                prop_assert!(cone.z >= 1.0 - open - 2.0 * f64::EPSILON);
                prop_assert!(warp::square_to_disc([u, v]).length() <= 1.0 + f64::EPSILON);
            }
        }
    }

    /// The square is covered once, with the density that it is said to have, on both halves of the sphere.
    #[test]
    fn octahedra_unfold_onto_their_square(u in -0.98..0.98f64, v in -0.98..0.98f64) {
        let place = glam::DVec2::new(u, v);
        let dir = warp::from_octahedral(place);
        prop_assert!((dir.length() - 1.0).abs() <= 4.0 * f64::EPSILON);
        prop_assert!((warp::octahedral(dir) - place).length() < 1e-15, "{dir} of {place}");
        // Folds: along the axes and the inner square's edges.
        let fold = u.abs().min(v.abs()).min((1.0 - u.abs() - v.abs()).abs());
        prop_assume!(fold > 1e-3);
        let density = jacobian(|[u, v]| warp::from_octahedral(glam::DVec2::new(u, v)), [u, v]) * warp::octahedral_density(dir);
        prop_assert!((density - 1.0).abs() < TOLERANCE, "{density} at {place}");
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed(z in -1.0..=1.0f64, azimuth in 0.0..6.3f64, near in 0.0..40.0f64) {
        let tilt = turbid::math::exp(-near);
        let near_pole = |sign: f64| DVec3::new(tilt, -0.5 * tilt, sign).normalize();
        let poles = [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.0, 0.0, -1.0), DVec3::new(-0.0, -0.0, 1.0)];
        let equator = [DVec3::X, DVec3::new(-1.0, 0.0, -0.0), DVec3::new(0.0, -1.0, 0.0)];
        for dir in [unit_vector(z, azimuth), near_pole(1.0), near_pole(-1.0)].into_iter().chain(poles).chain(equator) {
            let Frame { x, y, z } = Frame::new(dir);
            // Duff et al. 2017 find 1e-15 in double precision at the worst place.
            for (product, expected) in [(x.dot(x), 1.0), (y.dot(y), 1.0), (x.dot(y), 0.0), (x.dot(z), 0.0), (y.dot(z), 0.0)] {
                prop_assert!((product - expected).abs() <= 1.5e-15, "{dir}: {product}");
            }
            prop_assert!((x.cross(y) - dir).length() <= 2e-15 && z == dir);
            let v = DVec3::new(0.3, -2.0, 0.7);
            let frame = Frame::new(dir);
            prop_assert!((frame.to_local(frame.to_world(v)) - v).length() <= 1e-14);
        }
    }
}

/// Areas by their formulas: the densities integrate to 1 over sphere, hemisphere, disc and cone.
#[test]
fn densities_are_normalised() {
    assert!((warp::pdf_sphere() * FOUR_PI - 1.0).abs() < 1e-15);
    assert!((warp::pdf_disc() * PI - 1.0).abs() < 1e-15);
    let hemisphere =
        crate::support::quadrature::integrate(0.0, 1.0, 1, |mu| 2.0 * PI * warp::pdf_cosine_hemisphere(mu));
    assert!((hemisphere - 1.0).abs() < 1e-14);
    assert_eq!(warp::pdf_cosine_hemisphere(-0.5), 0.0);
    for open in [1e-18, 0.5, 2.0] {
        assert!((warp::pdf_cone(open) * 2.0 * PI * open - 1.0).abs() < 1e-15);
    }
}
