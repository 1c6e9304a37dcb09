//! First flights in a sphere, in closed form: escape, collision, the absorbing sphere, and the kernel of the shells.

use crate::error::{Result, within};
use crate::exponential_integral::e_n;
use crate::peierls::fast;
use crate::quadrature::GaussLegendre;
use crate::value::Value;
use libm::{exp, expm1, log, log1p};
use std::sync::LazyLock;

const METHOD: &str = "closed form";

/// Roundings of the closed forms: four of E_n at up to 16 each, partly added.
const ULPS: f64 = 40.0;

/// Terms of the series in distances up to 1: the next is 1/20! = 4e-19.
const TERMS: usize = 19;

/// Gauss nodes for smooth means over a range whose ends differ by a factor of three or less.
const NODES: usize = 20;
static MEAN: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::rule(NODES));

/// Probability that light emitted isotropically at distance r from the centre leaves without a collision \[1\].
///
/// P(r) = \[a (E_2(a-r) - E_2(a+r)) + E_3(a-r) - E_3(a+r)\]/(2 r).
/// # Arguments
/// `radius` of the sphere in mean free paths, 0 to 1e9; `r` distance from the centre, 0 to `radius`
/// # Errors
/// `Error::OutOfRange` naming `radius` or `r`
/// # Limits
/// r = 0: e^(-a); r = a: \[1 + (1 - e^(-2a))/(2a)\]/4 + ...
/// # Source
/// Case, de Hoffmann and Placzek 1953, section 10
pub fn escape_from(radius: f64, r: f64) -> Result<Value> {
    within("radius", radius, 0.0, 1e9, "0 to 1e9")?;
    within("r", r, 0.0, radius, "0 to radius")?;
    if radius == 0.0 {
        return Ok(Value::new(1.0, 0.0, METHOD));
    }
    let value = first_flight(radius, r, radius - r).0;
    // A distance a - r that is rounded moves the exponential.
    let value = Value::rounded(value, ULPS + radius.min(750.0), METHOD);
    Ok(value)
}

/// Probability that light from a uniform isotropic source leaves without a collision \[1\].
///
/// P_0 = 3 \[2 a^2 - 1 + (1 + 2a) e^(-2a)\]/(8 a^3).
/// # Arguments
/// `radius` in mean free paths, 0 to 1e9
/// # Errors
/// `Error::OutOfRange` naming `radius`
/// # Limits
/// 1 - 3a/4 + 2a^2/5 - ...; 3/(4a) for large a
pub fn escape_uniform(radius: f64) -> Result<Value> {
    within("radius", radius, 0.0, 1e9, "0 to 1e9")?;
    Ok(Value::rounded(mean_escape(radius).0, ULPS, METHOD))
}

/// Fraction of light that crosses an absorbing sphere, incident isotropically or as a beam over its whole disc \[1\].
///
/// T = \[1 - (1 + 2a) e^(-2a)\]/(2 a^2), the mean of e^(-chord).
/// # Arguments
/// `radius` in mean free paths, 0 to 1e9
/// # Errors
/// `Error::OutOfRange` naming `radius`
/// # Limits
/// 1 - 4a/3 + a^2 - ...; 1/(2 a^2) for large a
pub fn absorbing_transmittance(radius: f64) -> Result<Value> {
    within("radius", radius, 0.0, 1e9, "0 to 1e9")?;
    Ok(Value::rounded(transmittance_and_loss(radius).0, ULPS, METHOD))
}

/// T of the absorbing sphere and 1 - T, neither by cancellation.
pub(super) fn transmittance_and_loss(a: f64) -> (f64, f64) {
    let y = 2.0 * a;
    if y > 1.0 {
        let t = 2.0 * (1.0 - (1.0 + y) * exp(-y)) / (y * y);
        return (t, 1.0 - t);
    }
    // 1 - T = -2 sum_(n>=1) (-y)^n/(n! (n+2)): the integral of 1 - e^(-L) over chords of density 2L/y^2.
    let (mut term, mut loss, mut n) = (1.0, 0.0, 0.0);
    while n < 20.0 {
        n += 1.0;
        term *= -y / n;
        loss -= 2.0 * term / (n + 2.0);
    }
    (1.0 - loss, loss)
}

