//! The experiment `extremes`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_extremes");

/// Two studies of a fiftieth of the photons, some ten seconds each, of which the exact slabs take most: every row is
/// measured, judged and drawn.
#[test]
fn the_same_results_on_one_thread_and_two() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads(PROGRAM, "0.02", folder.path());
    // What is computed, not sampled, does not depend on the photons: nothing is lost, changed, or let through.
    let claims = std::fs::read_to_string(one.join("claims.csv")).unwrap();
    for claim in ["non-finite", "checked", "scale", "refusals", "resolution"] {
        let line = claims.lines().find(|line| line.starts_with(&format!("extremes,{claim},"))).unwrap();
        assert!(line.contains(",upheld,"), "{line}");
    }
    assert!(run::figures(&one) >= 3);
}
