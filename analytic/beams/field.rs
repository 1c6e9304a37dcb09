//! A kernel over any field: the mean of an estimate where no closed form is.

use crate::error::{Error, Result, within};
use crate::kernel::{Dimension, Kernel};
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{cos, sin};
use std::f64::consts::PI;

/// Nodes on the radius, and half as many as directions in each angle.
const RULES: [u32; 2] = [32, 24];

/// Mean of an estimate with any kernel in any field: int K(u) f(r u) du over the kernel's ball, disc or interval.
///
/// # Arguments
/// `radius` \[length\]; `field` at the offset from the probe \[length\], of which the first d components differ from zero:
/// it should be smooth in the ball
/// # Returns
/// \[unit of the field\]; the bound is the difference of two product rules, of 32 and of 24 nodes a coordinate, large for a
/// field with edges
/// # Errors
/// `Error::OutOfRange` naming `radius` or `kappa`; `Error::NotFinite` naming `field`
pub fn blurred_field(
    kernel: Kernel,
    d: Dimension,
    radius: f64,
    field: impl Fn([f64; 3]) -> f64,
) -> Result<Value> {
    kernel.check()?;
    within("radius", radius, 1e-60, 1e60, "1e-60 to 1e60")?;
    let mut bad = None;
    let mut ask = |offset: [f64; 3]| {
        let value = field(offset);
        if !value.is_finite() && bad.is_none() {
            bad = Some((value, offset[0]));
        }
        value
    };
    let [fine, coarse] = RULES.map(|n| product(kernel, d, radius, n, &mut ask));
    if let Some((value, at)) = bad {
        return Err(Error::NotFinite { name: "field", value, at });
    }
    let difference = (fine.0 - coarse.0).abs();
    let error = difference + 64.0 * f64::EPSILON * fine.1 + f64::MIN_POSITIVE;
    Ok(Value::new(fine.0, error, "product of Gauss rules, two orders"))
}

/// The mean of the field, and of its magnitude.
fn product(
    kernel: Kernel,
    d: Dimension,
    radius: f64,
    n: u32,
    field: &mut impl FnMut([f64; 3]) -> f64,
) -> (f64, f64) {
    let rule = GaussLegendre::rule(n as usize);
    let directions = directions(d, n);
    let (mut sum, mut magnitude) = (0.0, 0.0);
    for (x, w) in rule.nodes.iter().zip(&rule.weights) {
        let u = kernel.reach() * x;
        let shell = kernel.reach() * w * kernel.density(d, u) * d.sphere_area() * d.power(u) / u;
        for (e, share) in &directions {
            let value = field(e.map(|c| c * u * radius));
            sum += shell * share * value;
            magnitude += shell * share * value.abs();
        }
    }
    (sum, magnitude)
}

/// Unit vectors and their shares of the sphere.
fn directions(d: Dimension, n: u32) -> Vec<([f64; 3], f64)> {
    let circle = |i: u32| {
        // Half a step off, so that no symmetric field meets its axis.
        let psi = 2.0 * PI * (f64::from(i) + 0.5) / f64::from(n);
        (cos(psi), sin(psi), 1.0 / f64::from(n))
    };
    match d {
        Dimension::One => vec![([1.0, 0.0, 0.0], 0.5), ([-1.0, 0.0, 0.0], 0.5)],
        Dimension::Two => (0..n).map(circle).map(|(c, s, share)| ([c, s, 0.0], share)).collect(),
        Dimension::Three => {
            let rule = GaussLegendre::rule(n as usize / 2);
            let mut all = Vec::new();
            for (x, w) in rule.nodes.iter().zip(&rule.weights) {
                let z = 2.0 * x - 1.0;
                let rho = ((1.0 - z) * (1.0 + z)).sqrt();
                all.extend((0..n).map(circle).map(|(c, s, share)| ([rho * c, rho * s, z], w * share)));
            }
            all
        }
    }
}
