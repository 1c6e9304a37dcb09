//! The four treatments, and what each expects of a field at a fixed radius.

use super::body::{Body, Place, length};
use super::profile::Profile;
use super::rule::{Rule, settle};
use super::shell::{CheckedField, F0, F1, Field, Sums, U0, U1, U2};
use crate::error::{Error, Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::value::Value;

pub(super) const METHOD: &str = "shells about the probe, two orders of Gauss rules";

/// What an estimate does about the part of its ball that lies outside the medium.
///
/// With z = (y - x).n/r along the inward normal n of the nearest boundary point, M_j = int_O K_r(y-x) z^j dy over the
/// medium O and S_j = sum q_p K_r(x_p - x) z_p^j over the photons:
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    /// S_0: half of the field on a flat face.
    None,
    /// S_0/M_0: the ball's mass inside the medium only.
    Clipped,
    /// Every photon counts with its mirror images too: in each flat face, and in faces of different axes one after the
    /// other (slab two, cuboid seven near a corner, more where opposite faces are within reach); in a sphere in the
    /// tangent plane at the nearest point. No images of images in the same axis: complete up to the shortest edge.
    Reflection,
    /// (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2): the value at the probe of the straight line fitted along n.
    LocalLinear,
}

impl Treatment {
    /// All of them.
    pub const ALL: [Treatment; 4] =
        [Treatment::None, Treatment::Clipped, Treatment::Reflection, Treatment::LocalLinear];
}

/// Tables of the shells that a treatment needs.
pub(super) struct Gather<'a> {
    treatment: Treatment,
    kernel: Kernel,
    pub(super) own: Profile<'a>,
    images: Vec<Profile<'a>>,
}

impl<'a> Gather<'a> {
    pub(super) fn new(
        rule: &'a Rule,
        treatment: Treatment,
        kernel: Kernel,
        place: &Place,
        end: f64,
        asked: &CheckedField,
    ) -> Self {
        let own = Profile::new(rule, &place.own, end, asked);
        let images = match treatment {
            Treatment::Reflection => {
                place.images.iter().map(|image| Profile::new(rule, image, end, asked)).collect()
            }
            _ => Vec::new(),
        };
        Gather { treatment, kernel, own, images }
    }

    /// Radii between which the mean changes smoothly.
    pub(super) fn ends(&self) -> Vec<f64> {
        std::iter::once(&self.own).chain(&self.images).flat_map(Profile::ends).collect()
    }

    /// Expectation of the estimate at radius r, and how much larger its terms are.
    pub(super) fn mean(&self, r: f64) -> Result<(f64, f64)> {
        let density = |u: f64| self.kernel.density(Dimension::Three, u) / (r * r * r);
        let sums = self.own.ball(r, density);
        match self.treatment {
            Treatment::None => Ok((sums[F0], 1.0)),
            Treatment::Clipped => Ok((sums[F0] / sums[U0], 1.0)),
            Treatment::Reflection => {
                let images: f64 = self.images.iter().map(|image| image.ball(r, density)[F0]).sum();
                Ok((sums[F0] + images, 1.0))
            }
            Treatment::LocalLinear => {
                let (determinant, spread) = determinant(&sums);
                Ok(((sums[U2] * sums[F0] - sums[U1] * sums[F1]) / determinant, spread))
            }
        }
    }
}

/// M_0 M_2 - M_1^2, and how many times it is smaller than its terms. The probe is a place of the body, so that z has 0 at
/// an end of its range or inside: its variance is a fair part of its mean square, however thin the body.
pub(super) fn determinant(sums: &Sums) -> (f64, f64) {
    let product = sums[U0] * sums[U2];
    let value = product - sums[U1] * sums[U1];
    (value, product / value)
}

/// A kernel that ends at its radius.
pub(super) fn check_kernel(kernel: Kernel) -> Result<Kernel> {
    if kernel == Kernel::Gaussian {
        return Err(Error::Infinite("the Gaussian does not end; allowed: kernels that end at the radius"));
    }
    kernel.check()
}

pub(super) fn mean(
    treatment: Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
    field: Field,
) -> Result<Value> {
    check_kernel(kernel)?;
    length("radius", radius)?;
    let place = body.place(at, radius)?;
    if exact(treatment, body, radius, &field) {
        return Ok(Value::new(1.0, 0.0, "exact"));
    }
    let asked = CheckedField::new(field, true);
    settle(METHOD, |rule| {
        let gather = Gather::new(rule, treatment, kernel, &place, radius, &asked);
        asked.verdict()?;
        gather.mean(radius)
    })
}

