//! The experiment `claims-1998`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_claims-1998");

/// A fiftieth of the photons: the results do not depend on the threads, nor on what was timed, and lost cells come back as they were.
#[test]
fn a_fiftieth_of_the_photons() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads_and_after_a_loss(PROGRAM, "0.02", folder.path());
    assert_eq!(run::figures(&one), 3);
    let claims = std::fs::read_to_string(one.join("claims.csv")).unwrap();
    let line = |claim: &str| claims.lines().find(|line| line.contains(&format!(",{claim},"))).unwrap();
    // What so few photons decide, and no clock: estimates do not depend on how walls are cut into triangles, importance
    // brings photons into view; and nothing is rejected.
    for claim in ["decoupled", "importance-photons"] {
        assert!(line(claim).contains(",upheld,"), "{}", line(claim));
    }
    // Maps need less work than paths. A few maps carry the variance of that: there is no verdict, but an interval.
    let low: f64 = line("faster").split(',').nth(6).unwrap().parse().unwrap();
    assert!(low > 1.0, "{}", line("faster"));
    assert!(claims.contains("importance-mean") && !claims.contains(",rejected,"), "{claims}");
}
