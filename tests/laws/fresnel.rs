//! Fresnel's equations and Snell's law, against amplitudes, closed forms and each other.

use crate::support::quadrature::integrate;
use glam::DVec3;
use proptest::prelude::*;
use turbid::math::ln;
use turbid::surface::{fresnel, refract};

/// Cosine of refraction by the sine, as a textbook has it.
fn far_cosine(near: f64, far: f64, cosine: f64) -> f64 {
    let sine = near / far * ((1.0 - cosine) * (1.0 + cosine)).sqrt();
    ((1.0 - sine) * (1.0 + sine)).sqrt()
}

proptest! {
    /// What is not reflected is transmitted: by the amplitudes t_s and t_p and the width of the beam, where the
    /// subtraction in c2 keeps its digits.
    #[test]
    fn energy_is_kept(near in 1.0..4.0f64, far in 1.0..4.0f64, cosine in 0.0..1.0f64) {
        let found = fresnel(near, far, cosine);
        prop_assert!((0.0..=1.0).contains(&found.reflectance));
        if near / far * ((1.0 - cosine) * (1.0 + cosine)).sqrt() < 0.999 && near != far {
            let c2 = far_cosine(near, far, cosine);
            let s = 2.0 * near * cosine / (near * cosine + far * c2);
            let p = 2.0 * near * cosine / (far * cosine + near * c2);
            let transmitted = 0.5 * (s * s + p * p) * far * c2 / (near * cosine.max(1e-300));
            // Rounding of 1 - sine^2 at a sine of 0.999 costs a factor of 1/(2 x 0.001).
            prop_assert!(cosine == 0.0 || (found.reflectance + transmitted - 1.0).abs() < 1e-12);
            prop_assert!((found.cos_far - c2).abs() < 1e-12);
        }
    }

    /// A ray and its reverse are reflected alike; the refracted ray goes back to where it came from, in the plane of
    /// incidence, with n sin the same on both sides.
    #[test]
    fn light_finds_its_way_back(near in 1.0..4.0f64, far in 1.0..4.0f64, x in -1.0..1.0f64, y in -1.0..1.0f64) {
        prop_assume!(x * x + y * y < 1.0 && near != far);
        let dir = DVec3::new(x, y, -(1.0 - x * x - y * y).sqrt()).normalize();
        let cosine = -dir.z;
        let there = fresnel(near, far, cosine);
        prop_assume!(there.cos_far > 1e-3 && cosine > 1e-3);
        let back = fresnel(far, near, there.cos_far);
        prop_assert!((there.reflectance - back.reflectance).abs() < 1e-12);
        let out = refract(dir, DVec3::Z, near / far, (cosine, there.cos_far));
        prop_assert!((out.length() - 1.0).abs() < 1e-15 && out.z < 0.0);
        prop_assert!((near * dir.truncate() - far * out.truncate()).length() < 1e-14);
        let again = refract(-out, DVec3::NEG_Z, far / near, (there.cos_far, back.cos_far));
        prop_assert!((again + dir).length() < 1e-12);
    }
}

#[test]
fn angles_with_a_name() {
    for (near, far) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.33), (1.36, 1.5), (1.0, 2.4)] {
        let upright = (near - far) / (near + far);
        assert!((fresnel(near, far, 1.0).reflectance - upright * upright).abs() < 1e-16);
        // Brewster: tan = far/near; light polarised in the plane is not reflected.
        let s = (near * near - far * far) / (near * near + far * far);
        let brewster = near / (near * near + far * far).sqrt();
        assert!((fresnel(near, far, brewster).reflectance - 0.5 * s * s).abs() < 1e-15);
        let grazing = fresnel(near, far, 0.0);
        assert_eq!(grazing.reflectance, 1.0);
        // To first order in the cosine 1 - R = 2 c (n + 1/n) n / root(n^2 - 1), n = far/near > 1.
        if far > near {
            let n = far / near;
            let slope = 2.0 * (n * n + 1.0) / (n * n - 1.0).sqrt();
            let lost = 1.0 - fresnel(near, far, 1e-6).reflectance;
            assert!((lost / (slope * 1e-6) - 1.0).abs() < 1e-4, "{lost}");
        } else {
            // The critical cosine is root(1 - (far/near)^2).
            let critical = ((near - far) * (near + far)).sqrt() / near;
            assert_eq!(fresnel(near, far, critical * (1.0 - 1e-12)).reflectance, 1.0);
            let just = fresnel(near, far, critical * (1.0 + 1e-12)).reflectance;
            assert!(just < 1.0 && just > 1.0 - 1e-4, "{just}");
        }
    }
    let matched = fresnel(1.5, 1.5, 0.3);
    assert_eq!((matched.reflectance, matched.cos_far), (0.0, 0.3));
    // Nearly equal indices: R = (dn/2n)^2 at normal incidence, where the difference has lost nothing.
    let nearly = fresnel(1.0, 1.0 + 1e-8, 1.0).reflectance;
    assert!((nearly / 2.5e-17 - 1.0).abs() < 1e-7, "{nearly}");
}

/// Reflectance of Lambertian light that comes from the thinner side (Walsh 1926; Duntley 1942).
fn diffuse_reflectance(n: f64) -> f64 {
    let m = n * n;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + m * (m - 1.0) * (m - 1.0) / (m + 1.0).powi(3) * ln((n - 1.0) / (n + 1.0))
        - 2.0 * m * n * (m + 2.0 * n - 1.0) / ((m + 1.0) * (m * m - 1.0))
        + 8.0 * m * m * (m * m + 1.0) / ((m + 1.0) * (m * m - 1.0) * (m * m - 1.0)) * ln(n)
}

/// Over the hemisphere: 2 int R c dc in closed form; and, by n^2 sin cos being the same on both sides,
/// 1 - R_inside = (1 - R_outside)/n^2, total reflection included.
#[test]
fn hemispheres() {
    for n in [1.1, 1.33, 1.5, 2.4] {
        // The integrand has a root at the horizon and at the critical angle: substituted away.
        let outside = integrate(0.0, 1.0, 8, |v| 4.0 * v * v * v * fresnel(1.0, n, v * v).reflectance);
        assert!((outside - diffuse_reflectance(n)).abs() < 1e-12, "{n}: {outside}");
        let critical = (1.0 - 1.0 / (n * n)).sqrt();
        let above = integrate(0.0, 1.0, 8, |v| {
            let c = critical + (1.0 - critical) * v * v;
            4.0 * v * (1.0 - critical) * c * fresnel(n, 1.0, c).reflectance
        });
        let inside = critical * critical + above;
        assert!((1.0 - inside - (1.0 - outside) / (n * n)).abs() < 1e-12, "{n}: {inside}");
    }
}