/// P_0 and 1 - P_0, neither by cancellation.
pub(super) fn mean_escape(a: f64) -> (f64, f64) {
    if a > 0.5 {
        let p = 0.75 / a * transmittance_and_loss(a).1;
        return (p, 1.0 - p);
    }
    // 1 - T = sum c_n y^n, c_1 = 2/3, and P_0 = 3/(2y) (1 - T), divided term by term.
    let y = 2.0 * a;
    let (mut term, mut loss, mut n) = (-1.0, 0.0, 1.0);
    while n < 20.0 {
        n += 1.0;
        term *= -y / n;
        loss += 3.0 * term / (n + 2.0);
    }
    (1.0 - loss, loss)
}

/// Escape probability P and collision probability 1 - P from r in a sphere of radius a, with depth = a - r.
///
/// P(r) is the mean of e^(-l) over the distances l to the surface, of density (1 + (a^2-r^2)/l^2)/(4r) on
/// \[a-r, a+r\].
pub(super) fn first_flight(a: f64, r: f64, depth: f64) -> (f64, f64) {
    let (z, s) = (depth, a + r);
    if a <= 0.5 {
        // 1 - P = sum (-1)^(n+1) <l^n>/n!, the moments from (s^m - z^m)/(s - z) = sum s^i z^(m-1-i).
        let ratio = 2.0 * r / z;
        let logarithm = if z == 0.0 {
            0.0
        } else if ratio < 1e-17 {
            s
        } else {
            z * s * log1p(ratio) / (2.0 * r)
        };
        let mut moments = [0.0; TERMS + 2];
        let mut power = 1.0;
        for m in 1..moments.len() {
            moments[m] = s * moments[m - 1] + power;
            power *= z;
        }
        let (mut factor, mut q) = (-1.0, 0.0);
        for n in 1..=TERMS {
            let n_f = n as f64;
            factor /= -n_f;
            let inverse = if n == 1 { logarithm } else { z * s * moments[n - 1] / (n_f - 1.0) };
            q += factor * 0.5 * (moments[n + 1] / (n_f + 1.0) + inverse);
        }
        return (1.0 - q, q);
    }
    let p = if r < 0.5 * a && r < 2.0 {
        // Nearly equal distances: the mean itself. The pole at l = 0 is 3.7 half-widths of convergence away.
        let mut sum = 0.0;
        for (x, w) in MEAN.nodes.iter().zip(&MEAN.weights) {
            let l = z + 2.0 * r * x;
            sum += w * exp(-l) * (1.0 + z * s / (l * l));
        }
        0.5 * sum
    } else {
        // The last two terms: E_2(z) >= E_2(s) and s >= 1.5 z, or e^(-s) < e^(-z-4).
        (-exp(-z) * expm1(-2.0 * r) + s * e_n(2, z) - z * e_n(2, s)) / (4.0 * r)
    };
    (p, 1.0 - p)
}

/// (r'/r) \[E_1(|r-r'|) - E_1(r+r')\], with `gap` = |r-r'| > 0: twice the fluence at r, times r^2, of a shell at r' of
/// unit source density.
pub(super) fn shells(r: f64, source: f64, gap: f64) -> f64 {
    let (low, high) = (r.min(source), r.max(source));
    if low < 0.25 * high && low < 0.5 {
        // E_1(h-l) - E_1(h+l) = (l/h) e^(-h) int_(-1)^1 e^(-l v)/(1 + (l/h) v) dv.
        let ratio = low / high;
        let mut sum = 0.0;
        for &(v, w) in PAIRS.iter() {
            let e = exp(low * v);
            sum += w * (e / (1.0 - ratio * v) + 1.0 / (e * (1.0 + ratio * v)));
        }
        let scale = if source >= r { 1.0 } else { ratio * ratio };
        return scale * exp(-high) * sum;
    }
    let sum = r + source;
    let difference = if sum <= 1.0 {
        log(sum / gap) - (fast::ein(sum) - fast::ein(gap))
    } else {
        fast::e1(gap) - fast::e1(sum)
    };
    difference * (source / r)
}

