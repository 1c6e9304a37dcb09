//! The k nearest photons where the medium ends.
//!
//! r_k is the distance of the k-th photon, real ones only; the k - 1 nearer ones are summed with the treatment's weight
//! at that radius, images within r_k and moments at r_k. Given r_k they are independent with the field's density in the
//! cut ball, so that with lambda(r) = density int_(B_r in O) f, Lambda = lambda(cap), p_n(s) = e^(-s) s^n/n!
//! and m(r) the fixed-radius expectation,
//!
//! E = int_0^cap p_(k-2)(lambda(r)) lambda'(r) m(r) dr + m(cap) P(at most k - 2 | Lambda),
//!
//! the last term from gathers with fewer than k photons, which use the cap and all of them.

use super::body::{Body, length};
use super::rule::{Rule, pieces, settle};
use super::shell::{CheckedField, F0, Field};
use super::treated::{Gather, METHOD, Treatment, check_kernel, check_symmetric, exact};
use crate::error::{Result, within};
use crate::kernel::Kernel;
use crate::poisson::{at_most, probability};
use crate::value::Value;

/// How many photons are expected within a radius, and what the estimate expects there.
pub(super) trait Counts {
    /// int f over the ball of radius r.
    fn held(&self, r: f64) -> f64;
    /// Its derivative.
    fn shell(&self, r: f64) -> f64;
    /// Expectation at radius r, and how much larger its terms are.
    fn mean(&self, r: f64) -> Result<(f64, f64)>;
}

impl Counts for Gather<'_> {
    fn held(&self, r: f64) -> f64 {
        self.own.held(r)
    }

    fn shell(&self, r: f64) -> f64 {
        self.own.shell(r)[F0]
    }

    fn mean(&self, r: f64) -> Result<(f64, f64)> {
        Gather::mean(self, r)
    }
}

pub(super) fn check_gather(k: u32, cap: f64, density: f64) -> Result<()> {
    within("k", f64::from(k), 2.0, 1e6, "2 to 1e6")?;
    length("cap", cap)?;
    within("density", density, 1e-50, 1e50, "1e-50 to 1e50")?;
    Ok(())
}

/// The mixture over the k-th distance; `ends` are the radii between which counts and means are smooth.
pub(super) fn mixture(
    rule: &Rule,
    k: u32,
    cap: f64,
    density: f64,
    mut ends: Vec<f64>,
    counts: &impl Counts,
) -> Result<(f64, f64)> {
    let n = k - 2;
    let lambda = |r: f64| density * counts.held(r);
    let whole = lambda(cap);
    let (at_cap, mut spread) = counts.mean(cap)?;
    let mut value = at_cap * at_most(n, whole);
    let (low, last) = window(k);
    if low >= whole {
        return Ok((value, spread));
    }
    let from = if low > 0.0 { radius_of(low, cap, lambda) } else { 0.0 };
    let to = if last < whole { radius_of(last, cap, lambda) } else { cap };
    let mean = f64::from(k - 1);
    let width = mean.sqrt();
    for step in [-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0] {
        let s = mean + step * width;
        if s > 0.0 && s < whole {
            ends.push(radius_of(s, cap, lambda));
        }
    }
    for pair in pieces(from, to, ends).windows(2) {
        for (r, w) in rule.on(pair[0], pair[1]) {
            let probability = probability(n, lambda(r)) * density * counts.shell(r);
            if probability > 0.0 {
                let (m, s) = counts.mean(r)?;
                value += w * probability * m;
                spread = spread.max(s);
            }
        }
    }
    // Probabilities of thousands of photons are good to some ten roundings of their exponents.
    Ok((value, spread + 10.0))
}

/// Expected counts beyond which the k-th distance is not found: of the gamma density of order k - 1, what lies ten
/// deviations out, and 50 more above, is below e^(-45).
fn window(k: u32) -> (f64, f64) {
    let mean = f64::from(k - 1);
    let width = mean.sqrt();
    (mean - 10.0 * width, mean + 10.0 * width + 50.0)
}

