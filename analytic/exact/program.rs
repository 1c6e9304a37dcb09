//! The program: the command line read, asked, written; its one line of an error.

use crate::command::Cli;
use crate::format::Format;
use crate::question::{Solved, ask};
use crate::text::{one_line, panicked};
use crate::{cases, format, output, plot, usage};
use anyhow::{Result, bail, ensure};
use clap::Parser;
use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

/// The words of a command line, lists of numbers that begin with a negative one taken apart, and `-.5` as -0.5: `-1,2` alone would be an option
/// that is not there.
fn taken_apart(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let whole =
        |number: &str| number.strip_prefix("-.").map_or(number.into(), |rest| format!("-0.{rest}").into());
    let is_number = |part: &str| part.parse::<f64>().is_ok_and(f64::is_finite);
    let parts = |word: OsString| match word.to_str() {
        Some(list) if list.starts_with('-') && list.split(',').all(is_number) => {
            list.split(',').map(whole).collect()
        }
        _ => vec![word],
    };
    words.flat_map(parts).collect()
}

fn run() -> Result<()> {
    let cli = match Cli::try_parse_from(taken_apart(std::env::args_os())) {
        Ok(cli) => cli,
        Err(error) => return usage::explain(&error),
    };
    let paths =
        [("--cases", cli.cases.as_deref()), ("--out", cli.out.as_deref()), ("--plot", cli.plot.as_deref())];
    output::apart(&paths)?;
    if let Some(path) = &cli.plot {
        plot::check(path)?;
    }
    // Before the work, which may be long.
    for path in [&cli.out, &cli.plot].into_iter().flatten() {
        output::check_writable(path)?;
    }
    let mut bytes = Vec::new();
    let mut staged = Vec::new();
    let mut refused = None;
    match (&cli.cases, &cli.command) {
        (Some(_), Some(_)) => bail!("--cases stands alone: give it or a command, not both"),
        (Some(path), None) => {
            ensure!(cli.plot.is_none(), "--plot draws the answer to one question; allowed: without --cases");
            refused = cases::answer(path, cli.format.unwrap_or(Format::Csv), &mut bytes)?;
        }
        (None, Some(command)) => {
            let (question, solved) = (command.question(), Solved::default());
            let answer = ask(question, None, &solved)?;
            format::write(&answer, cli.format.unwrap_or(Format::Table), &mut bytes)?;
            if let Some(path) = &cli.plot {
                staged.push(output::stage(path, plot::encode(&question.figure(&solved)?, path)?)?);
            }
        }
        (None, None) => bail!("nothing asked; allowed: {}; more with --help", usage::allowed()),
    }
    // Everything is written beside its place before anything appears.
    match &cli.out {
        Some(path) => staged.push(output::stage(path, bytes)?),
        None => output::print(&bytes)?,
    }
    staged.into_iter().try_for_each(output::Staged::publish)?;
    refused.map_or(Ok(()), Err)
}

/// Says an error in one line.
fn say(error: &str) {
    // If stderr is closed too, the exit code is all that is left to say.
    let _ = writeln!(io::stderr().lock(), "exact: error: {}", one_line(error));
}

/// Exit code of a run: 2 for an error, told in one line on stderr, a panic among them.
fn exit_code(run: fn() -> Result<()>) -> u8 {
    std::panic::set_hook(Box::new(|info| say(&panicked(info))));
    match std::panic::catch_unwind(run) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            say(&format!("{error:#}"));
            2
        }
        // The hook has said it.
        Err(_) => 2,
    }
}

/// Reads the command line of the process and answers it: 0, or 2 for an error, told in one line on stderr.
pub fn main() -> ExitCode {
    ExitCode::from(exit_code(run))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a process of its own, this test again: the hook is one for all tests.
    #[test]
    fn a_panic_is_one_line_and_code_2() {
        const CHILD: &str = "EXACT_TEST_PANICS";
        if std::env::var_os(CHILD).is_some() {
            std::process::exit(i32::from(exit_code(|| panic!("two\nlines and \u{1b}[31m colour"))));
        }
        let child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "--nocapture", "program::tests::a_panic_is_one_line_and_code_2"])
            .env(CHILD, "")
            .env("RUST_BACKTRACE", "1")
            .output()
            .unwrap();
        let said = String::from_utf8(child.stderr).unwrap();
        assert_eq!((child.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.starts_with("exact: error: internal error at analytic/exact/program.rs:"), "{said}");
        assert!(said.ends_with(", please report: two lines and \\u{1b}[31m colour\n"), "{said}");
    }
}
