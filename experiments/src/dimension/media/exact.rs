//! The exact radiance along a ray of each medium, of light scattered twice and more.

use super::cases::{ALBEDO, COSINE, INSIDE, Medium, PEAK};
use crate::setups::Body;
use anyhow::bail;
use turbid::math::{FOUR_PI, Ray};
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{Incidence, Phase, Slab, SlabMedium, Sphere, SphereSource};

/// Panels of a ray, and nodes of each.
const PANELS: usize = 16;
/// See [`PANELS`].
const NODES: usize = 8;

/// The value and the bound on its error, per unit of irradiance.
pub fn exact(medium: Medium) -> anyhow::Result<(f64, f64)> {
    let body = medium.setup().body;
    match body {
        // Along the faces what a slab sends is the source itself, as that of an endless ray, of which a length is asked.
        Body::Slab { thickness } if medium == Medium::Thick => {
            let (endless, error) = slab(thickness, 0.0, (INSIDE, 0.0))?;
            let part = -libm::expm1(-medium.span().end);
            Ok((part * endless, part * error))
        }
        Body::Slab { thickness } => slab(thickness, PEAK, (thickness, -COSINE)),
        Body::Sphere { radius } => {
            let sphere = Sphere::new(radius, ALBEDO, SphereSource::Incident)?;
            along(medium, |ray, s| {
                let r = ray.at(s).length().min(radius);
                let (all, direct) = (sphere.fluence(r)?, sphere.fluence_direct(r)?);
                Ok((all.value - direct.value, all.error + direct.error))
            })
        }
        Body::Cuboid { .. } => bail!("no radiance along rays through {body:?} is known exactly"),
    }
}

/// The radiance in a slab under a normal beam, at a depth and of a cosine.
fn slab(thickness: f64, g: f64, (depth, mu): (f64, f64)) -> anyhow::Result<(f64, f64)> {
    let phase = if g == 0.0 { Phase::isotropic() } else { Phase::henyey_greenstein(g)? };
    let incidence = Incidence::Beam { mu0: 1.0 };
    let all = Slab::solve(thickness, &SlabMedium::new(ALBEDO, &phase)?, incidence)?;
    let (all, once) =
        (all.radiance(depth, mu, 0.0)?, single_radiance(thickness, ALBEDO, g, 1.0, depth, mu, 0.0)?);
    Ok((all.value - once.value, all.error + once.error))
}

/// The integral of e^(-s) albedo phi/(4 pi) along the first ray, phi the fluence of scattered light, isotropic scattering. The bound is
/// the fluence's, and the difference from half as many panels.
fn along(
    medium: Medium,
    collided: impl Fn(&Ray, f64) -> anyhow::Result<(f64, f64)>,
) -> anyhow::Result<(f64, f64)> {
    let (ray, length) = (medium.rays()[0], medium.span().end);
    let rule = GaussLegendre::new(NODES)?;
    let integral = |panels: usize| -> anyhow::Result<(f64, f64)> {
        let step = length / panels as f64;
        let (mut sum, mut bound) = (0.0, 0.0);
        for panel in 0..panels {
            for (u, w) in rule.nodes.iter().zip(&rule.weights) {
                let s = (panel as f64 + u) * step;
                let (value, error) = collided(&ray, s)?;
                let weight = step * w * libm::exp(-s) * ALBEDO / FOUR_PI;
                sum += weight * value;
                bound += weight * error;
            }
        }
        Ok((sum, bound))
    };
    let ((fine, bound), (coarse, _)) = (integral(PANELS)?, integral(PANELS / 2)?);
    Ok((fine, bound + (fine - coarse).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use turbid_analytic::IsotropicSlab;

    #[test]
    fn values_are_positive_and_known_to_some_parts_in_a_million() {
        for medium in Medium::ALL {
            let (value, error) = exact(medium).unwrap();
            assert!(value > 0.0 && error < 3e-6 * value, "{medium:?}: {value} {error}");
        }
    }

    /// With what is scattered once and what passes it is all that leaves the ball.
    #[test]
    fn orders_add_up_in_balls() {
        for medium in [Medium::Thin, Medium::Bounded] {
            let Body::Sphere { radius } = medium.setup().body else { panic!() };
            let sphere = Sphere::new(radius, ALBEDO, SphereSource::Incident).unwrap();
            let (once, _) = along(medium, |ray, s| {
                Ok((sphere.fluence_direct(ray.at(s).length().min(radius))?.value, 0.0))
            })
            .unwrap();
            let length = medium.span().end;
            let all = sphere.exit_radiance(0.5 * length / radius).unwrap().value;
            let sum = exact(medium).unwrap().0 + once + libm::exp(-length) / PI;
            assert!((sum / all - 1.0).abs() < 1e-7, "{medium:?}: {sum} {all}");
        }
    }

    /// Along the faces the source is that of the fluence.
    #[test]
    fn along_the_faces_it_is_the_fluence() {
        let slab = IsotropicSlab::new(8.0, ALBEDO, Incidence::Beam { mu0: 1.0 }).unwrap();
        let scattered = slab.fluence(INSIDE).unwrap().value - libm::exp(-INSIDE);
        let once = slab.with(0.0, Incidence::Beam { mu0: 1.0 }).unwrap().fluence(INSIDE).unwrap().value;
        assert!((once - libm::exp(-INSIDE)).abs() < 1e-12);
        let expected = ALBEDO / FOUR_PI * scattered * -libm::expm1(-Medium::Thick.span().end);
        let (value, _) = exact(Medium::Thick).unwrap();
        assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
    }

    /// By adding and doubling, which know nothing of discrete ordinates' modes.
    #[test]
    fn behind_a_peaked_slab_by_doubling() {
        let phase = Phase::henyey_greenstein(PEAK).unwrap();
        let medium = SlabMedium::new(ALBEDO, &phase).unwrap();
        let slab = Slab::by_doubling(4.0, &medium, Incidence::Beam { mu0: 1.0 }).unwrap();
        let all = slab.radiance(4.0, -COSINE, 0.0).unwrap();
        let once = single_radiance(4.0, ALBEDO, PEAK, 1.0, 4.0, -COSINE, 0.0).unwrap().value;
        let (value, error) = exact(Medium::Peaked).unwrap();
        let found = all.value - once;
        assert!((found - value).abs() < all.error + error + 1e-6 * value, "{found} {value}");
    }
}
