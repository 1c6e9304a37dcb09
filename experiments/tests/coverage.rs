//! The experiment `coverage`, whole, on few repeats.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::path::Path;

fn run(out: &Path, threads: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_coverage"));
    command.args(["--photons", "0.05", "--threads", threads, "--out"]).arg(out).assert().success();
}

/// A twentieth of the repeats, twice, some three seconds each: the results do not depend on the threads, and say what
/// the intervals cover.
#[test]
fn a_twentieth_of_the_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    run(&one, "1");
    run(&two, "2");
    let read = |folder: &Path, file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    for file in ["results.csv", "predictions.csv", "claims.csv"] {
        assert!(read(&one, file) == read(&two, file), "{file} depends on the threads");
    }
    let report = read(&one, "report.html");
    assert!(report.matches("<svg").count() == 3 && !report.contains("NaN"));
    assert!(!read(&one, "claims.csv").contains(",rejected,"));
}
