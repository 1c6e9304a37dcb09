//! How the programs end: by a signal, or before the work where an output cannot be written.
#![allow(clippy::unwrap_used, reason = "tests")]
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const STUDY: &str = env!("CARGO_BIN_EXE_study");
const GALLERY: &str = env!("CARGO_BIN_EXE_gallery");
const SWEEP: &str = env!("CARGO_BIN_EXE_sweep");
const FUZZ: &str = env!("CARGO_BIN_EXE_fuzz");

fn started(program: &str, arguments: &[&str]) -> Child {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until something is so, at most a minute.
fn wait_until(is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Whether a process catches a signal, by its number.
#[cfg(target_os = "linux")]
fn catches(child: &Child, signal: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim();
    u64::from_str_radix(caught, 16).unwrap() & 1 << (signal - 1) != 0
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Sends a signal to a program at work, which ends with its last word and nothing else.
#[cfg(target_os = "linux")]
fn ended_by(signal: (&str, u32), child: Child) -> String {
    wait_until(|| catches(&child, signal.1));
    assert!(Command::new("kill").args([signal.0, &child.id().to_string()]).status().unwrap().success());
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let said = text(&stderr);
    assert_eq!((status.code(), text(&stdout).as_str()), (Some(130), ""), "{said}");
    assert_eq!(said.matches("stopped by a signal").count(), 1, "{said}");
    assert!(!said.contains("error"), "{said}");
    said.lines().last().unwrap().to_string()
}

const TERM: (&str, u32) = ("-TERM", 15);
const INT: (&str, u32) = ("-INT", 2);

/// Finished cells are kept, and the same command takes them.
#[cfg(target_os = "linux")]
#[test]
fn a_study_ends_with_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let child = started(STUDY, &["--only", "rates", "--threads", "1", "--out", out]);
    let cells = folder.path().join("cells/rates");
    let kept = || {
        std::fs::read_dir(&cells)
            .map_or(0, |all| all.flatten().filter(|e| e.file_name() != "predictions.csv").count())
    };
    wait_until(|| kept() > 2);
    let said = ended_by(TERM, child);
    let expected = format!(
        "study: stopped by a signal; finished cells are kept in {out}/cells, and the same command goes on from there"
    );
    assert_eq!(said, expected);
    assert!(!folder.path().join("report.html").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn the_other_programs_end_with_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    // Whoever runs the tests may ignore interrupts, as shells do for what they start in the background.
    for signal in [TERM, INT].into_iter().filter(|signal| !ignores(std::process::id(), signal.1)) {
        let said = ended_by(signal, started(GALLERY, &["--draft", "--only", "pool", "--out", out]));
        assert!(said.starts_with("gallery: stopped by a signal; finished renders are kept in "), "{said}");
        let said = ended_by(signal, started(SWEEP, &["--seeds", "0..500", "--effort", "0.02", "--out", out]));
        assert!(said.starts_with("sweep: stopped by a signal; finished scenes are kept in "), "{said}");
        let said = ended_by(
            signal,
            started(FUZZ, &["--only", "vol", "--count", "10000000", "--jobs", "1", "--out", out]),
        );
        assert!(said.starts_with("fuzz: stopped by a signal; no file is kept: "), "{said}");
    }
}

/// Whether a process ignores a signal, by its number.
#[cfg(target_os = "linux")]
fn ignores(process: u32, signal: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap().trim();
    u64::from_str_radix(ignored, 16).unwrap() & 1 << (signal - 1) != 0
}

/// Under `nohup` a study goes on when its terminal closes, and has its last word when it is asked to end.
#[cfg(target_os = "linux")]
#[test]
fn a_request_to_end_is_heard_where_a_hangup_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [STUDY, "--only", "rates", "--out", folder.path().to_str().unwrap()];
    let child = started("sh", &[&["-c", "trap '' HUP; exec \"$@\"", "sh"], &arguments[..]].concat());
    wait_until(|| catches(&child, TERM.1));
    assert!(ignores(child.id(), 1) && !catches(&child, 1));
    assert!(ended_by(TERM, child).starts_with("study: stopped by a signal; "));
}

/// The one line of a program that ends with exit code 2.
fn refused(program: &str, arguments: &[&str]) -> String {
    let output = started(program, arguments).wait_with_output().unwrap();
    let said = text(&output.stderr);
    let found = (output.status.code(), text(&output.stdout), said.lines().count());
    assert_eq!(found, (Some(2), String::new(), 1), "{arguments:?}: {said}");
    said
}

/// A folder below a file, and files that are folders: one line, before any work.
#[test]
fn outputs_are_tried_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let (file, taken) = (folder.path().join("file"), folder.path().join("taken"));
    std::fs::write(&file, b"").unwrap();
    for name in ["index.html", "report.html", "record.json"] {
        std::fs::create_dir_all(taken.join(name)).unwrap();
    }
    let below = file.join("deeper");
    let (below, taken) = (below.to_str().unwrap(), taken.to_str().unwrap());
    for (program, arguments) in [
        (STUDY, &["--only", "rates", "--out", below][..]),
        (STUDY, &["--only", "rates", "--out", taken]),
        (GALLERY, &["--draft", "--out", below]),
        (GALLERY, &["--draft", "--out", taken]),
        (SWEEP, &["--seeds", "0..1000", "--out", below]),
        (SWEEP, &["--seeds", "0..1000", "--out", taken]),
        (SWEEP, &["--seed", "1", "--effort", "100", "--out", below]),
        (FUZZ, &["--only", "vol", "--count", "10000000", "--out", below]),
        (FUZZ, &["--only", "vol", "--count", "10000000", "--out", "/proc/self/none"]),
    ] {
        let said = refused(program, arguments);
        assert!(said.contains("cannot "), "{arguments:?}: {said}");
    }
}

/// Devices, which may have no end, are not files: one line.
#[test]
fn devices_are_no_inputs() {
    for (program, arguments) in [
        (FUZZ, &["--only", "vol", "--file", "/dev/zero"][..]),
        (SWEEP, &["--scene", "/dev/zero"]),
        (STUDY, &["--replot", "/dev/zero"]),
    ] {
        let said = refused(program, arguments);
        let expected = "cannot read /dev/zero: a folder, a device or a pipe; allowed: a file\n";
        assert!(said.ends_with(expected), "{arguments:?}: {said}");
    }
}
