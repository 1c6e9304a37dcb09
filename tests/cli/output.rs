//! What is printed: columns, formats, the same bytes on any number of threads, closed pipes and full disks.

use crate::{Folder, succeeds, text, turbid};
use std::io::Read;
use std::process::{Command, Stdio};

const COLUMNS: [&str; 6] = ["sensor", "quantity", "unit", "mean", "std_error", "n"];
/// What follows them as CSV: what the numbers were made with.
const RUN: [&str; 25] = [
    "with",
    "seed",
    "orders",
    "samples",
    "weight_windows",
    "guide",
    "photons",
    "maps",
    "radius",
    "k",
    "max_radius",
    "ray_radius",
    "ray_k",
    "beam_radius",
    "beam_blur",
    "beam_length",
    "beam_fluence",
    "ray_ends",
    "planes",
    "progressive",
    "kernel",
    "boundary",
    "reject",
    "version",
    "revision",
];
const PATH: [&str; 6] = ["measure", "slab", "--with", "paths", "--samples", "5000"];
const PHOTONS: [&str; 8] = ["measure", "slab", "--with", "photons", "--photons", "2e4", "--maps", "2"];

fn with<'a>(arguments: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    arguments.iter().chain(more).copied().collect()
}

#[test]
fn tables_csv_and_json_say_the_same() {
    for (arguments, n) in [(&PATH[..], 5000), (&PHOTONS[..], 20_000)] {
        let table = succeeds(arguments);
        assert_eq!(table.lines().next().unwrap().split_whitespace().collect::<Vec<_>>(), COLUMNS);
        let csv = succeeds(&with(arguments, &["--format", "csv"]));
        let json = succeeds(&with(arguments, &["--format", "json"]));
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        assert_eq!(reader.headers().unwrap(), [&COLUMNS[..], &["why"], &RUN].concat());
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let document: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(document["format"], 3);
        let rows = document["rows"].as_array().unwrap();
        for (column, name) in RUN.iter().enumerate() {
            let of_json = match &document["run"][*name] {
                serde_json::Value::Null => String::new(),
                serde_json::Value::String(text) => text.clone(),
                number => number.to_string(),
            };
            assert!(records.iter().all(|record| record[7 + column] == of_json), "{name}: {of_json}");
        }
        assert_eq!((records.len(), rows.len(), table.lines().count()), (9, 9, 10));
        for (record, row) in records.iter().zip(rows) {
            for (i, column) in COLUMNS.iter().take(3).enumerate() {
                assert_eq!(&record[i], row[column].as_str().unwrap());
            }
            let mean: f64 = record[3].parse().unwrap();
            assert_eq!(mean.to_bits(), row["mean"].as_f64().unwrap().to_bits());
            let std_error: f64 = record[4].parse().unwrap();
            assert!(std_error >= 0.0 && std_error == row["std_error"].as_f64().unwrap());
            let expected = if &record[1] == "fluence" && arguments == PHOTONS { 2 } else { n };
            assert_eq!(record[5].parse::<u64>().unwrap(), expected);
        }
        let quantity =
            |name: &str| -> f64 { records.iter().find(|r| &r[1] == name).unwrap()[3].parse().unwrap() };
        let sum = quantity("reflectance") + quantity("transmittance") + quantity("absorptance");
        assert!((sum - 1.0).abs() < 0.1, "{sum}");
    }
}

/// Every command of README.md and RENDERING.md that asks the simulator, once, with fewer histories.
#[test]
fn the_examples_of_the_pages_work() {
    let page = |name| std::fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let pages = page("README.md") + &page("RENDERING.md");
    let folder = Folder::new();
    let mut seen = std::collections::BTreeSet::new();
    let asked = ["cargo run --release -p turbid -- ", "turbid "];
    for line in pages.lines().filter_map(|line| asked.iter().find_map(|start| line.strip_prefix(start))) {
        let command = line.split('#').next().unwrap().trim_end();
        if !seen.insert(command) {
            continue;
        }
        let mut words: Vec<&str> = command.split_whitespace().collect();
        // Pictures become tiny, and go elsewhere.
        let is_picture = ["render", "map"].contains(&words[0]);
        let files: Vec<_> = words.iter().map(|word| folder.0.path().join(word)).collect();
        for i in 1..words.len() {
            match words[i - 1] {
                "-o" | "--ply" | "--npy" | "--photons-from" | "--state" => words[i] = text(&files[i]),
                "--maps" => words[i] = "2",
                "--seconds" => words[i] = "0.01",
                "--samples" if is_picture => words[i] = "1",
                "--photons" | "--samples" => words[i] = "1000",
                _ => {}
            }
        }
        let is_drawn = is_picture && words.contains(&"-o");
        if is_drawn {
            words.extend(["--width", "4"]);
        }
        if is_drawn && !words.contains(&"paths") {
            words.extend(["--global", "1000", "--volume", "1000"]);
        }
        if words[0] == "render" && !words.contains(&"--samples") {
            words.extend(["--samples", "1"]);
        }
        if words[0] == "advise" {
            // Pictures are looked at pixel by pixel, probes by a pilot.
            words.extend(if words.contains(&"fogbox") { ["--width", "4"] } else { ["--pilot", "1e5"] });
        }
        assert!(!succeeds(&words).is_empty(), "{line}");
    }
    assert!(seen.len() >= 3, "{seen:?}");
}

