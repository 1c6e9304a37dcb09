//! The experiment `boundary`, whole, on few photons.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::path::Path;

fn run(out: &Path, threads: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_boundary"));
    command.args(["--photons", "0.02", "--threads", threads, "--out"]).arg(out);
    let assert = command.assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Two studies of a fiftieth of the photons, some ten seconds each: every map of the real one is made, every case
/// predicted, gathered, judged and drawn.
#[test]
fn the_same_results_on_one_thread_and_two_and_after_a_loss() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    let printed = run(&one, "1");
    assert!(printed.contains("claims:") && printed.contains("report.html"), "{printed}");
    run(&two, "2");
    for file in ["results.csv", "predictions.csv", "claims.csv"] {
        let read = |folder: &Path| std::fs::read(folder.join(file)).unwrap();
        assert!(read(&one) == read(&two), "{file} depends on the threads");
    }
    // Cells of three kinds are lost: only they are measured again, and the results stay.
    let before = std::fs::read(one.join("results.csv")).unwrap();
    for lost in ["sheet-000003", "section-000001", "sphere-n400-000005"] {
        std::fs::remove_file(one.join(format!("cells/boundary/{lost}.csv"))).unwrap();
    }
    run(&one, "2");
    assert!(before == std::fs::read(one.join("results.csv")).unwrap());
    let report = std::fs::read_to_string(one.join("report.html")).unwrap();
    assert!(report.matches("<svg").count() >= 5 && !report.contains("NaN"));
}
