//! The experiment `coverage`, whole, on few repeats.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_coverage");

/// A twentieth of the repeats, some seconds: the results do not depend on the threads, nor on lost cells, and say what the intervals
/// cover.
#[test]
fn a_twentieth_of_the_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads_and_after_a_loss(PROGRAM, "0.05", folder.path());
    assert_eq!(run::figures(&one), 3);
    assert!(!std::fs::read_to_string(one.join("claims.csv")).unwrap().contains(",rejected,"));
}
