//! A kernel in a slab: what it makes of a field of depth only, and what it loses beyond the faces.
//!
//! A field of depth alone meets the kernel's marginal k(z) = int K dx dy: the plain estimate at depth h expects
//! int_0^tau f(t) k((t-h)/r) dt/r. Its error is split by definition: edge, f(h) (M_0 - 1), M_0 the kernel's mass inside
//! the slab, and blur, the rest.
//!
//! Limits: no face within the radius, M_0 = 1 and blur alone; on the face of a thick slab, M_0 = 1/2.
//!
//! Source: Silverman 1986, section 2.10; Jones 1993 for moments of kernels that a boundary cuts.

use crate::error::{Error, Result, within};
use crate::incidence::check_depth;
use crate::kernel::{Kernel, normal_cdf};
use crate::quadrature::{Adaptive, GAUSS_24};
use crate::value::Value;

/// Where a probe and its kernel stand.
fn check(kernel: Kernel, radius: f64, depth: f64, thickness: f64) -> Result<()> {
    kernel.check()?;
    within("radius", radius, 1e-12, 1e12, "1e-12 to 1e12")?;
    within("thickness", thickness, 1e-12, 1e12, "1e-12 to 1e12")?;
    check_depth(depth, thickness).map(|_| ())
}

/// Moment M_j = int K z^j of the three-dimensional kernel cut at a flat face, z the inward coordinate over the radius.
///
/// # Arguments
/// `j` 0 to 4; `depth` of the centre behind the face, over the radius, any finite number
/// # Returns
/// \[1\]; the uniform kernel: M_0 = 1/2 + 3x/4 - x^3/4, M_1 = (3/16)(1-x^2)^2
/// # Errors
/// `Error::OutOfRange` naming `j`, `depth` or `kappa`
pub fn face_moment(kernel: Kernel, j: u32, depth: f64) -> Result<Value> {
    kernel.check()?;
    within("j", f64::from(j), 0.0, 4.0, "0 to 4")?;
    within("depth", depth, f64::MIN, f64::MAX, "finite numbers")?;
    Ok(moment_between(kernel, j, -depth, f64::INFINITY))
}

/// Moment M_j of the three-dimensional kernel cut at both faces of a slab, z downwards over the radius.
///
/// # Arguments
/// `j` 0 to 4; `radius`, `depth` and `thickness` in one unit of length
/// # Errors
/// `Error::OutOfRange` naming the parameter
pub fn slab_moment(kernel: Kernel, j: u32, radius: f64, depth: f64, thickness: f64) -> Result<Value> {
    check(kernel, radius, depth, thickness)?;
    within("j", f64::from(j), 0.0, 4.0, "0 to 4")?;
    Ok(moment_between(kernel, j, -depth / radius, (thickness - depth) / radius))
}

/// int z^j marginal(z) dz: a polynomial on each side of 0, or the Gaussians, smooth on unit panels.
fn moment_between(kernel: Kernel, j: u32, low: f64, high: f64) -> Value {
    let reach = kernel.reach();
    let (low, high) = (low.clamp(-reach, reach), high.clamp(-reach, reach));
    let rule = &GAUSS_24;
    let power = |z: f64| (0..j).fold(1.0, |p, _| p * z);
    let (mut value, mut absolute) = (0.0, 0.0);
    let mut from = -10.0;
    while from < 10.0 {
        let (a, b) = (low.max(from), high.min(from + 1.0));
        if a < b {
            value += rule.integrate(a, b, |z| power(z) * kernel.plane_density(z));
            absolute += rule.integrate(a, b, |z| power(z).abs() * kernel.plane_density(z));
        }
        from += 1.0;
    }
    // A Gaussian is cut where e^(-42) of it is left; the faces differ by a rounding.
    let error = f64::EPSILON * (32.0 * absolute + 4.0) + if kernel == Kernel::Gaussian { 1e-17 } else { 0.0 };
    Value::new(value, error, "Gauss rule, exact for the polynomials")
}

/// Mass of the kernel beyond the faces, 1 - M_0, with its small digits kept.
fn lost_mass(kernel: Kernel, radius: f64, depth: f64, thickness: f64) -> Value {
    let (up, down) = (depth / radius, (thickness - depth) / radius);
    if kernel == Kernel::Gaussian {
        return Value::rounded(normal_cdf(-up) + normal_cdf(-down), 8.0 + up * up.min(40.0), "closed form");
    }
    let (a, b) = (moment_between(kernel, 0, up, 1.0), moment_between(kernel, 0, down, 1.0));
    Value::new(a.value + b.value, a.error + b.error, a.method)
}

