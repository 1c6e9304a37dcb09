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

    /// By paths, which know nothing of fluences: what they find of all scattered light less what they find of once scattered light.
    #[test]
    fn exact_values_are_positive_and_known_to_a_part_in_a_million() {
        for medium in Medium::ALL {
            let (value, error) = exact(medium).unwrap();
            assert!(value > 0.0 && error < 1e-6 * value, "{medium:?}: {value} {error}");
        }
    }

    /// A thin ball: single scattering of light that has collided once, about the albedo squared times an optical depth squared.
    #[test]
    fn a_thin_ball_turns_light_twice_as_seldom_as_its_depth_squared() {
        let (value, _) = exact(Medium::Thin).unwrap();
        let once = ALBEDO * Medium::Thin.span().end / std::f64::consts::PI;
        assert!(value < ALBEDO * 0.1 * once && value > 0.2 * ALBEDO * 0.1 * once, "{value} {once}");
    }
}
