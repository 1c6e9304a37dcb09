//! `exact`: the referee's answers on the command line, each with its bound and how it is known.

mod answer;
mod beams;
mod boundary;
mod cases;
mod cavity;
mod critical;
mod format;
mod fresnel;
mod half_space;
mod infinite;
mod input;
mod kernel;
mod nearest;
mod output;
mod path;
mod phase;
mod plot;
mod progressive;
mod question;
mod read;
mod slab;
mod sphere;
mod text;
mod thick;
mod two_stream;
mod typed;
mod unit;
mod usage;
mod xy;

use anyhow::{Result, bail, ensure};
use clap::{Parser, Subcommand};
use format::Format;
use question::{Question, Solved, ask};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use text::{one_line, panicked};

/// Exact values of light transport in fog, water and smoke, each with an absolute error bound.
///
/// Lengths are mean free paths. A slab 0 <= t <= tau has its lit face at t = 0, which receives unit irradiance:
/// fractions and fluences are dimensionless, radiances are per steradian. A cosine mu > 0 points up, towards the lit
/// face. Every value comes with a unit (`mfp` a mean free path, 1 a pure number), a bound on its error, and how it is known; a
/// question outside the range in which the answer is known is refused. Bounds hold for decimals as typed, whose rounding to
/// double precision they count: where w is near 1, that is most of them. Each command's --help states its equation, units,
/// ranges and sources.
#[derive(Parser)]
#[command(name = "exact", version, arg_required_else_help = true, verbatim_doc_comment)]
struct Cli {
    /// Answer a table of cases: CSV with the columns
    /// id,geometry,tau,a,w,g,n,mu0,t,r,mu,dphi,extra,quantity; others are ignored. Gives id, value, error, method, note
    /// and the parameters; a row that is not answered here has an empty value and a note saying why. A file of up to
    /// 16 MiB, no pipe; control characters in its cells are spelt out
    #[arg(verbatim_doc_comment, long, value_name = "FILE.csv")]
    cases: Option<PathBuf>,
    /// Form of the output: a table for eyes, which shows digits as far as they are certain (four at least), or every bit
    /// as CSV or JSON. Without it a table, and CSV for --cases
    #[arg(verbatim_doc_comment, long, global = true, value_enum, help_heading = "Output")]
    format: Option<Format>,
    /// Write to this file, which appears whole or not at all, in place of standard output. Before all is answered nothing
    /// is written: a run that is ended leaves the old file
    #[arg(verbatim_doc_comment, long, global = true, help_heading = "Output", value_name = "FILE")]
    out: Option<PathBuf>,
    /// Draw the field to this file as well.
    #[arg(long, global = true, help_heading = "Output", value_name = "FILE.svg|FILE.png")]
    plot: Option<PathBuf>,
    #[command(subcommand)]
    command: Option<Command>,
}

/// The commands in the order of the help, each with the arguments that are its question.
macro_rules! commands {
    ($($name:ident($arguments:ty)),* $(,)?) => {
        #[derive(Subcommand)]
        enum Command {
            $($name($arguments)),*
        }

        impl Command {
            fn question(&self) -> &dyn Question {
                match self {
                    $(Command::$name(question) => question),*
                }
            }
        }
    };
}

commands! {
    Slab(slab::Args),
    HalfSpace(half_space::Args),
    Thick(thick::Args),
    TwoStream(two_stream::Args),
    Xy(xy::Args),
    Sphere(sphere::Args),
    Cavity(cavity::Args),
    Critical(critical::Args),
    Path(path::Args),
    Infinite(infinite::Args),
    Kernel(kernel::Args),
    Beams(beams::Args),
    Nearest(nearest::Args),
    Progressive(progressive::Args),
    Boundary(boundary::Args),
}

fn run() -> Result<()> {
    let cli = match Cli::try_parse() {
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

fn main() -> ExitCode {
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
            .args(["--exact", "--nocapture", "tests::a_panic_is_one_line_and_code_2"])
            .env(CHILD, "")
            .env("RUST_BACKTRACE", "1")
            .output()
            .unwrap();
        let said = String::from_utf8(child.stderr).unwrap();
        assert_eq!((child.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.starts_with("exact: error: internal error at analytic/exact/main.rs:"), "{said}");
        assert!(said.ends_with(", please report: two lines and \\u{1b}[31m colour\n"), "{said}");
    }
}
