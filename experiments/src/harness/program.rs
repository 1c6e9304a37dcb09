//! What every program of the laboratory does around its work: flags, signals, threads, one line about what stopped it.

use super::panics::guarded;
use super::progress::say;
use anyhow::Context;
use std::process::ExitCode;
use turbid::output::{end_on_signal, print};

/// Runs a program: its settings, what a signal leaves behind in words, and its work, which gives the exit code.
pub(crate) fn program<S>(
    name: &'static str,
    parse: impl FnOnce() -> Result<S, clap::Error>,
    kept: impl FnOnce(&S) -> String,
    run: impl FnOnce(&S) -> anyhow::Result<u8>,
) -> ExitCode {
    guarded(name, || {
        let settings = match parse() {
            Ok(settings) => settings,
            Err(error) if !error.use_stderr() => {
                let written = print(|out| write!(out, "{error}"));
                return ExitCode::from(if written.is_ok() { 0 } else { 2 });
            }
            Err(error) => {
                say(&one_line(&error.to_string()));
                return ExitCode::from(2);
            }
        };
        let kept = kept(&settings);
        end_on_signal(move || format!("{name}: stopped by a signal; {kept}"));
        match run(&settings) {
            Ok(code) => ExitCode::from(code),
            Err(error) => {
                say(&format!("error: {error:#}"));
                ExitCode::from(2)
            }
        }
    })
}

/// Does work on so many threads, or on all cores.
pub(crate) fn on_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    let threads = threads.map_or(0, usize::from);
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")?;
    pool.install(work)
}

/// A seed on the command line.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("allowed: whole numbers from 0 to {}", u64::MAX))
}

/// A number of threads on the command line.
pub(crate) fn threads(text: &str) -> Result<u16, String> {
    let number = text.parse().ok().filter(|number| (1..=1024).contains(number));
    number.ok_or_else(|| "allowed: whole numbers from 1 to 1024".to_string())
}

/// A message of the parser in one line, without usage and hints where to look.
pub(crate) fn one_line(text: &str) -> String {
    let parts = text.lines().map(str::trim).filter(|part| !part.is_empty());
    let parts: Vec<&str> = parts
        .take_while(|part| !part.starts_with("Usage:") && !part.starts_with("For more information"))
        .collect();
    let line = parts.join("; ").replace(":; ", ": ");
    // A bare word is taken for a file to redraw: it is more likely an experiment.
    if line.contains("--replot") && !line.contains("cannot be used") {
        return format!("{line} (one experiment alone: --only NAME; FILE.csv goes with --replot)");
    }
    line
}
