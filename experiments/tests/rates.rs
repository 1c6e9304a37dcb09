//! The experiment `rates`, whole, on few photons.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;

/// A twentieth of the photons, some five seconds: every map is shot, every exponent fitted, judged and drawn.
#[test]
fn the_experiment_runs_and_finds_no_contradiction() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_rates"));
    command.args(["--photons", "0.05", "--out"]).arg(folder.path());
    let printed = String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap();
    assert!(printed.contains(" 0 rejected"), "{printed}");
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("<svg") && !report.contains("NaN"));
}
