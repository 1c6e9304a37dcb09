//! The commands, one file each, and what they share: loading scenes, counts, progress, exit codes.

mod advise;
mod check;
mod load;
mod map;
mod measure;
mod memory;
mod notes;
mod picture;
mod progress;
mod render;
mod scenes;
mod statistics;
mod usage;

pub use usage::explain;

use anyhow::Context;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Subcommand, ValueEnum};
use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use turbid::estimators::Kernel;
use turbid::output::{Format, WriteError, one_line};

/// What can be asked. The help of each is what its own file says: a word here would replace all of it.
#[derive(Subcommand)]
#[allow(missing_docs, reason = "a comment on a variant would hide the long help of its command")]
pub enum Command {
    Measure(measure::Measure),
    Advise(advise::Advise),
    Render(Box<render::Render>),
    Map(Box<map::Map>),
    Check(check::Check),
    Scenes(scenes::Scenes),
}

impl Command {
    /// Answers; what it prints goes to stdout.
    pub fn run(self) -> anyhow::Result<()> {
        match self {
            Command::Measure(command) => command.run(),
            Command::Advise(command) => command.run(),
            Command::Render(command) => command.run(),
            Command::Map(command) => command.run(),
            Command::Check(command) => command.run(),
            Command::Scenes(command) => command.run(),
        }
    }
}

/// Exit code of an outcome: 2 for an error, told in one line on stderr; a reader that closed the pipe is no error.
pub fn exit_code(program: &str, outcome: anyhow::Result<()>) -> ExitCode {
    let Err(error) = outcome else { return ExitCode::SUCCESS };
    let is_closed_pipe = error.chain().any(|cause| {
        let file = cause.downcast_ref::<WriteError>().map(|error| &error.cause);
        file.or(cause.downcast_ref()).is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
    });
    if is_closed_pipe {
        return ExitCode::SUCCESS;
    }
    // If even stderr is closed there is nobody left to tell.
    let _ = writeln!(std::io::stderr().lock(), "{program}: error: {}", one_line(&format!("{error:#}")));
    ExitCode::from(2)
}

/// Writes text to stdout.
fn print(text: &str) -> anyhow::Result<()> {
    turbid::output::print(|out| out.write_all(text.as_bytes())).context("standard output")
}

/// Forms of a table, as the command line calls them.
#[derive(Clone, Copy, ValueEnum)]
enum FormatName {
    Table,
    Csv,
    Json,
}

impl FormatName {
    fn format(self) -> Format {
        match self {
            FormatName::Table => Format::Text,
            FormatName::Csv => Format::Csv,
            FormatName::Json => Format::Json,
        }
    }
}

/// Kernels by their names.
fn kernels() -> impl TypedValueParser<Value = Kernel> {
    let names = PossibleValuesParser::new(Kernel::ALL.map(Kernel::name));
    names.try_map(|name| Kernel::named(&name).ok_or("no kernel of this name"))
}

/// Runs something on its own pool of threads: all cores unless a number is given.
fn on_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    let threads = threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    // Its message ends with its source.
    let pool = pool.map_err(|error| anyhow::anyhow!("--threads: {error}"))?;
    pool.install(work)
}

/// Tells something beside the table.
fn note(text: &str) -> std::io::Result<()> {
    writeln!(std::io::stderr().lock(), "turbid: note: {}", one_line(text))
}

/// Seconds and bytes from which on a run tells what it will take: a minute, which is worth another decision, and a gigabyte.
const TOLD_AHEAD: (f64, f64) = (60.0, 1e9);

/// Tells what a long or a large run will take, before it begins.
fn tell_ahead(what: &str, seconds: f64, bytes: f64) -> std::io::Result<()> {
    if seconds < TOLD_AHEAD.0 && bytes < TOLD_AHEAD.1 {
        return Ok(());
    }
    let (time, memory) = (progress::in_words(seconds), turbid::memory::in_words(bytes));
    note(&format!("{what}: about {time} and {memory} of memory, by a pilot"))
}

/// A count on the command line: 1000000, 1_000_000 or 1e6; at least 1.
fn parse_count(text: &str) -> Result<u64, String> {
    let plain = text.replace('_', "");
    let count = plain.parse::<u64>().ok().filter(|&n| n <= 9_000_000_000_000_000).or_else(|| {
        let x = plain.parse::<f64>().ok()?;
        // Above 2^53 not every whole number is an f64; no run is that long.
        (x.fract() == 0.0 && (0.0..=9e15).contains(&x)).then_some(x as u64)
    });
    match count {
        Some(n) if n >= 1 => Ok(n),
        _ => Err("allowed: whole numbers from 1 to 9e15, such as 1000000 or 1e6".to_string()),
    }
}