#[test]
fn one_map_has_no_standard_error() {
    let arguments = ["measure", "slab", "--with", "photons", "--photons", "1e4", "--format", "csv"];
    let csv = succeeds(&with(&arguments, &["--maps", "1"]));
    let fluence = csv.lines().find(|l| l.contains(",fluence,")).unwrap();
    assert!(fluence.contains(",,1,one-map,photons,"), "{fluence}");
}

/// By default photons are shared by independent maps, so that every row has an error, and the errors are those of the numbers:
/// the same photons in one map lie within five of them.
#[test]
fn every_row_has_an_error_by_default() {
    let arguments = ["measure", "slab", "--with", "photons", "--photons", "16e4", "--format", "csv"];
    let rows = |csv: &str| -> Vec<[f64; 3]> {
        let numbers = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            [3, 4, 5].map(|i| cells[i].parse().unwrap_or(f64::NAN))
        };
        csv.lines().skip(1).map(numbers).collect()
    };
    let by_default = rows(&succeeds(&arguments));
    let by_one = rows(&succeeds(&with(&arguments, &["--maps", "1"])));
    assert!(by_default.len() >= 7, "{by_default:?}");
    for ([mean, error, n], [other, ..]) in by_default.iter().zip(&by_one) {
        assert!(*error > 0.0 && (*n == 16.0 || *n == 16e4), "{mean} {error} {n}");
        // One map of the same photons is as noisy as sixteen together, each of whose balls holds as many as its own one: four times.
        assert!((mean - other).abs() < 5.0 * (1.0f64 + 16.0).sqrt() * error, "{mean} {error} {other}");
    }
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    for arguments in [&PATH[..], &PHOTONS[..]] {
        let all = |threads: &str, seed: &str| {
            succeeds(&with(arguments, &["--threads", threads, "--seed", seed, "--format", "csv"]))
        };
        let one = all("1", "5");
        assert_eq!(all("2", "5"), one);
        assert_eq!(all("3", "5"), one);
        assert_ne!(all("2", "6"), one);
    }
}

#[test]
fn orders_split_the_whole() {
    let reflectance = |orders: &str| -> f64 {
        let csv = succeeds(&[
            "measure",
            "slab",
            "--with",
            "photons",
            "--photons",
            "1e4",
            "--orders",
            orders,
            "--format",
            "csv",
        ]);
        csv.lines().find(|l| l.contains("reflectance")).unwrap().split(',').nth(3).unwrap().parse().unwrap()
    };
    let parts = reflectance("0") + reflectance("1") + reflectance("2..3") + reflectance("4..");
    assert!((parts - reflectance("0..")).abs() < 1e-12, "{parts}");
}

#[test]
fn scenes_are_listed_printed_and_resolved() {
    let list = succeeds(&["scenes"]);
    for name in ["slab", "sphere", "shaft"] {
        assert!(list.contains(name));
        let changed = succeeds(&["scenes", name, "--resolved", "--set", "albedo=0.125"]);
        assert!(changed.contains("albedo = 0.125"), "{changed}");
        let parameters = succeeds(&["scenes", name]);
        let table: toml::Table = toml::from_str(&parameters).unwrap();
        assert!(table.contains_key("albedo"));
        // What `--resolved` prints is a scene file that measures the same.
        let folder = Folder::new();
        let file = folder.file("scene.toml", &succeeds(&["scenes", name, "--resolved"]));
        let measure = |scene: &str| {
            succeeds(&["measure", scene, "--with", "paths", "--samples", "100", "--format", "csv"])
        };
        assert_eq!(measure(text(&file)), measure(name));
    }
}

#[test]
fn check_says_what_a_scene_requires() {
    let plan = succeeds(&["check", "slab"]);
    assert!(plan.contains("homogeneous media") && plan.contains("every path class"), "{plan}");
    assert!(succeeds(&["check", "slab", "--set", "tau=1e-8"]).contains("first collision forced"));
    assert!(succeeds(&["check", "sphere", "--set", "source=point"]).contains("equiangular"));
}

