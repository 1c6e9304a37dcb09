//! Walks in unbounded fog: where photons are, and whither they fly, after n events.

use crate::error::{Result, within};
use crate::value::Value;
use libm::pow;

/// Mean cosine between the first direction and that after n scatterings \[1\]: g^n.
///
/// # Arguments
/// `g` mean cosine of one scattering, -1 to 1
/// # Errors
/// `Error::OutOfRange` naming `g`
pub fn mean_cosine(g: f64, n: u32) -> Result<Value> {
    within("g", g, -1.0, 1.0, "-1 to 1")?;
    Ok(Value::rounded(pow(g, f64::from(n)), 4.0, "closed form"))
}

/// Mean square distance from the start after n free flights with a scattering between each two \[mfp^2\].
///
/// 2n + 2 sum_(m<n) (n-m) g^m = 2n/(1-g) - 2g(1-g^n)/(1-g)^2.
/// # Arguments
/// `g` mean cosine of one scattering, -1 to 1; `n` flights, 0 to 1000000
/// # Errors
/// `Error::OutOfRange` naming `g` or `n`
/// # Limits
/// g = 0: 2n; g = 1: n(n+1), one long flight of n steps
pub fn mean_square_displacement(g: f64, n: u32) -> Result<Value> {
    within("g", g, -1.0, 1.0, "-1 to 1")?;
    within("n", f64::from(n), 0.0, 1e6, "0 to 1000000")?;
    let (flights, gap) = (f64::from(n), 1.0 - g);
    if flights * gap > 1.0 {
        // The second term is at most (1 - 1/e) of the first.
        let value = 2.0 * flights / gap - 2.0 * g * (1.0 - pow(g, flights)) / (gap * gap);
        return Ok(Value::rounded(value, 32.0, "closed form"));
    }
    // Here g is near 1, or n is 0, and all terms are positive.
    let (mut sum, mut power) = (flights, 1.0);
    for m in 1..n {
        power *= g;
        sum += f64::from(n - m) * power;
    }
    Ok(Value::rounded(2.0 * sum, 4.0 + 2.0 * flights, "sum"))
}
