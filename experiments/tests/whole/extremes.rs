//! The experiment `extremes`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_extremes");

/// A fiftieth of the photons, some ten seconds, of which the exact slabs take most: every row is measured, judged and
/// drawn.
#[test]
fn every_case_is_judged_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    run::run(PROGRAM, "0.02", "2", folder.path());
    // What is computed, not sampled, does not depend on the photons: nothing is lost, changed, or let through.
    let claims = std::fs::read_to_string(folder.path().join("claims.csv")).unwrap();
    for claim in ["non-finite", "checked", "scale", "refusals", "resolution"] {
        let line = claims.lines().find(|line| line.starts_with(&format!("extremes,{claim},"))).unwrap();
        assert!(line.contains(",upheld,"), "{line}");
    }
    assert!(run::figures(folder.path()) >= 3);
}
