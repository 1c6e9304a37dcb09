//! A whole experiment on few photons, through its own command.

use assert_cmd::Command;
use std::path::{Path, PathBuf};

/// Runs a command; what it prints.
pub fn run(program: &str, photons: &str, threads: &str, out: &Path) -> String {
    let mut command = Command::new(program);
    command.args(["--photons", photons, "--threads", threads, "--out"]).arg(out);
    let assert = command.assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Runs a command on one thread and on two, which give the same results; the folder of the first.
pub fn same_on_threads(program: &str, photons: &str, folder: &Path) -> PathBuf {
    let (one, two) = (folder.join("one"), folder.join("two"));
    let printed = run(program, photons, "1", &one);
    assert!(printed.contains("claims:") && printed.contains("report.html"), "{printed}");
    run(program, photons, "2", &two);
    for file in ["results.csv", "predictions.csv", "claims.csv", "headlines.csv", "numbers.tex"] {
        let read = |folder: &Path| std::fs::read(folder.join(file)).unwrap();
        assert!(read(&one) == read(&two), "{file} depends on the threads");
    }
    one
}

/// Cells are lost: only they are measured again, and the results stay.
pub fn same_after_a_loss(program: &str, photons: &str, one: &Path, lost: &[&str]) {
    let before = std::fs::read(one.join("results.csv")).unwrap();
    for cell in lost {
        std::fs::remove_file(one.join("cells").join(cell)).unwrap();
    }
    run(program, photons, "2", one);
    assert!(before == std::fs::read(one.join("results.csv")).unwrap());
}

/// The report of a run: number of figures, and nothing that is not a number.
pub fn figures(one: &Path) -> usize {
    let report = std::fs::read_to_string(one.join("report.html")).unwrap();
    assert!(!report.contains("NaN"));
    report.matches("<svg").count()
}

/// Runs a command on all cores: its report is drawn, and no claim is rejected.
pub fn finds_no_contradiction(program: &str, photons: &str) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(program);
    command.args(["--photons", photons, "--out"]).arg(folder.path());
    let printed = String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap();
    assert!(printed.contains(" 0 rejected"), "{printed}");
    assert!(figures(folder.path()) > 0);
}

/// With the fewest photons that are allowed, one a map, a study still ends with a report.
pub fn ends_with_the_fewest_photons(program: &str) {
    let folder = tempfile::tempdir().unwrap();
    let printed = run(program, "1e-6", "2", folder.path());
    assert!(printed.contains("Report: "), "{printed}");
    figures(folder.path());
}
