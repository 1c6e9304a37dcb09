//! The patches of `tests/faults/patches` are of this tree: each applies, and names a test that exists.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// All patches: name and text.
fn patches() -> Vec<(String, String)> {
    let folder = root().join("tests/faults/patches");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "patch"));
    paths.sort();
    let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_string();
    paths.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

/// The changes of a patch: the file, and for each stretch its lines before and after.
fn changes(patch: &str) -> Vec<(PathBuf, Vec<[Vec<&str>; 2]>)> {
    let mut files: Vec<(PathBuf, Vec<[Vec<&str>; 2]>)> = Vec::new();
    for line in patch.lines().skip_while(|line| !line.starts_with("--- ")) {
        if let Some(path) = line.strip_prefix("--- a/") {
            files.push((root().join(path), Vec::new()));
        } else if line.starts_with("@@ ") {
            files.last_mut().unwrap().1.push([Vec::new(), Vec::new()]);
        } else if !line.starts_with("+++ ") {
            let [before, after] = files.last_mut().unwrap().1.last_mut().unwrap();
            let (sign, text) = if line.is_empty() { (" ", "") } else { line.split_at(1) };
            assert!([" ", "-", "+"].contains(&sign), "{line}");
            before.extend((sign != "+").then_some(text));
            after.extend((sign != "-").then_some(text));
        }
    }
    files
}

/// Where lines stand in a text.
fn places(text: &str, wanted: &[&str]) -> Vec<usize> {
    let lines: Vec<&str> = text.lines().collect();
    let starts = lines.windows(wanted.len()).enumerate();
    starts.filter(|(_, window)| *window == wanted).map(|(start, _)| start).collect()
}

#[test]
fn every_patch_applies_at_one_place() {
    let patches = patches();
    assert!(patches.len() >= 7, "{}", patches.len());
    for (name, patch) in patches {
        let files = changes(&patch);
        assert!(!files.is_empty(), "{name}");
        for (path, stretches) in files {
            let text = fs::read_to_string(&path).unwrap();
            for [before, after] in &stretches {
                assert_ne!(before, after, "{name}");
                assert_eq!(
                    places(&text, before).len(),
                    1,
                    "{name}: {}:\n{}",
                    path.display(),
                    before.join("\n")
                );
            }
        }
    }
}

/// All Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match path.is_dir() {
            true if path.ends_with("target") => {}
            true => found.extend(sources(&path)),
            false if path.extension().is_some_and(|ending| ending == "rs") => found.push(path),
            false => {}
        }
    }
    found
}

/// The test that must fail is one function, a test, of the package that the patch names; and the table of faults names both.
#[test]
fn every_patch_names_a_test_and_has_its_row() {
    let document = fs::read_to_string(root().join("tests/faults/BY_HAND.md")).unwrap();
    let patches = patches();
    for (name, patch) in &patches {
        let line = patch.lines().find_map(|line| line.strip_prefix("# test: ")).unwrap();
        let words: Vec<&str> = line.split(' ').collect();
        let (folder, test) = match words[..] {
            ["-p", "turbid-analytic", "--test", _, test] => ("analytic", test),
            ["-p", "turbid-experiments", "--test", _, test] => ("experiments/tests", test),
            ["-p", "turbid-experiments", "--lib", test] => ("experiments/src", test),
            _ => panic!("{name}: {line}"),
        };
        let is_there = |path: &PathBuf| {
            let text = fs::read_to_string(path).unwrap();
            let lines: Vec<&str> = text.lines().map(str::trim).collect();
            let own = format!("fn {test}(");
            lines.windows(2).filter(|pair| pair[0] == "#[test]" && pair[1].starts_with(&own)).count()
        };
        let count: usize = sources(&root().join(folder)).iter().map(is_there).sum();
        assert_eq!(count, 1, "{name}: {test} in {folder}");
        assert!(document.contains(&format!("| `{name}` | `{test}` |")), "{name}");
    }
    let rows = document.split("\n## As patches").nth(1).unwrap().lines().filter(|line| line.ends_with("` |"));
    assert_eq!(rows.count(), patches.len());
}
