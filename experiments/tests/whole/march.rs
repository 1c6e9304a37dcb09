//! The experiment `march`, whole, on few photons.

use super::run;

/// A fiftieth of the photons, some ten seconds: every map is shot, every ray marched, every case judged and drawn.
#[test]
fn the_experiment_runs_and_finds_no_contradiction() {
    run::finds_no_contradiction(env!("CARGO_BIN_EXE_march"), "0.02");
}
