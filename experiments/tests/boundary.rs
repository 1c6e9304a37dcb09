//! The experiment `boundary`, whole, on few photons.
#![allow(clippy::unwrap_used, reason = "tests")]

mod whole;

const PROGRAM: &str = env!("CARGO_BIN_EXE_boundary");

/// Two studies of a fiftieth of the photons, some ten seconds each: every map of the real one is made, every case
/// predicted, gathered, judged and drawn.
#[test]
fn the_same_results_on_one_thread_and_two_and_after_a_loss() {
    let folder = tempfile::tempdir().unwrap();
    let one = whole::same_on_threads(PROGRAM, "0.02", folder.path());
    // Cells of three kinds.
    let lost = ["sheet-000003", "section-000001", "lit-sphere-n400-000005"]
        .map(|cell| format!("boundary/{cell}.csv"));
    whole::same_after_a_loss(PROGRAM, "0.02", &one, &lost.each_ref().map(String::as_str));
    assert!(whole::figures(&one) >= 5);
}
