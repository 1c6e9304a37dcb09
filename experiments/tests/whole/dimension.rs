//! The experiment `dimension`, whole, on few photons.

use super::run;

/// A fiftieth of the photons: every map is shot, every exponent fitted, judged and drawn.
#[test]
fn the_experiment_runs_and_finds_no_contradiction() {
    run::finds_no_contradiction(env!("CARGO_BIN_EXE_dimension"), "0.02");
}

#[test]
fn the_fewest_photons_end_with_a_report() {
    run::ends_with_the_fewest_photons(env!("CARGO_BIN_EXE_dimension"));
}
