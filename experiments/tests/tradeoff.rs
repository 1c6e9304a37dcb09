//! The experiment `tradeoff`, whole, on few photons.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::path::Path;

fn run(out: &Path, threads: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tradeoff"));
    command.args(["--photons", "0.02", "--threads", threads, "--out"]).arg(out);
    let assert = command.assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Two studies of a fiftieth of the photons, some ten seconds each: every map of the real one is shot, gathered, judged
/// and drawn, and the predictions are those of the real one.
#[test]
fn the_same_results_on_one_thread_and_two() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    let printed = run(&one, "1");
    assert!(printed.contains("claims:") && printed.contains("report.html"), "{printed}");
    run(&two, "2");
    for file in ["results.csv", "predictions.csv", "claims.csv"] {
        let read = |folder: &Path| std::fs::read(folder.join(file)).unwrap();
        assert!(read(&one) == read(&two), "{file} depends on the threads");
    }
    let report = std::fs::read_to_string(one.join("report.html")).unwrap();
    assert!(report.matches("<svg").count() >= 3 && !report.contains("NaN"));
    // Seconds stand apart from results: by phase in the cells, and in timing.csv.
    let timing = std::fs::read_to_string(one.join("timing.csv")).unwrap();
    assert_eq!(timing.lines().next(), Some("experiment,cell,phase,cpu_seconds"));
    for phase in ["all", "shooting", "building", "gathering k=10", "path tracing"] {
        assert!(timing.lines().any(|line| line.split(',').nth(2) == Some(phase)), "{phase}");
    }
}
