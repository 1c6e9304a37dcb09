//! Inputs by chance: scenes and files that nobody would write, and whether each is refused in one line or does what it says.
//!
//! An input is a function of its kind, the seed and its number (`input`): seeds are changed a few times, scenes as trees of
//! keys (`tree`), other files byte by byte. It is then tried (`judge`). The trying is done by child processes, a range of
//! numbers each, that say which input comes next; one that takes too long, too much memory, or the process with it, is known
//! by that (`batch`). Failures are made smaller (`shrink`) and kept as files.

mod batch;
mod input;
mod judge;
mod kind;
mod seeds;
mod shrink;
#[cfg(test)]
mod tests;
mod tree;

pub use input::Input;
pub use judge::{Thoroughness, Verdict, Workbench};
pub use kind::Kind;

use crate::harness::{check_later, guarded, one_line, say};
use anyhow::{Context, bail};
use batch::Found;
use clap::Parser;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use turbid::output::{end_on_signal, print};

/// Tries inputs by chance: each is refused in one line, or does what it says.
///
/// The same seed tries the same inputs. Failures are written to the folder `--out`, a scene made smaller as long as it fails.
#[derive(Parser)]
#[command(name = "fuzz", version)]
struct Arguments {
    /// How many inputs.
    #[arg(long, default_value_t = 10_000)]
    count: u64,
    /// Seed: the same seed tries the same inputs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One kind of input alone [default: all by turns, scenes most often].
    #[arg(long, value_enum)]
    only: Option<Kind>,
    /// Number of the first input.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Processes at work at one time [default: one a core].
    #[arg(long)]
    jobs: Option<usize>,
    /// Try one file, and say what became of it; its kind is that of its name, or `--only`.
    #[arg(long)]
    file: Option<PathBuf>,
    /// Folder of the failures.
    #[arg(long, default_value = "results/local/fuzz")]
    out: PathBuf,
    /// Try the inputs in this process, and tell the one that asked.
    #[arg(long, hide = true)]
    is_child: bool,
}

/// The program `fuzz`: 0 if nothing failed, 1 if something did, 2 for an error.
pub fn main() -> ExitCode {
    guarded("fuzz", unguarded)
}

fn unguarded() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if !error.use_stderr() => {
            let written = print(|out| write!(out, "{error}"));
            return ExitCode::from(if written.is_ok() { 0 } else { 2 });
        }
        Err(error) => {
            say(&format!("fuzz: error: {}", one_line(&error.to_string())));
            return ExitCode::from(2);
        }
    };
    end_on_signal(|| {
        "fuzz: stopped by a signal; no file is kept: --seed, --first and --count try again what failed"
            .to_string()
    });
    match run(&arguments) {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            say(&format!("fuzz: error: {error:#}"));
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let Arguments { count, seed, only, first, .. } = *arguments;
    if let Some(file) = &arguments.file {
        return one_file(file, only, arguments.is_child);
    }
    let range = first..first.saturating_add(count);
    if arguments.is_child {
        batch::work(only, seed, range)?;
        return Ok(0);
    }
    let jobs = match arguments.jobs {
        Some(0) => bail!("--jobs is 0; allowed: at least 1"),
        Some(jobs) => jobs,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    check_later(&arguments.out)?;
    let missing = "the program turbid is not beside this one";
    match only {
        _ if judge::program().is_some() => {}
        Some(Kind::Arguments) => bail!("{missing}; allowed: cargo build --release, then the same again"),
        None => say(&format!(
            "fuzz: note: {missing}, so that it is tried by no command line: cargo build --release"
        )),
        Some(_) => {}
    }
    let found = batch::run(only, seed, range, jobs)?;
    report(arguments, &found)
}

/// Larger files are not tried.
const MOST_BYTES: u64 = 1 << 28;

/// Tries one file.
fn one_file(file: &Path, only: Option<Kind>, is_child: bool) -> anyhow::Result<u8> {
    let name = file.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let Some(kind) = only.or_else(|| Kind::of_file(name)) else {
        bail!("{}: of no kind that its name tells; name it with --only", file.display());
    };
    let bytes =
        turbid::input::read(file, MOST_BYTES).with_context(|| format!("cannot read {}", file.display()))?;
    let input = Input { kind, bytes };
    let verdict = if is_child { batch::watched(&input)? } else { batch::alone(&input)? };
    print(|out| writeln!(out, "{verdict}")).context("standard output")?;
    Ok(u8::from(verdict.is_failure()))
}

/// Failures that were told and kept of each sort; of more, their number is enough.
const KEPT: usize = 3;

/// Keeps failures as files and tells what was found.
fn report(arguments: &Arguments, found: &Found) -> anyhow::Result<u8> {
    let mut sorts: BTreeMap<String, Vec<&(u64, String)>> = BTreeMap::new();
    for failure in &found.failures {
        sorts.entry(shrink::sort(&failure.1)).or_default().push(failure);
    }
    let mut lines = Vec::new();
    for (sort, failures) in &sorts {
        lines.push(format!("{} x {sort}", failures.len()));
        for (number, what) in failures.iter().take(KEPT) {
            let input = Input::of(arguments.only, arguments.seed, *number);
            let small = shrink::shrink(&input, sort)?;
            std::fs::create_dir_all(&arguments.out)
                .with_context(|| format!("cannot create {}", arguments.out.display()))?;
            let name = format!("{}-{}-{number}.{}", arguments.seed, small.kind.name(), small.kind.ending());
            let path = arguments.out.join(name);
            std::fs::write(&path, &small.bytes)
                .with_context(|| format!("cannot write {}", path.display()))?;
            let only = small.kind.name();
            lines.push(format!("    {number}: {what}"));
            lines.push(format!(
                "    cargo run --release --bin fuzz -- --only {only} --file {}",
                path.display()
            ));
        }
    }
    let Found { accepted, refused, failures, peak } = found;
    lines.push(format!(
        "{} inputs, seed {}: {accepted} accepted, {refused} refused, {} failed; {} MB at most in a process",
        found.count(),
        arguments.seed,
        failures.len(),
        peak / 1_000_000
    ));
    print(|out| lines.iter().try_for_each(|line| writeln!(out, "{line}"))).context("standard output")?;
    Ok(u8::from(!failures.is_empty()))
}
