//! Inputs by chance through the program itself: processes that are guarded, and command lines.
#![allow(clippy::unwrap_used, reason = "tests")]

mod program;

use assert_cmd::Command;

fn fuzz(arguments: &[&str]) -> String {
    // The program whose command lines are tried is there, and is that of these sources.
    program::turbid().arg("--version").assert().success();
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_fuzz"));
    let run = command.args(arguments).arg("--out").arg(folder.path()).assert().success().stderr("");
    String::from_utf8(run.get_output().stdout.clone()).unwrap()
}

/// How many inputs a run accepted and refused.
fn counts(said: &str) -> (u64, u64) {
    let number = |word: &str| {
        let before = said.split_once(&format!(" {word}")).unwrap().0;
        before.rsplit(' ').next().unwrap().parse().unwrap()
    };
    (number("accepted"), number("refused"))
}

/// All kinds by turns, each within its time and memory.
#[test]
fn a_few_inputs_of_all_kinds() {
    let said = fuzz(&["--count", "200", "--seed", "2", "--jobs", "2"]);
    let (accepted, refused) = counts(&said);
    assert!(accepted + refused == 200 && accepted > 20 && refused > 20, "{said}");
}

/// Command lines: the program does what it is asked, or refuses in a line that a terminal only shows.
#[test]
fn a_few_command_lines() {
    let said = fuzz(&["--only", "arguments", "--count", "60", "--seed", "2", "--jobs", "2"]);
    let (accepted, refused) = counts(&said);
    assert!(accepted + refused == 60 && accepted > 5 && refused > 5, "{said}");
}
