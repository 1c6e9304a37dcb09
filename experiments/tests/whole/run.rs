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

/// What may depend on nothing but the settings.
const RESULTS: [&str; 5] = ["results.csv", "predictions.csv", "claims.csv", "headlines.csv", "numbers.tex"];

/// Runs a command on one thread; loses every fourth cell of each group, and all that was concluded; and runs it on two, which give the
/// same cells and results. The folder.
pub fn same_on_threads_and_after_a_loss(program: &str, photons: &str, folder: &Path) -> PathBuf {
    let out = folder.join("out");
    let printed = run(program, photons, "1", &out);
    assert!(printed.contains("claims:") && printed.contains("report.html"), "{printed}");
    let read = |file: &str| std::fs::read(out.join(file)).unwrap();
    let before = RESULTS.map(read);
    let groups = lose(&out.join("cells"));
    assert!(groups > 0);
    for file in RESULTS.into_iter().filter(|file| *file != "predictions.csv") {
        std::fs::remove_file(out.join(file)).unwrap();
    }
    run(program, photons, "2", &out);
    for (file, before) in RESULTS.into_iter().zip(before) {
        assert!(before == read(file), "{file} depends on the threads, or on what was lost");
    }
    out
}

/// Removes every fourth cell of each group, the first included; the number of groups.
fn lose(cells: &Path) -> usize {
    let folders = std::fs::read_dir(cells).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = folders
        .filter(|path| path.is_dir())
        .flat_map(|folder| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()))
        .collect();
    files.sort();
    let mut groups = std::collections::BTreeMap::new();
    for file in files {
        // As albedo0.9-n4000-000003.csv; predictions stay.
        let name = file.file_stem().unwrap().to_str().unwrap();
        let Some((group, _)) = name.rsplit_once('-') else { continue };
        let count: &mut usize = groups.entry(group.to_string()).or_default();
        if count.is_multiple_of(4) {
            std::fs::remove_file(&file).unwrap();
        }
        *count += 1;
    }
    groups.len()
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
