//! The experiment `boundary`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_boundary");

/// A hundredth of the photons, some ten seconds, of which predictions take most: every map of the real one is made, every
/// case predicted, gathered, judged and drawn.
#[test]
fn every_case_is_judged_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    run::run(PROGRAM, "0.01", "2", folder.path());
    assert!(run::figures(folder.path()) >= 5);
}
