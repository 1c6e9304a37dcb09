//! Treatments: what an estimate does about the part of its ball that lies outside the medium.

use super::images::images;
use super::moments::{LEAST_PART, body_moments, body_part, inward_normal};
use crate::Spectrum;
use crate::estimators::Kernel;
use crate::geometry::Shape;
use crate::photons::Photon;
use glam::DVec3;

/// What an estimate does about the part of its ball that lies outside the medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Treatment {
    /// Nothing: it loses up to half at a face.
    None,
    /// Divides by the part of the kernel that is inside (Diggle 1985).
    Clipped,
    /// Mirrors the photons in each face, edge and corner; in a sphere in the tangent plane (Silverman 1986, 2.10).
    Reflection,
    /// Fits a constant and a slope along the normal (Jones 1993). Exact for linear fields at a flat face, at the cost of
    /// variance; may be negative, and is never clamped.
    LocalLinear,
}

impl Treatment {
    /// Whether estimates about whole rays know it: the others are of balls, and rays take them for [`Treatment::Clipped`].
    pub fn is_of_rays(self) -> bool {
        matches!(self, Treatment::None | Treatment::Clipped)
    }

    /// Every one.
    pub const ALL: [Treatment; 4] =
        [Treatment::None, Treatment::Clipped, Treatment::Reflection, Treatment::LocalLinear];

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Treatment::None => "none",
            Treatment::Clipped => "clipped",
            Treatment::Reflection => "reflection",
            Treatment::LocalLinear => "local linear",
        }
    }
}

/// The photons that a sum is made of.
pub(in crate::estimators) trait Gathered {
    /// Visits each with its weight K(u), as far as it counts.
    fn each(&self, kernel: Kernel, visit: &mut dyn FnMut(&Photon, f64));
}

impl Treatment {
    /// The treated sum of power x value x K_r where a medium ends within `radius` of a point, from the untreated one.
    pub(in crate::estimators) fn treated(
        self,
        (medium, point, radius): (&Shape, DVec3, f64),
        kernel: Kernel,
        plain: Spectrum,
        photons: &impl Gathered,
        value: &dyn Fn(&Photon) -> f64,
    ) -> Spectrum {
        let r3 = radius * radius * radius;
        match self {
            Treatment::None => plain,
            Treatment::Clipped => plain / body_part(kernel, medium, point, radius),
            Treatment::Reflection => {
                let images = images(medium, point, radius);
                // The uniform kernel's weight is the part of each photon that counts: images of the k-th count no more than
                // the k-th does, not even on a face, where they are as far away.
                let whole = Kernel::Uniform.peak();
                let mut sum = plain;
                photons.each(Kernel::Uniform, &mut |photon, share| {
                    let weights = images.iter().map(|image| kernel.at((photon.position - image) / radius));
                    let weight = share / whole * weights.sum::<f64>() / r3 * value(photon);
                    sum += Spectrum(photon.power.as_dvec3()) * weight;
                });
                sum
            }
            Treatment::LocalLinear => {
                let normal = inward_normal(medium, point);
                let mut first = Spectrum::ZERO;
                photons.each(kernel, &mut |photon, weight| {
                    let z = (photon.position - point).dot(normal) / radius;
                    first += Spectrum(photon.power.as_dvec3()) * (weight * z / r3 * value(photon));
                });
                linear(body_moments(kernel, medium, point, radius), plain, first)
            }
        }
    }
}

/// The constant of the straight line fitted to a field with moments S_0 and S_1; that of a constant, in a body too thin for a
/// line.
fn linear([m0, m1, m2]: [f64; 3], s0: Spectrum, s1: Spectrum) -> Spectrum {
    let determinant = m0 * m2 - m1 * m1;
    if determinant > 0.0 { (s0 * m2 - s1 * m1) / determinant } else { s0 / m0.max(LEAST_PART) }
}
