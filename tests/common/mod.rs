//! What the integration tests share.
#![allow(dead_code, reason = "the faults use a part")]

use proptest::test_runner::{Config, RngAlgorithm, RngSeed};

/// Properties with a fixed seed, `cases` cases and no file of past failures: the same cases on every run.
pub fn config(cases: u32) -> Config {
    Config {
        cases,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(20_010_728),
        failure_persistence: None,
        ..Config::default()
    }
}

/// False alarms allowed to one statistical assertion: a family of a thousand then has 1e-3.
pub const ALPHA: f64 = 1e-6;