/// Whether the treatment gives a uniform field back whatever the radius up to this one: images then fill the ball.
pub(super) fn exact(treatment: Treatment, body: Body, radius: f64, field: &Field) -> bool {
    let filled = treatment == Treatment::Reflection && radius <= body.completed_up_to();
    matches!(field, Field::Uniform)
        && (filled || matches!(treatment, Treatment::Clipped | Treatment::LocalLinear))
}

/// Moment M_j = int_O K_r(y - x) z^j dy of a kernel cut by a body, z = (y - x).n/r along the inward normal n of the
/// nearest boundary point.
///
/// Flat face at x = h/r, uniform kernel: M_0 = 1/2 + 3x/4 - x^3/4, M_1 = (3/16)(1 - x^2)^2.
/// # Arguments
/// `at` a place of the body \[length\]; of faces equally near the first counts, low before high, x before y before z;
/// at the centre of a sphere n = -z; `radius` \[length\], 1e-12 to 1e12; `j` 0 to 2
/// # Returns
/// \[1\]
/// # Errors
/// `Error::OutOfRange` naming the parameter; `Error::Infinite` for the kernel without end
/// # Limits
/// a whole ball: 1, 0, m_2/3
pub fn body_moment(kernel: Kernel, body: Body, at: [f64; 3], radius: f64, j: u32) -> Result<Value> {
    check_kernel(kernel)?;
    length("radius", radius)?;
    within("j", f64::from(j), 0.0, 2.0, "0 to 2")?;
    let place = body.place(at, radius)?;
    let asked = CheckedField::new(Field::Uniform, true);
    let value = settle(METHOD, |rule| {
        let profile = Profile::new(rule, &place.own, radius, &asked);
        let sums = profile.ball(radius, |u| kernel.density(Dimension::Three, u) / (radius * radius * radius));
        Ok((sums[U0 + j as usize], 1.0))
    })?;
    // M_1 of an almost whole ball is a small difference of halves.
    Ok(Value::new(value.value, value.error + 64.0 * f64::EPSILON, value.method))
}

/// Expectation of the fixed-radius estimate of a field with a treatment.
///
/// int_O W f with W the treatment's weight: K_r; K_r/M_0; K_r plus the kernels about the probe's own mirror images;
/// K_r (M_2 - M_1 z)/(M_0 M_2 - M_1^2).
/// # Arguments
/// `at` as in [`body_moment`]; `radius` \[length\], 1e-12 to 1e12; `field` of the place inside the body, smooth there;
/// at the faces it may behave like c + t ln t; it is not asked outside
/// # Returns
/// \[unit of the field\]; the bound covers the integration, not errors of the field's own
/// # Errors
/// `Error::OutOfRange` naming the parameter; `Error::NotFinite` if the field is not, with the distance from the probe
/// (or image) at which; `Error::Infinite` for the kernel without end
/// # Limits
/// radius up to the probe's depth: the plain estimate, whatever the treatment; a uniform field: `None` M_0 of it,
/// `Clipped` and `LocalLinear` itself, `Reflection` itself behind flat faces up to the shortest edge; f + s z on a flat
/// face: f + s r m, m = M_1/M_0 (uniform kernel 3/8) with `Clipped` and `Reflection`, 0 with `LocalLinear`
pub fn treated_mean(
    treatment: Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
    field: impl Fn([f64; 3]) -> f64,
) -> Result<Value> {
    mean(treatment, kernel, body, at, radius, Field::Any(&field))
}

/// [`treated_mean`] of a field of one number, much faster: of the depth z in a half-space or slab, of the distance from
/// the centre in a sphere.
///
/// # Arguments
/// as there
/// # Errors
/// as there, and `Error::Infinite` for a cuboid, which has no such field
pub fn treated_mean_symmetric(
    treatment: Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
    field: impl Fn(f64) -> f64,
) -> Result<Value> {
    check_symmetric(body)?;
    mean(treatment, kernel, body, at, radius, Field::Symmetric(&field))
}

/// [`treated_mean`] of the field 1.
///
/// In the furnace, albedo 1 and isotropic incidence from all sides, the fluence is 4 times the irradiance at every
/// place, for any phase function: there these numbers are the whole error, geometry alone.
/// # Arguments
/// as there
/// # Errors
/// as there
pub fn treated_mean_uniform(
    treatment: Treatment,
    kernel: Kernel,
    body: Body,
    at: [f64; 3],
    radius: f64,
) -> Result<Value> {
    mean(treatment, kernel, body, at, radius, Field::Uniform)
}

pub(super) fn check_symmetric(body: Body) -> Result<()> {
    if let Body::Cuboid { .. } = body {
        return Err(Error::Infinite(
            "a cuboid has no field of one number; allowed: half-space, slab, sphere",
        ));
    }
    Ok(())
}
