//! The command line of the studies.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;

fn study() -> Command {
    Command::new(env!("CARGO_BIN_EXE_study"))
}

#[test]
fn bad_values_give_one_line_and_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    for bad in [
        &["--seed", "-3"][..],
        &["--photons", "0"],
        &["--photons", "inf"],
        &["--threads", "0"],
        &["--quick", "--full"],
        &["--no-such-flag"],
        &["--only", "nothing", "--out", out],
        &["--only", "rates", "--photons", "1e6", "--out", out],
    ] {
        let run = study().args(bad).assert().code(2).stdout("");
        let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(text.starts_with("error: ") && text.trim_end().lines().count() == 1, "{bad:?}: {text}");
    }
    for (bad, allowed) in [
        (["--seed", "x"], "allowed: whole numbers from 0"),
        (["--threads", "x"], "allowed: whole numbers from 1 to 1024"),
    ] {
        let run = study().args(bad).assert().code(2).stdout("");
        let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(text.contains(allowed), "{bad:?}: {text}");
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    study().arg("--help").assert().success().stderr("");
    let run = study().arg("--version").assert().success().stderr("");
    let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    assert!(text.contains("DejaVu Sans"), "{text}");
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, b"").unwrap();
    let run = study().arg("--out").arg(file.join("deeper")).assert().code(2);
    let text = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(text.starts_with("error: cannot create "), "{text}");
}
