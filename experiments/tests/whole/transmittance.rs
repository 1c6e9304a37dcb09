//! The experiment `transmittance`, whole, on few estimates.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_transmittance");

/// A tenth of the estimates: the results do not depend on the threads, nor on lost cells, every case is judged and
/// drawn, and nothing is rejected.
#[test]
fn a_tenth_of_the_estimates() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads_and_after_a_loss(PROGRAM, "0.1", folder.path());
    assert_eq!(run::figures(&one), 3);
    assert!(!std::fs::read_to_string(one.join("claims.csv")).unwrap().contains(",rejected,"));
}

#[test]
fn the_fewest_estimates_end_with_a_report() {
    run::ends_with_the_fewest_photons(PROGRAM);
}