#[test]
fn help_and_version() {
    let version = succeeds(&["--version"]);
    assert!(
        version.starts_with(&format!("turbid {}", env!("CARGO_PKG_VERSION"))) && version.lines().count() == 1
    );
    for arguments in [&["--help"][..], &["measure", "--help"], &["help", "check"]] {
        assert!(succeeds(arguments).contains("Usage:"));
    }
    // The long help is there, what each part of a picture is among it.
    for (command, told) in [
        ("render", &["variance.direct.R", "Light tracing", "SCENES.md", "--with photons)"][..]),
        ("map", &["hidden", "--ply writes"]),
        ("measure", &["the standard error is that between independent maps, and one map has none"]),
    ] {
        let help = succeeds(&[command, "--help"]).split_whitespace().collect::<Vec<_>>().join(" ");
        told.iter().for_each(|words| assert!(help.contains(words), "{command}: no `{words}` in {help}"));
    }
}

/// A reader that leaves early is no error.
#[cfg(unix)]
#[test]
fn a_closed_pipe_ends_quietly() {
    for arguments in [&["scenes"][..], &["--help"], &PATH[..], &["check", "slab"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let child = Command::new(env!("CARGO_BIN_EXE_turbid"))
            .args(arguments)
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn();
        let output = child.unwrap().wait_with_output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {:?}", output.status);
        assert!(output.stderr.is_empty(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

/// A full disk is one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    for arguments in
        [&["scenes"][..], &["scenes", "slab", "--resolved"], &["--help"], &PATH[..], &["check", "slab"]]
    {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_turbid"))
            .args(arguments)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = String::new();
        child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(2), "{arguments:?}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stderr.starts_with("turbid: error: standard output: No space left"), "{stderr}");
    }
}

/// Whether whoever runs this suite has hangups, interrupts or requests to end ignored, as `nohup` and shells in the background
/// do: then the program has no last word.
#[cfg(target_os = "linux")]
fn ignores_signals() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap();
    let ignored = u64::from_str_radix(ignored.trim(), 16).unwrap();
    [1, 2, 15].iter().any(|signal| ignored >> (signal - 1) & 1 == 1)
}

/// An interrupt ends a run with one line, and with nothing half-written.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_with_a_word() {
    if ignores_signals() {
        return;
    }
    let folder = crate::Folder::new();
    let picture = folder.0.path().join("fog.exr");
    for signal in ["-INT", "-TERM"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_turbid"))
            .args([
                "render",
                "fogbox",
                "--with",
                "paths",
                "--samples",
                "1000000",
                "-o",
                crate::text(&picture),
            ])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(1500));
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        let mut stderr = String::new();
        child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}: {stderr}");
        let last = stderr.lines().last().unwrap_or_default();
        assert_eq!(last, "turbid: stopped by a signal; files appear whole or not at all", "{signal}");
        assert_eq!(std::fs::read_dir(folder.0.path()).unwrap().count(), 0, "{signal}");
    }
}

/// What could not be written, or would be written over, is refused before the work.
#[test]
fn outputs_are_tried_before_the_work() {
    let folder = crate::Folder::new();
    let at = |name: &str| crate::text(&folder.0.path().join(name)).to_string();
    let long = at(&format!("{}.exr", "x".repeat(300)));
    let many = ["render", "fogbox", "--samples", "1000000000", "-o"];
    crate::refuses_naming(&with(&many, &[&long]), &["cannot write ", "name too long"]);
    crate::refuses_naming(&with(&many, &[&at("none/a.exr")]), &["none/a.exr: No such file"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("photons.png", folder.0.path().join("link.ply")).unwrap();
        let arguments = ["map", "fogbox", "-o", &at("photons.png"), "--ply", &at("link.ply")];
        crate::refuses_naming(&arguments, &["photons.png", "link.ply lead to one file"]);
        crate::refuses_naming(&with(&many, &["/proc/a.exr"]), &["cannot write /proc/a.exr: "]);
    }
    // The cause once, wherever it is found.
    let told = crate::refuses(&with(&many, &[&at("none/a.exr")]));
    assert_eq!(told.matches("No such file").count(), 1, "{told}");
}

/// A picture into a pipe: its reader has all of it, and is not sent away by a try.
#[cfg(unix)]
#[test]
fn pictures_go_into_pipes() {
    let folder = crate::Folder::new();
    let pipe = folder.0.path().join("pipe.exr");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read(pipe).unwrap()
    });
    let small =
        ["render", "fogbox", "--with", "paths", "--width", "8", "--height", "8", "--samples", "1", "-o"];
    let output = turbid(&with(&small, &[crate::text(&pipe)])).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(&reader.join().unwrap()[..4], [0x76, 0x2f, 0x31, 0x01]);
    // Standard output by a link, which is a pipe here.
    let link = folder.0.path().join("link.exr");
    std::os::unix::fs::symlink("/dev/stdout", &link).unwrap();
    let output = turbid(&with(&small, &[crate::text(&link)])).output().unwrap();
    assert!(output.status.success() && output.stdout.starts_with(&[0x76, 0x2f, 0x31, 0x01]), "{output:?}");
    // What is shown of a name is one line.
    let odd = folder.0.path().join("a\u{1b}[31m\nb.exr");
    let output = turbid(&with(&small, &[crate::text(&odd)])).output().unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && odd.exists());
    assert!(told.contains("a\\u{1b}[31m b.exr, ") && !told.contains('\u{1b}'), "{told}");
}

