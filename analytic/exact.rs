//! `exact`: the referee's answers on the command line, each with its bound and how it is known.

#[path = "exact/answer.rs"]
mod answer;
#[path = "exact/beams.rs"]
mod beams;
#[path = "exact/boundary.rs"]
mod boundary;
#[path = "exact/cases/mod.rs"]
mod cases;
#[path = "exact/cavity.rs"]
mod cavity;
#[path = "exact/critical.rs"]
mod critical;
#[path = "exact/format.rs"]
mod format;
#[path = "exact/fresnel.rs"]
mod fresnel;
#[path = "exact/half_space.rs"]
mod half_space;
#[path = "exact/infinite.rs"]
mod infinite;
#[path = "exact/input.rs"]
mod input;
#[path = "exact/kernel.rs"]
mod kernel;
#[path = "exact/nearest.rs"]
mod nearest;
#[path = "exact/orders.rs"]
mod orders;
#[path = "exact/output.rs"]
mod output;
#[path = "exact/path.rs"]
mod path;
#[path = "exact/phase.rs"]
mod phase;
#[path = "exact/plot.rs"]
mod plot;
#[path = "exact/progressive.rs"]
mod progressive;
#[path = "exact/read.rs"]
mod read;
#[path = "exact/slab.rs"]
mod slab;
#[path = "exact/solved.rs"]
mod solved;
#[path = "exact/sphere.rs"]
mod sphere;
#[path = "exact/text.rs"]
mod text;
#[path = "exact/thick.rs"]
mod thick;
#[path = "exact/two_stream.rs"]
mod two_stream;
#[path = "exact/typed.rs"]
mod typed;
#[path = "exact/unit.rs"]
mod unit;
#[path = "exact/xy.rs"]
mod xy;

use anyhow::{Context, Result, bail, ensure};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use format::Format;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use text::{one_line, panicked};
use typed::Typed;

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

#[derive(Clone, Subcommand)]
enum Command {
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

impl Command {
    fn answer(&self, draw: bool) -> Result<answer::Reply> {
        match self {
            Command::Slab(args) => slab::answer(args, draw),
            Command::HalfSpace(args) => half_space::answer(args, draw),
            Command::Thick(args) => thick::answer(args, draw),
            Command::TwoStream(args) => two_stream::answer(args, draw),
            Command::Xy(args) => xy::answer(args, draw),
            Command::Sphere(args) => sphere::answer(args, draw),
            Command::Cavity(args) => cavity::answer(args, draw),
            Command::Critical(args) => critical::answer(args, draw),
            Command::Path(args) => path::answer(args, draw),
            Command::Infinite(args) => infinite::answer(args, draw),
            Command::Kernel(args) => kernel::answer(args, draw),
            Command::Beams(args) => beams::answer(args, draw),
            Command::Nearest(args) => nearest::answer(args, draw),
            Command::Progressive(args) => progressive::answer(args, draw),
            Command::Boundary(args) => boundary::answer(args, draw),
        }
    }

    /// What rounding does to the parameters; estimates of densities stand it well.
    fn typed(&self) -> Option<Typed> {
        Some(match self {
            Command::Slab(args) => args.typed(),
            Command::HalfSpace(args) => args.typed(),
            Command::Thick(args) => args.typed(),
            Command::TwoStream(args) => args.typed(),
            Command::Xy(args) => args.typed(),
            Command::Sphere(args) => args.typed(),
            Command::Cavity(args) => args.typed(),
            Command::Critical(args) => args.typed(),
            Command::Path(args) => args.typed(),
            Command::Infinite(args) => args.typed(),
            Command::Kernel(_)
            | Command::Beams(_)
            | Command::Nearest(_)
            | Command::Progressive(_)
            | Command::Boundary(_) => return None,
        })
    }

    /// The same question with another albedo, or other secondaries.
    fn moved(&self, to: f64) -> Self {
        let mut moved = self.clone();
        match &mut moved {
            Command::Slab(args) => args.albedo = to,
            Command::HalfSpace(args) => args.albedo = to,
            Command::Thick(args) => args.albedo = to,
            Command::TwoStream(args) => args.albedo = to,
            Command::Xy(args) => args.albedo = to,
            Command::Sphere(args) => args.albedo = to,
            Command::Cavity(args) => args.albedo = Some(to),
            Command::Critical(args) => args.secondaries = to,
            Command::Path(args) => args.albedo = Some(to),
            Command::Infinite(args) => args.albedo = to,
            Command::Kernel(_)
            | Command::Beams(_)
            | Command::Nearest(_)
            | Command::Progressive(_)
            | Command::Boundary(_) => {}
        }
        moved
    }