/// int_O K_r(y - x) f dy over the slab O, the field depending on depth only; nothing makes up for the lost mass.
///
/// # Arguments
/// `radius`, `depth` (0 to thickness), `thickness` in one unit of length; `field` of the depth in that
/// unit, smooth inside the slab; at the faces it may behave like c + t ln t
/// # Returns
/// \[unit of the field\]; the bound covers the integration, not errors of the field's own;
/// the Gaussian is cut at 9.2 standard deviations, where 4e-20 of it is left
/// # Errors
/// `Error::OutOfRange` naming the parameter, `Error::NotFinite` if the field is not
/// # Limits
/// a field of 1 gives M_0; far from the faces the field e^(bt) gives e^(bt) times its exponential mean
pub fn slab_kernel_mean(
    kernel: Kernel,
    radius: f64,
    depth: f64,
    thickness: f64,
    field: impl Fn(f64) -> f64,
) -> Result<Value> {
    check(kernel, radius, depth, thickness)?;
    let breaks = breaks(kernel, radius, depth, thickness);
    Adaptive::new(1e-14).integrate(&breaks, "field", "adaptive Gauss, two rules", |t| {
        Ok(kernel.plane_density((t - depth) / radius) / radius * field(t))
    })
}

/// Panels: no longer than half a radius or than twice their distance from a face, with an edge at the probe.
fn breaks(kernel: Kernel, radius: f64, depth: f64, thickness: f64) -> Vec<f64> {
    let half_width = kernel.reach() * radius;
    let (low, high) = ((depth - half_width).max(0.0), (depth + half_width).min(thickness));
    let mut breaks = vec![low, depth, high];
    let pieces = 4.0 * kernel.reach();
    let mut i = 1.0;
    while i < pieces {
        breaks.push(low + (high - low) * i / pieces);
        i += 1.0;
    }
    // Thirds towards each face, down to where t ln t leaves 1e-16 of the panel's share.
    let mut distance = 0.5 * thickness.min(1.0);
    for _ in 0..20 {
        for t in [distance, thickness - distance] {
            if t > low && t < high {
                breaks.push(t);
            }
        }
        distance /= 3.0;
    }
    breaks.sort_by(f64::total_cmp);
    breaks
}

/// The error of the plain estimate, split by definition: edge = f(x)(M_0 - 1), blur = the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeLoss {
    /// The estimate's expectation, int_O K_r f.
    pub mean: Value,
    /// f(x)(M_0 - 1): what the missing part of the kernel takes.
    pub edge: Value,
    /// int_O K_r (f - f(x)): what curvature and slope add.
    pub blur: Value,
}