/// A cap as good as `cap`, below which the k-th photon is found but for e^(-45).
pub(super) fn useful_cap(k: u32, cap: f64, density: f64, counts: &impl Counts) -> f64 {
    let lambda = |r: f64| density * counts.held(r);
    let (_, last) = window(k);
    if lambda(cap) > last { (1.01 * radius_of(last, cap, lambda)).min(cap) } else { cap }
}

/// The radius that holds s photons, to a part in a million: it only parts pieces.
fn radius_of(s: f64, cap: f64, lambda: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, cap);
    while high - low > 1e-6 * high && high > 1e-12 * cap {
        let middle = 0.5 * (low + high);
        if lambda(middle) < s { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

struct Question<'a> {
    treatment: Treatment,
    kernel: Kernel,
    k: u32,
    cap: f64,
    body: Body,
    at: [f64; 3],
    density: f64,
    field: Field<'a>,
}

fn answer(question: Question) -> Result<Value> {
    let Question { treatment, kernel, k, cap, body, at, density, field } = question;
    check_kernel(kernel)?;
    check_gather(k, cap, density)?;
    let place = body.place(at, cap)?;
    if exact(treatment, body, cap, &field) {
        return Ok(Value::new(1.0, 0.0, "exact"));
    }
    let asked = CheckedField::new(field, false);
    let plain = Gather::new(Rule::coarse(), Treatment::None, kernel, &place, cap, &asked);
    asked.verdict()?;
    let cap = useful_cap(k, cap, density, &plain);
    let place = body.place(at, cap)?;
    settle(METHOD, |rule| {
        let gather = Gather::new(rule, treatment, kernel, &place, cap, &asked);
        asked.verdict()?;
        mixture(rule, k, cap, density, gather.ends(), &gather)
    })
}

/// Expectation of the k-nearest estimate of a field with a treatment, over independent photons.
///
/// # Arguments
/// `k` 2 to 1e6; `cap` largest radius \[length\], 1e-12 to 1e12; `at` a place of the body; `density` photons per volume
/// where the field is 1 \[1/length^3 per unit of the field\]; `field` as in [`super::treated_mean`], nowhere negative
/// # Returns
/// \[unit of the field\]
/// # Errors
/// `Error::OutOfRange` naming the parameter, `field` if it is negative; `Error::NotFinite` if the field is not;
/// `Error::Infinite` as [`super::treated_mean`]
/// # Limits
/// small densities: [`super::treated_mean`] at the cap; a uniform field: itself wherever the treatment is exact, for
/// every k and cap
/// # Source
/// Loftsgaarden and Quesenberry 1965 for the plain estimate
#[expect(clippy::too_many_arguments, reason = "the question has as many parts")]
pub fn nearest_treated_mean(
    treatment: Treatment,
    kernel: Kernel,
    k: u32,
    cap: f64,
    body: Body,
    at: [f64; 3],
    density: f64,
    field: impl Fn([f64; 3]) -> f64,
) -> Result<Value> {
    answer(Question { treatment, kernel, k, cap, body, at, density, field: Field::Any(&field) })
}

/// [`nearest_treated_mean`] of a field of one number, as in [`super::treated_mean_symmetric`]: much faster.
///
/// # Arguments
/// as there
/// # Errors
/// as there, and `Error::Infinite` for a cuboid
#[expect(clippy::too_many_arguments, reason = "the question has as many parts")]
pub fn nearest_treated_mean_symmetric(
    treatment: Treatment,
    kernel: Kernel,
    k: u32,
    cap: f64,
    body: Body,
    at: [f64; 3],
    density: f64,
    field: impl Fn(f64) -> f64,
) -> Result<Value> {
    check_symmetric(body)?;
    answer(Question { treatment, kernel, k, cap, body, at, density, field: Field::Symmetric(&field) })
}

/// [`nearest_treated_mean`] of the field 1: the furnace's error, geometry alone.
///
/// # Arguments
/// as there, `density` in photons per volume
/// # Errors
/// as there
pub fn nearest_treated_mean_uniform(
    treatment: Treatment,
    kernel: Kernel,
    k: u32,
    cap: f64,
    body: Body,
    at: [f64; 3],
    density: f64,
) -> Result<Value> {
    answer(Question { treatment, kernel, k, cap, body, at, density, field: Field::Uniform })
}