    /// Answers, with bounds that hold for the decimals that were typed.
    fn answer_typed(&self, draw: bool) -> Result<answer::Reply> {
        let mut reply = self.answer(draw)?;
        let Some(typed) = self.typed() else { return Ok(reply) };
        let quantities: Vec<_> = reply.answer.rows.iter().map(|row| row.quantity).collect();
        let mut values: Vec<_> = reply.answer.rows.iter_mut().map(|row| &mut row.value).collect();
        typed.widen(&mut values, |to| {
            let rows = self.moved(to).answer(false)?.answer.rows;
            let same = rows.iter().map(|row| row.quantity).eq(quantities);
            Ok(same.then(|| rows.iter().map(|row| row.value).collect()))
        })?;
        Ok(reply)
    }
}

fn run() -> Result<()> {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return explain(&error),
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
            let reply = command.answer_typed(cli.plot.is_some())?;
            format::write(&reply.answer, cli.format.unwrap_or(Format::Table), &mut bytes)?;
            if let Some(path) = &cli.plot {
                let figure = reply.figure.context("there is nothing to draw for this question")?;
                staged.push(output::stage(path, plot::encode(&figure, path)?)?);
            }
        }
        (None, None) => bail!("nothing asked; allowed: {}; more with --help", allowed()),
    }
    // Everything is written beside its place before anything appears.
    match &cli.out {
        Some(path) => staged.push(output::stage(path, bytes)?),
        None => output::print(&bytes)?,
    }
    staged.into_iter().try_for_each(output::Staged::publish)?;
    refused.map_or(Ok(()), Err)
}

/// What can be asked.
fn allowed() -> String {
    let names = Cli::command().get_subcommands().map(|c| c.get_name().to_string()).collect::<Vec<_>>();
    format!("--cases FILE.csv, {}", names.join(", "))
}

/// Help and version go to stdout; a command line that cannot be understood becomes an error of one line.
fn explain(error: &clap::Error) -> Result<()> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => output::print(text.as_bytes()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            bail!("nothing asked; allowed: {}; more with --help", allowed())
        }
        _ => bail!("{}", condensed(&text)),
    }
}

/// A message of std's number parsing, with what is allowed in its place.
fn allowed_numbers(part: &str) -> String {
    if let Some((rest, _)) = part.split_once(" is not in 0..=").and_then(|(front, _)| front.rsplit_once(": "))
    {
        return format!("{rest}; allowed: a whole number, 0 to 4294967295");
    }
    let number = [": invalid float literal", ": cannot parse float from empty string"];
    let whole = [
        ": invalid digit found in string",
        ": cannot parse integer from empty string",
        ": number too large to fit in target type",
    ];
    for (endings, allowed) in [(number.as_slice(), "a number"), (&whole, "a whole number, 0 to 4294967295")] {
        if let Some(rest) = endings.iter().find_map(|ending| part.strip_suffix(ending)) {
            return format!("{rest}; allowed: {allowed}");
        }
    }
    part.to_string()
}

/// The parts of a message of several lines, without usage and hints where to look.
fn condensed(text: &str) -> String {
    let mut line = String::new();
    for part in text.lines().map(str::trim).filter(|part| !part.is_empty()) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            break;
        }
        let part = &allowed_numbers(part.strip_prefix("error: ").unwrap_or(part));
        let part = part
            .strip_prefix("[possible values: ")
            .map_or(part.to_string(), |values| format!("allowed: {}", values.trim_end_matches(']')));
        if !line.is_empty() {
            line.push_str(if line.ends_with(':') { " " } else { "; " });
        }
        line.push_str(&part);
    }
    line
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
        assert!(said.starts_with("exact: error: internal error at analytic/exact.rs:"), "{said}");
        assert!(said.ends_with(", please report: two lines and \\u{1b}[31m colour\n"), "{said}");
    }
}
