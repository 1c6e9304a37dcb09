//! Figures are redrawn from their tables, without measuring.
#![allow(clippy::unwrap_used, reason = "tests")]

mod fake;

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use turbid_experiments::harness::{Replot, Settings, replot, run};
use turbid_figure::Width;

/// All files of a folder but the cells, by path.
fn files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in [out.to_path_buf(), out.join("figures")] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let name = path.strip_prefix(out).unwrap().to_str().unwrap().to_string();
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// A finished study of the experiment whose answer is known.
fn finished() -> (tempfile::TempDir, Settings) {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings { threads: 2, ..Settings::new(folder.path()) };
    run(&fake::study(), &settings).unwrap();
    (folder, settings)
}

fn changed(before: &BTreeMap<String, Vec<u8>>, after: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    assert!(before.keys().eq(after.keys()), "files came or went");
    after.iter().filter(|(name, bytes)| before[*name] != **bytes).map(|(name, _)| name.clone()).collect()
}

/// Replaces text in the table of the figure.
fn edit(out: &Path, from: &str, to: &str) {
    let path = out.join("figures/fake-bias.csv");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from} in {text}");
    fs::write(path, text.replace(from, to)).unwrap();
}

#[test]
fn a_study_leaves_each_figure_in_both_widths_and_as_a_table() {
    let (folder, _) = finished();
    let found = files(folder.path());
    let names: Vec<&str> = found.keys().filter_map(|name| name.strip_prefix("figures/")).collect();
    let expected = [
        "fake-bias-double.png",
        "fake-bias-double.svg",
        "fake-bias.csv",
        "fake-bias.png",
        "fake-bias.svg",
        "fake-bias.tex",
    ];
    assert_eq!(names, expected);
    let svg = |name: &str| String::from_utf8(found[name].clone()).unwrap();
    assert!(svg("figures/fake-bias.svg").starts_with("<svg width=\"85.00mm\""));
    assert!(svg("figures/fake-bias-double.svg").starts_with("<svg width=\"175.00mm\""));
    let table = svg("figures/fake-bias.csv");
    assert!(table.contains("the dots lie on the line") && table.contains("1,2,points,0.1,"));
}

#[test]
fn what_is_redrawn_unchanged_is_the_same_bytes() {
    let (folder, settings) = finished();
    let before = files(folder.path());
    let said = replot(&settings, &Replot::default()).unwrap();
    assert!(said.starts_with("1 figures redrawn: 5 files, 0 of them changed"), "{said}");
    assert_eq!(changed(&before, &files(folder.path())), Vec::<String>::new());
    // What is lost comes back.
    fs::remove_file(folder.path().join("figures/fake-bias.png")).unwrap();
    fs::remove_file(folder.path().join("figures/fake-bias-double.svg")).unwrap();
    replot(&settings, &Replot::default()).unwrap();
    assert_eq!(changed(&before, &files(folder.path())), Vec::<String>::new());
}

#[test]
fn an_edited_table_changes_the_drawings_and_the_report_and_nothing_else() {
    let (folder, settings) = finished();
    let before = files(folder.path());
    edit(folder.path(), "\"gather radius\"", "\"radius of the ball\"");
    edit(folder.path(), "the dots lie on the line", "look at the dots");
    replot(&settings, &Replot::default()).unwrap();
    let after = files(folder.path());
    let expected = [
        "figures/fake-bias-double.png",
        "figures/fake-bias-double.svg",
        "figures/fake-bias.csv",
        "figures/fake-bias.png",
        "figures/fake-bias.svg",
        "figures/fake-bias.tex",
        "report.html",
    ];
    assert_eq!(changed(&before, &after), expected);
    let page = String::from_utf8(after["report.html"].clone()).unwrap();
    assert!(page.contains(">radius of the ball [mfp]</text>") && page.contains("look at the dots"));
    assert!(!page.contains(">gather radius [mfp]</text>") && page.matches("<svg").count() == 1);
    // The study itself measures nothing and puts back what it found.
    assert_eq!(run(&fake::study(), &settings).unwrap().measured, 0);
    assert_eq!(changed(&before, &files(folder.path())), Vec::<String>::new());
}