/// Under-full gathers are noted on stderr, and the numbers still come.
#[test]
fn underfull_gathers_are_noted() {
    let arguments = ["measure", "slab", "--with", "photons", "--photons", "100", "--max-radius", "0.01"];
    let output = turbid(&with(&arguments, &["--maps", "1"])).output().unwrap();
    let note = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && note.contains("turbid: note: 5 of 5 estimates"), "{note}");
    assert!(note.lines().all(|line| line.starts_with("turbid: note: ")), "{note}");
}

/// The energy ledger of the photons stands beside the table, and it closes.
#[test]
fn the_ledger_is_told() {
    let arguments = ["measure", "slab", "--with", "photons", "--photons", "5000", "--orders", "0..2"];
    let output = turbid(&arguments).output().unwrap();
    let note = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && note.contains("energy ledger"), "{note}");
    assert!(note.lines().any(|line| line.ends_with("together 1.000000000000")), "{note}");
}

#[test]
fn advice_in_every_format() {
    let arguments = [
        "advise",
        "slab",
        "--set",
        "tau=6",
        "--set",
        "probes=[0.25, 0.5]",
        "--target",
        "20%",
        "--pilot",
        "1e5",
    ];
    let table = succeeds(&arguments);
    assert_eq!(
        table.lines().next().unwrap().split_whitespace().collect::<Vec<_>>(),
        ["quantity", "unit", "value", "low", "high"]
    );
    let csv = succeeds(&with(&arguments, &["--format", "csv", "--threads", "1"]));
    let rows: serde_json::Value =
        serde_json::from_str(&succeeds(&with(&arguments, &["--format", "json", "--threads", "3"]))).unwrap();
    let rows = rows.as_array().unwrap();
    assert_eq!((rows.len(), csv.lines().count(), table.lines().count()), (10, 11, 11));
    // Everything but the machine's seconds repeats on any number of threads.
    for (line, row) in csv.lines().skip(1).zip(rows) {
        assert!(line.contains(row["quantity"].as_str().unwrap().split(':').next().unwrap()));
        if row["unit"] != "s" && row["unit"] != "us" {
            let value = line.split(',').rev().nth(2).unwrap().parse::<f64>().unwrap();
            assert_eq!(value, row["value"].as_f64().unwrap(), "{line}");
        }
    }
    let error = rows.iter().find(|row| row["quantity"] == "predicted error").unwrap();
    let (low, high) = (error["low"].as_f64().unwrap(), error["high"].as_f64().unwrap());
    assert!(low < error["value"].as_f64().unwrap() && error["value"].as_f64().unwrap() < high);
}

/// Where nothing or too little was found, a word stands in the place of the error, and a note says what it means.
#[test]
fn a_mean_without_an_error_says_why() {
    let run = |arguments: &[&str]| {
        let output = turbid(arguments).output().unwrap();
        assert!(output.status.success());
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let thick = ["measure", "slab", "--set", "tau=20", "--set", "albedo=0.5", "--with", "photons"];
    let maps = ["--photons", "1e4", "--maps", "3", "--radius", "0.2"];
    let (table, notes) = run(&[&thick[..], &maps[..]].concat());
    let line = |start: &str| table.lines().find(|l| l.starts_with(start)).unwrap().to_string();
    assert!(line("depth 10").contains("0.000000e0  nothing-found"), "{table}");
    assert!(table.lines().any(|l| l.contains(" transmittance ") && !l.contains("nothing")), "{table}");
    assert!(
        notes.contains("no standard error, nothing-found:") && notes.contains("depth 10 fluence"),
        "{notes}"
    );
    let few = |samples| run(&["measure", "slab", "--with", "paths", "--samples", samples]);
    for samples in ["1", "2", "900"] {
        let (table, notes) = few(samples);
        let without = table.matches("too-few").count() + table.matches("nothing-found").count();
        assert_eq!(without, table.lines().count() - 1, "{table}");
        assert!(notes.contains("no standard error, too-few: fewer than 1000 paths"), "{notes}");
    }
    assert!(!few("5000").0.contains("too-few"));
    let (table, _) = run(&["measure", "slab", "--with", "photons", "--photons", "1e4", "--maps", "1"]);
    assert!(table.contains("one-map"), "{table}");
}
