//! Inputs of any bits, and what every answer to them must be.

use proptest::prelude::*;
use turbid_analytic::{Result, Value};

pub type Outcome = std::result::Result<(), TestCaseError>;

/// A fixed seed, so that a failure repeats; no files left behind.
pub fn cases(cases: u32, seed: u64) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: proptest::test_runner::RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Any bits, and numbers near the ranges in use.
pub fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => any::<f64>(),
        1 => -3.0..3.0_f64,
        1 => 0.0..1.0_f64,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(-1.0), Just(5e-324), Just(f64::INFINITY)],
        1 => (-320.0..308.0_f64).prop_map(|e| libm::pow(10.0, e)),
    ]
}

/// A finite number with a finite bound, or a refusal that says what is allowed: singular equations of ours are neither.
pub fn sound(answer: Result<Value>) -> Outcome {
    match answer {
        Ok(v) => prop_assert!(v.value.is_finite() && v.error.is_finite() && v.error >= 0.0, "{v:?}"),
        Err(error) => prop_assert!(error.to_string().contains("; allowed: "), "{error}"),
    }
    Ok(())
}
