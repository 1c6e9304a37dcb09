//! The experiment `selection`, whole, on few photons.

use super::run;

/// Half the photons: its claims are of some number of photons, and would not hold of a twentieth.
#[test]
fn the_experiment_runs_and_finds_no_contradiction() {
    run::finds_no_contradiction(env!("CARGO_BIN_EXE_selection"), "0.5");
}

#[test]
fn the_fewest_photons_end_with_a_report() {
    run::ends_with_the_fewest_photons(env!("CARGO_BIN_EXE_selection"));
}