/// The positive half of the ten-point rule on \[-1, 1\]: the pole at v = 4 leaves 7.9^-20.
static PAIRS: LazyLock<[(f64, f64); 5]> = LazyLock::new(|| {
    let rule = GaussLegendre::rule(10);
    std::array::from_fn(|i| (2.0 * rule.nodes[5 + i] - 1.0, 2.0 * rule.weights[5 + i]))
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exponential_integral::e1;

    #[test]
    fn escape_is_the_mean_over_directions() {
        // P = (1/2) int_(-1)^1 exp(-l(mu)) dmu, l = -r mu + sqrt(a^2 - r^2 (1 - mu^2)).
        let rule = GaussLegendre::rule(300);
        for a in [1e-6, 0.01, 0.3, 0.49, 0.51, 1.0, 2.0, 7.0, 30.0] {
            for part in [0.0, 1e-12, 1e-3, 0.1, 0.3, 0.499, 0.501, 0.8, 0.97] {
                let r = part * a;
                let direct = |f: &dyn Fn(f64) -> f64| {
                    rule.integrate(0.0, 1.0, |x| {
                        let mu = 2.0 * x - 1.0;
                        f(-r * mu + (a * a - r * r * (1.0 - mu * mu)).sqrt())
                    })
                };
                let (p, q) = first_flight(a, r, a - r);
                let (want_p, want_q) = (direct(&|l| exp(-l)), direct(&|l| -expm1(-l)));
                // The distance loses a few roundings of a, which e^(-l) feels.
                let tolerance = 2e-14 * (1.0 + a);
                assert!((p / want_p - 1.0).abs() < tolerance, "{a} {part}: {p} {want_p}");
                assert!((q / want_q - 1.0).abs() < tolerance, "{a} {part}: {q} {want_q}");
            }
        }
    }

    #[test]
    fn the_mean_of_the_escape_from_each_radius_is_the_uniform_one() {
        let rule = GaussLegendre::rule(60);
        for a in [1e-8, 1e-3, 0.2, 0.5, 0.500_001, 3.0, 20.0] {
            // a - r = a x^4: P has a (a-r) ln (a-r) at the surface.
            let mean = |pick: &dyn Fn((f64, f64)) -> f64| {
                rule.integrate(0.0, 1.0, |x| {
                    let depth = a * x * x * x * x;
                    let r = a - depth;
                    12.0 * (r / a) * (r / a) * x * x * x * pick(first_flight(a, r, depth))
                })
            };
            let (p, q) = mean_escape(a);
            assert!((mean(&|f| f.0) / p - 1.0).abs() < 1e-12, "{a}");
            assert!((mean(&|f| f.1) / q - 1.0).abs() < 1e-12, "{a}");
            let (t, loss) = transmittance_and_loss(a);
            assert!((loss / (4.0 * a / 3.0 * p) - 1.0).abs() < 1e-14 && (t + loss - 1.0).abs() < 1e-15);
        }
        let a = 0.01;
        let series = 1.0 - 0.75 * a + 0.4 * a * a - a * a * a / 6.0 + 2.0 * a * a * a * a / 35.0;
        assert!((escape_uniform(a).unwrap().value - series).abs() < 1e-11);
    }

    #[test]
    fn the_shell_kernel_is_continuous_over_its_forms() {
        for (r, source) in [(0.3_f64, 0.4), (0.1, 0.5), (0.6, 2.0), (3.0, 1.0), (0.45, 0.55), (1e-3, 3e-3)] {
            let want = (e1((r - source).abs()) - e1(r + source)) * source / r;
            assert!((shells(r, source, (r - source).abs()) / want - 1.0).abs() < 1e-13, "{r} {source}");
        }
        // Either side of l/h = 1/4, of l = 1/2 and of a sum of 1, differences by the step alone.
        for (r, source) in [(0.1, 0.4), (1e-9, 4e-9), (0.5, 2.5), (0.4, 0.6), (0.2, 0.8)] {
            let f = |s: f64| shells(r, s, s - r);
            assert!((f(source * (1.0 - 1e-13)) / f(source * (1.0 + 1e-13)) - 1.0).abs() < 1e-11);
            let f = |s: f64| shells(s, r, s - r);
            assert!((f(source * (1.0 - 1e-13)) / f(source * (1.0 + 1e-13)) - 1.0).abs() < 1e-11);
        }
        assert!((shells(0.0, 0.7, 0.7) / (2.0 * exp(-0.7)) - 1.0).abs() < 1e-14);
    }
}
