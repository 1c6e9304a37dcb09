//! Verdicts: a failure says everything needed to judge it and to repeat it. Every one states the smallest deviation that
//! it can detect, and fails where that is larger than its test promises.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use turbid::stats::{
    ALPHA, MeanTest, Moments, chi_squared_test, kolmogorov_smirnov_test, normal_critical,
    smallest_detectable_bias, smallest_detectable_deviation, smallest_detectable_distance, student_p, t_test,
    z_test,
};

/// The fewest independent values behind a verdict.
const FEWEST: u64 = 64;

/// What one verdict found while a trial runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What was tested.
    pub what: String,
    /// Distance in standard errors; the normal deviate of its p-value where a whole distribution was tested.
    pub z: f64,
    /// p-value.
    pub p: f64,
}

/// What a check found when nobody asserted its statistical verdicts.
#[derive(Debug, Clone, Default)]
pub struct Trial {
    /// Its verdicts.
    pub findings: Vec<Finding>,
    /// How a check that knows no chance failed.
    pub broken: Option<String>,
}

impl Trial {
    /// The verdict with the smallest p-value, the farthest of equals.
    pub fn worst(&self) -> Option<&Finding> {
        let key = |f: &&Finding| (-f.p, f.z.abs());
        self.findings.iter().max_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    /// Whether the suite would have failed.
    pub fn is_rejected(&self) -> bool {
        self.broken.is_some() || self.worst().is_some_and(|f| f.p < ALPHA)
    }
}

thread_local! {
    static TRIAL: RefCell<Option<Trial>> = const { RefCell::new(None) };
}

/// Runs a check of the suite and keeps its verdicts instead of asserting them. Negative controls are left out.
pub fn trial(check: impl FnOnce()) -> Trial {
    TRIAL.set(Some(Trial::default()));
    let ended = catch_unwind(AssertUnwindSafe(check));
    let mut trial = TRIAL.take().unwrap_or_default();
    if let Err(cause) = ended {
        let text = cause.downcast_ref::<String>().cloned();
        let text = text.or_else(|| cause.downcast_ref::<&str>().map(ToString::to_string));
        trial.broken = Some(text.unwrap_or_default());
    }
    trial
}

/// Whether a trial runs; then it keeps the finding.
fn on_trial(finding: Option<(&str, f64, f64)>) -> bool {
    TRIAL.with_borrow_mut(|trial| {
        if let (Some(trial), Some((what, z, p))) = (trial.as_mut(), finding) {
            trial.findings.push(Finding { what: what.to_string(), z, p });
        }
        trial.is_some()
    })
}

fn repeat() -> String {
    let name = std::thread::current().name().unwrap_or("").to_string();
    format!("cargo test --release --test {} {name}", env!("CARGO_CRATE_NAME"))
}

fn describe(what: &str, mean: f64, reference: f64, test: &MeanTest, n: u64, seed: u64) -> String {
    format!(
        "{what}: estimate {mean:.9e}, error {:.2e}, reference {reference:.9e}, z {:+.2}, p {:.1e}, n {n}, seed {seed}, \
         smallest detectable bias {:.2e}; repeat: {}",
        test.std_error,
        test.z,
        test.p,
        test.smallest_bias,
        repeat()
    )
}

/// A mean must agree with a reference, and the test must be able to see a bias of `promise`.
///
/// `reference_error` bounds the reference's own error. Prints one line; fails if p < [`ALPHA`], if a bias of
/// `promise` could go unseen, if the sample is heavy-tailed, or if it is too small for a verdict.
pub fn agrees(
    what: &str,
    moments: &Moments,
    (reference, reference_error): (f64, f64),
    promise: f64,
    seed: u64,
) {
    let test = t_test(moments, reference, reference_error);
    let line = describe(what, moments.mean(), reference, &test, moments.n(), seed);
    println_line(&line);
    if on_trial(Some((what, test.z, test.p))) {
        return;
    }
    assert!(moments.n() >= FEWEST, "too few values; {line}");
    assert!(!moments.is_heavy_tailed(), "variance of variance {:.2}; {line}", moments.vov());
    assert!(test.p >= ALPHA, "disagrees; {line}");
    assert!(test.smallest_bias <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// The same of values whose variance is infinite, but only just: with tails as x^-2 a mean over its own standard error is normal in the
/// end all the same (Gine, Goetze and Mason 1997). Simulated for 128 and 200 sums of 25 to 400 inverse determinants of planes and rays it has
/// mean -0.2, standard deviation 1.03 and extremes -4.5 and 3.2 in 5,300 trials; a variance of variance above 0.1 is found in a fifth of
/// them, and says nothing here.
pub fn agrees_with_a_tail(
    what: &str,
    moments: &Moments,
    (reference, reference_error): (f64, f64),
    promise: f64,
    seed: u64,
) {
    let test = t_test(moments, reference, reference_error);
    let line = describe(what, moments.mean(), reference, &test, moments.n(), seed);
    println_line(&line);
    if on_trial(Some((what, test.z, test.p))) {
        return;
    }
    assert!(moments.n() >= FEWEST, "too few values; {line}");
    assert!(test.p >= ALPHA, "disagrees; {line}");
    assert!(test.smallest_bias <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// A negative control: the same test must reject it.
pub fn rejects(what: &str, moments: &Moments, reference: f64, seed: u64) {
    let test = t_test(moments, reference, 0.0);
    let line = describe(what, moments.mean(), reference, &test, moments.n(), seed);
    println_line(&line);
    if on_trial(None) {
        return;
    }
    assert!(test.p < ALPHA, "a wrong value passes; {line}");
}

/// Two independent means of the same quantity.
pub fn agree(what: &str, a: &Moments, b: &Moments, promise: f64, seed: u64) {
    let test = two(a, b);
    let line = describe(what, a.mean(), b.mean(), &test, a.n().min(b.n()), seed);
    println_line(&line);
    if on_trial(Some((what, test.z, test.p))) {
        return;
    }
    assert!(a.n().min(b.n()) >= FEWEST, "too few values; {line}");
    assert!(
        !a.is_heavy_tailed() && !b.is_heavy_tailed(),
        "heavy-tailed: {:.2}, {:.2}; {line}",
        a.vov(),
        b.vov()
    );
    assert!(test.p >= ALPHA, "disagree; {line}");
    assert!(test.smallest_bias <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// Two independent means that must be detected to differ.
pub fn differ(what: &str, a: &Moments, b: &Moments, seed: u64) {
    let test = two(a, b);
    let line = describe(what, a.mean(), b.mean(), &test, a.n().min(b.n()), seed);
    println_line(&line);
    if on_trial(None) {
        return;
    }
    assert!(test.p < ALPHA, "a wrong value passes; {line}");
}

/// Degrees of freedom are those of the smaller sample: fewer than Welch's, hence cautious.
fn two(a: &Moments, b: &Moments) -> MeanTest {
    let difference = a.mean() - b.mean();
    let std_error = (a.std_error() * a.std_error() + b.std_error() * b.std_error()).sqrt();
    let freedom = a.n().min(b.n()) - 1;
    let z = if difference == 0.0 { 0.0 } else { difference / std_error };
    MeanTest {
        difference,
        std_error,
        z,
        p: student_p(z, freedom),
        smallest_bias: smallest_detectable_bias(std_error, freedom),
    }
}

/// A rate of independent events: `count` of `n`, where `expected` is right. Its error is known, not estimated.
pub fn rate(what: &str, count: u64, n: u64, expected: f64, promise: f64, seed: u64) {
    let error = (expected * (1.0 - expected) / n as f64).sqrt();
    let test = z_test(count as f64 / n as f64, error, expected);
    let line = describe(what, count as f64 / n as f64, expected, &test, n, seed);
    println_line(&line);
    if on_trial(Some((what, test.z, test.p))) {
        return;
    }
    assert!(test.p >= ALPHA, "disagrees; {line}");
    assert!(test.smallest_bias <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// A test of a whole distribution.
#[derive(Debug, Clone, Copy)]
pub struct Fit {
    /// p-value.
    pub p: f64,
    /// The smallest deviation that it hardly ever misses: of the distribution function, or of the cells' probabilities
    /// (root mean square, relative).
    pub smallest: f64,
}

/// Independent values against their distribution function, by Kolmogorov and Smirnov.
pub fn cumulated(values: &[f64], cdf: impl Fn(f64) -> f64) -> Fit {
    let p = kolmogorov_smirnov_test(values, cdf).p;
    Fit { p, smallest: smallest_detectable_distance(values.len()) }
}

/// Independent counts against what is expected of them, by chi-squared.
pub fn counted(observed: &[f64], expected: &[f64]) -> Fit {
    let test = chi_squared_test(observed, expected, 0);
    let smallest = smallest_detectable_deviation(expected.iter().sum(), test.freedom.max(1));
    Fit { p: test.p, smallest }
}

/// The normal deviate beyond which a p-value is below 1e-300, or 0.
pub const BEYOND_P: f64 = 37.0;

fn describe_fit(what: &str, fit: &Fit, seed: u64) -> String {
    let Fit { p, smallest } = fit;
    format!(
        "{what}: p {p:.1e}, seed {seed}, smallest detectable deviation {smallest:.2e}; repeat: {}",
        repeat()
    )
}

/// A whole distribution must be right, and a deviation of `promise` must be detected.
pub fn fits(what: &str, fit: Fit, promise: f64, seed: u64) {
    let line = describe_fit(what, &fit, seed);
    println_line(&line);
    let z = if fit.p > 0.0 { normal_critical(fit.p.clamp(1e-300, 1.0 - 1e-12)) } else { BEYOND_P };
    if on_trial(Some((what, z, fit.p))) {
        return;
    }
    assert!(fit.p >= ALPHA, "disagrees; {line}");
    assert!(fit.smallest <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// The goodness-of-fit test of a negative control.
pub fn misfits(what: &str, fit: Fit, seed: u64) {
    let line = describe_fit(what, &fit, seed);
    println_line(&line);
    if !on_trial(None) {
        assert!(fit.p < ALPHA, "a wrong value passes; {line}");
    }
}

/// Seen with `--nocapture`, and beside a failure.
#[allow(clippy::print_stdout, reason = "a test's protocol")]
pub fn println_line(line: &str) {
    println!("{line}");
}
