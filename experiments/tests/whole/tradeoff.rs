//! The experiment `tradeoff`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_tradeoff");

/// A hundredth of the photons: every map of the real one is shot, gathered, judged and drawn, a quarter of them on other
/// threads too, and the predictions are those of the real one.
#[test]
fn the_same_results_on_one_thread_and_two() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads_and_after_a_loss(PROGRAM, "0.01", folder.path());
    assert!(run::figures(&one) >= 3);
    // Seconds stand apart from results: by phase in the cells, and in timing.csv.
    let timing = std::fs::read_to_string(one.join("timing.csv")).unwrap();
    assert_eq!(timing.lines().next(), Some("experiment,cell,phase,cpu_seconds"));
    for phase in ["all", "shooting", "building", "gathering k=10", "path tracing"] {
        assert!(timing.lines().any(|line| line.split(',').nth(2) == Some(phase)), "{phase}");
    }
}
