//! The experiment `blur`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_blur");

/// Two studies of a fiftieth of the photons, some ten seconds each: every map of the real one is shot, every case
/// predicted, gathered, judged and drawn.
#[test]
fn the_same_results_on_one_thread_and_two() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads(PROGRAM, "0.02", folder.path());
    assert!(run::figures(&one) >= 4);
}
