//! The experiment `bias`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bias");

/// Two studies of a fiftieth of the photons, some ten seconds each: every map of the real one is shot, every case
/// predicted, gathered, judged and drawn.
#[test]
fn the_same_results_on_one_thread_and_two_and_after_a_loss() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads(PROGRAM, "0.02", folder.path());
    run::same_after_a_loss(
        PROGRAM,
        "0.02",
        &one,
        &["bias/albedo0.9-n4000-000003.csv", "bias/glow-n1000-000005.csv"],
    );
    assert!(run::figures(&one) >= 4);
}
