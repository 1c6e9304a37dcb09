//! The experiment `deck`, whole, on few photons.

use super::run;

const PROGRAM: &str = env!("CARGO_BIN_EXE_deck");

/// A fiftieth of the photons, twice: the results do not depend on the threads, nor on what was timed, and a lost cell
/// comes back as it was.
#[test]
fn a_fiftieth_of_the_photons() {
    let folder = tempfile::tempdir().unwrap();
    let one = run::same_on_threads(PROGRAM, "0.02", folder.path());
    assert_eq!(run::figures(&one), 3);
    run::same_after_a_loss(PROGRAM, "0.02", &one, &["deck/walls-000000.csv", "deck/edge-000003.csv"]);
    let claims = std::fs::read_to_string(one.join("claims.csv")).unwrap();
    // How this one falls is a matter of the clock.
    assert!(claims.lines().any(|line| line.contains("decoupled")), "{claims}");
}