#[test]
fn one_width_alone() {
    let (folder, settings) = finished();
    let before = files(folder.path());
    edit(folder.path(), "\"gather radius\"", "\"radius of the ball\"");
    let double = &["fake-bias-double.png", "fake-bias-double.svg"][..];
    let own = &["fake-bias.png", "fake-bias.svg", "fake-bias.tex"][..];
    for (width, expected) in [(Width::Double, double), (Width::Single, own)] {
        let start = files(folder.path());
        replot(&settings, &Replot { width: Some(width), files: vec![] }).unwrap();
        let figures = changed(&start, &files(folder.path()));
        let figures: Vec<&str> = figures.iter().filter_map(|name| name.strip_prefix("figures/")).collect();
        assert_eq!(figures, expected);
    }
    assert_eq!(changed(&before, &files(folder.path())).len(), 7);
}

#[test]
fn a_bad_table_changes_nothing() {
    let (folder, settings) = finished();
    // Another figure, good and edited, comes first in the alphabet.
    let (good, bad) = (folder.path().join("figures/a-good.csv"), folder.path().join("figures/fake-bias.csv"));
    fs::copy(&bad, &good).unwrap();
    edit(folder.path(), "1,2,points,0.4,", "1,2,points,wide,");
    let before = files(folder.path());
    let error = format!("{:#}", replot(&settings, &Replot::default()).unwrap_err());
    let line = 1 + fs::read_to_string(&bad).unwrap().lines().position(|l| l.contains("wide")).unwrap();
    let expected =
        format!("{}:{line}: column x is \"wide\"; allowed: a finite number or nothing", bad.display());
    assert_eq!(error, expected);
    assert_eq!(changed(&before, &files(folder.path())), Vec::<String>::new());
}

fn study() -> Command {
    Command::new(env!("CARGO_BIN_EXE_study"))
}

#[test]
fn the_command_redraws_folders_and_single_tables() {
    let (folder, _) = finished();
    let run = study().args(["--replot", "--out"]).arg(folder.path()).assert().success().stderr("");
    let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(text.contains("5 files, 0 of them changed"), "{text}");
    // A table anywhere is drawn beside itself.
    let alone = tempfile::tempdir().unwrap();
    let table = alone.path().join("mine.csv");
    fs::copy(folder.path().join("figures/fake-bias.csv"), &table).unwrap();
    study().args(["--replot", "--width", "double"]).arg(&table).assert().success();
    let mut names: Vec<String> =
        fs::read_dir(alone.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["mine-double.png", "mine-double.svg", "mine.csv"]);
}

#[test]
fn what_cannot_be_redrawn_is_said_in_one_line() {
    let (folder, _) = finished();
    let out = folder.path().to_str().unwrap();
    let missing = folder.path().join("nothing");
    let damaged = folder.path().join("damaged.csv");
    fs::write(&damaged, "x,y\n1,2\n").unwrap();
    for (arguments, text) in [
        (vec!["--replot", "--out", missing.to_str().unwrap()], "no finished study: cannot read"),
        (vec!["--replot", "--out", out, "--only", "bias"], "there is no figure of bias in"),
        (vec!["--replot", damaged.to_str().unwrap()], "damaged.csv:1: the file is no figure; its first line"),
        (vec!["--replot", missing.to_str().unwrap()], "cannot read"),
        (vec!["--replot", "--width", "wide"], "allowed: single, double"),
    ] {
        let run = study().args(&arguments).assert().code(2).stdout("");
        let said = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(said.starts_with("error: ") && said.trim_end().lines().count() == 1, "{said}");
        assert!(said.contains(text), "{said}");
    }
}

/// Names in `\\thisrow{...}`.
fn columns(tex: &str) -> Vec<&str> {
    let rows = tex.split("\\thisrow{").skip(1).map(|rest| rest.split_once('}').unwrap().0);
    rows.filter(|name| *name != "#1").collect()
}

#[test]
fn every_figure_is_latex_that_reads_its_table() {
    let (folder, _) = finished();
    let found = files(folder.path());
    let text = |name: &str| String::from_utf8(found[name].clone()).unwrap();
    let tables: Vec<&String> =
        found.keys().filter(|name| name.starts_with("figures/") && name.ends_with(".csv")).collect();
    assert!(!tables.is_empty());
    for name in tables {
        let (tex, table) = (text(&name.replace(".csv", ".tex")), text(name));
        let known: Vec<&str> = table.lines().find(|l| !l.starts_with('#')).unwrap().split(',').collect();
        assert!(tex.contains(&format!("\\def\\turbidtable{{{}}}", name.replace("figures/", ""))));
        let used = columns(&tex);
        assert!(used.contains(&"y_low") && used.iter().all(|c| known.contains(c)), "{used:?} of {known:?}");
        // Words behind the numbers: a comma in a label moves none.
        assert_eq!(known.last(), Some(&"label"));
    }
}
