//! What the commands share: what they print, names and counts on the command line, threads.

use super::progress;
use super::quiet::is_quiet;
use anyhow::Context;
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::io::Write;
use std::ops::RangeInclusive;
use turbid::estimators::Kernel;
use turbid::output::{Format, one_line};

/// Writes text to stdout.
pub fn print(text: &str) -> anyhow::Result<()> {
    turbid::output::print(|out| out.write_all(text.as_bytes())).context("standard output")
}

/// Forms of a table, as the command line calls them.
#[derive(Clone, Copy, ValueEnum)]
pub enum FormatName {
    Table,
    Csv,
    Json,
}

impl FormatName {
    pub fn format(self) -> Format {
        match self {
            FormatName::Table => Format::Text,
            FormatName::Csv => Format::Csv,
            FormatName::Json => Format::Json,
        }
    }
}

/// Kernels by their names.
pub fn kernels() -> impl TypedValueParser<Value = Kernel> {
    let names = PossibleValuesParser::new(Kernel::ALL.map(Kernel::name));
    names.try_map(|name| Kernel::named(&name).ok_or("no kernel of this name"))
}

/// Runs something on its own pool of threads: all cores unless a number is given.
pub fn on_threads<T: Send>(
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
pub fn note(text: &str) -> std::io::Result<()> {
    if is_quiet() {
        return Ok(());
    }
    writeln!(std::io::stderr().lock(), "turbid: note: {}", one_line(text))
}

/// Seconds and bytes from which on a run tells what it will take: a minute, which is worth another decision, and a gigabyte.
const TOLD_AHEAD: (f64, f64) = (60.0, 1e9);

/// Tells what a long or a large run will take, before it begins.
pub fn tell_ahead(what: &str, seconds: f64, bytes: f64) -> std::io::Result<()> {
    if seconds < TOLD_AHEAD.0 && bytes < TOLD_AHEAD.1 {
        return Ok(());
    }
    let (time, memory) = (progress::in_words(seconds), turbid::memory::in_words(bytes));
    note(&format!("{what}: about {time} and {memory} of memory, by a pilot"))
}

/// Whole numbers on the command line: 1000000, 1_000_000 or 1e6.
fn parse_whole(text: &str) -> Option<u64> {
    let plain = text.replace('_', "");
    plain.parse::<u64>().ok().or_else(|| {
        let x = plain.parse::<f64>().ok()?;
        // Above 2^53 not every whole number is an f64; no run is that long.
        (x.fract() == 0.0 && (0.0..=9e15).contains(&x)).then_some(x as u64)
    })
}

/// A count on the command line, at least 1.
pub fn parse_count(text: &str) -> Result<u64, String> {
    let count = parse_whole(text).filter(|n| (1..=9_000_000_000_000_000).contains(n));
    count.ok_or_else(|| "allowed: whole numbers from 1 to 9e15, such as 1000000 or 1e6".to_string())
}

/// A whole number of a range on the command line.
pub fn whole<T: TryFrom<u64> + Clone + Send + Sync + 'static>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = parse_whole(text).filter(|n| range.contains(n)).and_then(|n| T::try_from(n).ok());
        number.ok_or_else(|| format!("allowed: whole numbers from {} to {}", range.start(), range.end()))
    }
}