/// Splits the error of the plain estimate in a slab into its edge part and its blur part.
///
/// # Arguments
/// as [`slab_kernel_mean`]
/// # Errors
/// as [`slab_kernel_mean`]
pub fn edge_loss(
    kernel: Kernel,
    radius: f64,
    depth: f64,
    thickness: f64,
    field: impl Fn(f64) -> f64,
) -> Result<EdgeLoss> {
    let mean = slab_kernel_mean(kernel, radius, depth, thickness, &field)?;
    let here = field(depth);
    if !here.is_finite() {
        return Err(Error::NotFinite { name: "field", value: here, at: depth });
    }
    let edge = lost_mass(kernel, radius, depth, thickness).scaled(-here);
    let blur = slab_kernel_mean(kernel, radius, depth, thickness, |t| field(t) - here)?;
    Ok(EdgeLoss { mean, edge, blur })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ball_mean::exponential_mean;
    use crate::kernel::Dimension;
    use crate::{Incidence, IsotropicSlab};
    use libm::{exp, log};

    #[test]
    fn face_moments_have_their_closed_forms() {
        for x in [-0.7, 0.0, 0.25, 0.9, 2.0] {
            let c: f64 = f64::clamp(x, -1.0, 1.0);
            let v = 1.0 - c * c;
            let m = |kernel, j| face_moment(kernel, j, x).unwrap();
            assert!(m(Kernel::Uniform, 0).covers(0.5 + 0.75 * c - 0.25 * c * c * c));
            assert!(m(Kernel::Uniform, 1).covers(3.0 / 16.0 * v * v));
            // c (1-x^2)^(n+2)/(2(n+2)) for the (1-u^2)^n family.
            assert!(m(Kernel::Epanechnikov, 1).covers(15.0 / 16.0 * v * v * v / 6.0));
            assert!(m(Kernel::Biweight, 1).covers(35.0 / 32.0 * v * v * v * v / 8.0));
        }
        for kernel in Kernel::SAMPLES {
            // On the face: half the mass, and M_2 = m_2/(2d).
            assert!(face_moment(kernel, 0, 0.0).unwrap().covers(0.5), "{kernel:?}");
            let second = kernel.bias_coefficient(Dimension::Three).unwrap().value;
            assert!((face_moment(kernel, 2, 0.0).unwrap().value - second).abs() < 1e-15, "{kernel:?}");
        }
    }

    #[test]
    fn constants_give_the_mass_and_exponentials_their_mean() {
        for kernel in Kernel::SAMPLES {
            for (r, x, tau) in [(0.3, 0.1, 0.35), (0.3, 0.0, 5.0), (2.0, 0.5, 1.0)] {
                let mass = slab_moment(kernel, 0, r, x, tau).unwrap();
                let got = slab_kernel_mean(kernel, r, x, tau, |_| 1.0).unwrap();
                assert!(
                    (got.value - mass.value).abs() <= got.error + mass.error,
                    "{kernel:?} {got:?} {mass:?}"
                );
                let lost = lost_mass(kernel, r, x, tau);
                assert!(
                    (lost.value + mass.value - 1.0).abs() <= lost.error + mass.error + 1e-16,
                    "{kernel:?}"
                );
            }
            let (b, r, x) = (-1.5, 0.4, 50.0);
            let got = slab_kernel_mean(kernel, r, x, 100.0, |t| exp(b * (t - x))).unwrap();
            let want = exponential_mean(kernel, Dimension::Three, b * r).unwrap();
            assert!((got.value - want.value).abs() <= got.error + want.error, "{kernel:?} {got:?} {want:?}");
            assert!(got.error < 1e-13 * got.value);
        }
    }

    #[test]
    fn a_logarithm_at_the_face_keeps_ten_digits() {
        // Uniform kernel on the face, f = t ln t: (3/4r) int_0^r (1 - t^2/r^2) t ln t dt = (3/16) r (ln r - 3/4).
        for r in [1e-3, 0.2, 1.0, 5.0] {
            let got = slab_kernel_mean(Kernel::Uniform, r, 0.0, 10.0, |t| t * log(t)).unwrap();
            let want = 3.0 / 16.0 * r * (log(r) - 0.75);
            assert!((got.value - want).abs() <= got.error.max(1e-16), "{r} {got:?} {want}");
            assert!(got.error < 1e-11 * want.abs().max(r), "{r} {got:?}");
        }
    }

    #[test]
    fn known_answers_of_the_plain_estimate_in_a_slab() {
        let slab = IsotropicSlab::new(2.0, 0.9, Incidence::Beam { mu0: 1.0 }).unwrap();
        let phi = |t: f64| slab.fluence_interpolated(t).unwrap().value;
        for (r, h, percent) in
            [(0.2, 0.0, -47.12), (0.2, 0.1, -15.89), (0.05, 0.0, -48.72), (0.4, 0.4, -1.43)]
        {
            let split = edge_loss(Kernel::Uniform, r, h, 2.0, phi).unwrap();
            let off = 100.0 * (split.mean.value / phi(h) - 1.0);
            // Given to two decimals, not all of them rounded to nearest.
            assert!((off - percent).abs() < 0.01, "{r} {h}: {off} {percent}");
            let sum = phi(h) + split.edge.value + split.blur.value;
            let bound = split.mean.error + split.edge.error + split.blur.error + 1e-15;
            assert!((sum - split.mean.value).abs() <= bound, "{split:?}");
            assert!(split.mean.error < 1e-10);
        }
    }

    #[test]
    fn refusals() {
        let one = |_: f64| 1.0;
        assert!(slab_kernel_mean(Kernel::Uniform, 0.0, 0.5, 1.0, one).is_err());
        assert!(slab_kernel_mean(Kernel::Uniform, 0.1, 1.5, 1.0, one).is_err());
        let error = slab_kernel_mean(Kernel::Uniform, 0.1, 0.5, 1.0, |_| f64::NAN).err().unwrap();
        assert!(error.to_string().starts_with("field returned NaN at"), "{error}");
        assert!(slab_kernel_mean(Kernel::Cone { kappa: 0.0 }, 0.1, 0.5, 1.0, one).is_err());
    }
}
