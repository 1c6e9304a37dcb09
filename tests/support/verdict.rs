//! Verdicts on means: a failure says everything needed to judge it and to repeat it.

use turbid::stats::{ALPHA, MeanTest, Moments, smallest_detectable_bias, student_p, t_test};

/// The fewest independent values behind a verdict.
const FEWEST: u64 = 64;

fn repeat() -> String {
    let name = std::thread::current().name().unwrap_or("").to_string();
    format!("cargo test --release --test {} {name}", env!("CARGO_CRATE_NAME"))
}

fn describe(what: &str, mean: f64, reference: f64, test: &MeanTest, n: u64, seed: u64) -> String {
    format!(
        "{what}: estimate {mean:.9e}, error {:.2e}, reference {reference:.9e}, z {:+.2}, p {:.1e}, n {n}, seed {seed}, \
         smallest bias seen {:.2e}; repeat: {}",
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
    assert!(moments.n() >= FEWEST, "too few values; {line}");
    assert!(!moments.is_heavy_tailed(), "variance of variance {:.2}; {line}", moments.vov());
    assert!(test.p >= ALPHA, "disagrees; {line}");
    assert!(test.smallest_bias <= promise, "too weak for the promised {promise:.2e}; {line}");
}

/// A wrong twin: the same test must reject it.
pub fn rejects(what: &str, moments: &Moments, reference: f64, seed: u64) {
    let test = t_test(moments, reference, 0.0);
    let line = describe(what, moments.mean(), reference, &test, moments.n(), seed);
    println_line(&line);
    assert!(test.p < ALPHA, "a wrong twin passes; {line}");
}

/// Two independent means of the same quantity.
pub fn agree(what: &str, a: &Moments, b: &Moments, promise: f64, seed: u64) {
    let test = two(a, b);
    let line = describe(what, a.mean(), b.mean(), &test, a.n().min(b.n()), seed);
    println_line(&line);
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

/// Two independent means that must be seen to differ.
pub fn differ(what: &str, a: &Moments, b: &Moments, seed: u64) {
    let test = two(a, b);
    let line = describe(what, a.mean(), b.mean(), &test, a.n().min(b.n()), seed);
    println_line(&line);
    assert!(test.p < ALPHA, "a wrong twin passes; {line}");
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

/// A p-value of a goodness-of-fit test.
pub fn fits(what: &str, p: f64, seed: u64) {
    println_line(&format!("{what}: p {p:.1e}, seed {seed}"));
    assert!(p >= ALPHA, "{what}: p {p:.1e}, seed {seed}; repeat: {}", repeat());
}

/// The goodness-of-fit test of a wrong twin.
pub fn misfits(what: &str, p: f64, seed: u64) {
    println_line(&format!("{what}: p {p:.1e}, seed {seed}"));
    assert!(p < ALPHA, "a wrong twin passes: {what}: p {p:.1e}, seed {seed}; repeat: {}", repeat());
}

/// Seen with `--nocapture`, and beside a failure.
#[allow(clippy::print_stdout, reason = "a test's protocol")]
pub fn println_line(line: &str) {
    println!("{line}");
}
