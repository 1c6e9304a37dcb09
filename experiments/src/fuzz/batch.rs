//! Inputs by the batch, in child processes that are watched from within: one that takes too long or too much memory says so
//! and ends; one that dies is known by what it said last.

use super::input::Input;
use super::judge::{Thoroughness, Verdict, Workbench, keep_panics};
use super::kind::Kind;
use crate::harness::{duration, say};
use anyhow::{Context, bail};
use cpu_time::ProcessTime;
use std::io::{BufRead, BufReader, Write};
use std::ops::Range;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use turbid::output::one_line;

/// Processor time of an input, at most.
const LIMIT: Duration = Duration::from_secs(10);

/// Memory that an input may take \[bytes\], beside so many bytes for each of its own: pictures of a tiny size and some
/// hundred photons need a few megabytes.
const MEMORY: u64 = 256 << 20;
const MEMORY_FACTOR: u64 = 256;

/// Memory at which a process ends itself \[bytes\].
const TOO_MUCH: u64 = 2 << 30;

/// Exit code of a process that was ended by a signal: `turbid::output::end_on_signal`.
const INTERRUPTED: i32 = 130;

/// What a run found.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Found {
    pub accepted: u64,
    pub refused: u64,
    /// Number of the input, and what happened.
    pub failures: Vec<(u64, String)>,
    /// Memory of a process, at most \[bytes\].
    pub peak: u64,
}

impl Found {
    /// Inputs that were tried.
    pub fn count(&self) -> u64 {
        self.accepted + self.refused + self.failures.len() as u64
    }

    fn add(&mut self, other: Found) {
        self.accepted += other.accepted;
        self.refused += other.refused;
        self.failures.extend(other.failures);
        self.peak = self.peak.max(other.peak);
    }
}

/// Inputs that a process tries before it makes room for another one.
const BATCH: u64 = 1000;

/// How often it is told how far a run is.
const TOLD: Duration = Duration::from_secs(10);

/// Tries a range of inputs in so many processes at a time. Tells failures as they come, and how far it is.
pub fn run(only: Option<Kind>, seed: u64, range: Range<u64>, jobs: usize) -> anyhow::Result<Found> {
    let (batches, start) = (AtomicU64::new(0), Instant::now());
    let state = Mutex::new((Found::default(), Instant::now()));
    let work = || -> anyhow::Result<()> {
        loop {
            let batch = batches.fetch_add(1, Ordering::Relaxed);
            let first = range.start.saturating_add(batch.saturating_mul(BATCH));
            if first >= range.end {
                return Ok(());
            }
            let found = watch(only, seed, first..first.saturating_add(BATCH).min(range.end))?;
            for (number, what) in &found.failures {
                say(&format!("input {number} of seed {seed}: {what}"));
            }
            let mut state = state.lock().map_err(|_| anyhow::anyhow!("a watcher of inputs failed"))?;
            let (all, told) = &mut *state;
            all.add(found);
            if told.elapsed() > TOLD {
                *told = Instant::now();
                let (done, count) = (all.count(), range.end - range.start);
                let left = start.elapsed().as_secs_f64() * (count - done) as f64 / done as f64;
                let failed = all.failures.len();
                say(&format!("  {done} of {count} inputs, {failed} failed, {} left", duration(left)));
            }
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| {
            thread.join().map_err(|_| anyhow::anyhow!("a watcher of inputs failed"))?
        })
    })?;
    let mut all = state.into_inner().map_err(|_| anyhow::anyhow!("a watcher of inputs failed"))?.0;
    all.failures.sort();
    Ok(all)
}

/// Has a range tried by one process, and by another one from the next input on where it ended before its time.
fn watch(only: Option<Kind>, seed: u64, range: Range<u64>) -> anyhow::Result<Found> {
    let mut found = Found::default();
    let mut next = range.start;
    while next < range.end {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(["--is-child", "--seed", &seed.to_string(), "--first", &next.to_string()]);
        command.args(["--count", &(range.end - next).to_string()]);
        command.args(only.map(|kind| ["--only", kind.name()]).into_iter().flatten());
        command.env("RAYON_NUM_THREADS", "1").stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().context("cannot start a process")?;
        let mut current = None;
        for line in BufReader::new(child.stdout.take().context("a process without output")?).lines() {
            let line = line.context("cannot read what a process says")?;
            let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
            match word {
                "at" => current = rest.parse().ok(),
                "accepted" => found.accepted += 1,
                "refused" => found.refused += 1,
                "failed" => found.failures.push((current.unwrap_or(next), rest.to_string())),
                "peak" => found.peak = found.peak.max(rest.parse().unwrap_or(0)),
                _ => {}
            }
            if matches!(word, "accepted" | "refused" | "failed") {
                next = current.unwrap_or(next) + 1;
                current = None;
            }
        }
        let status = child.wait().context("a process is lost")?;
        if status.code() == Some(INTERRUPTED) {
            // Most often the signal was for all processes, and this one is about to end by its own last word.
            std::thread::sleep(Duration::from_secs(1));
            bail!("stopped by a signal");
        }
        if let Some(died) = current {
            found.failures.push((died, format!("the process died: {status}")));
            next = died + 1;
        }
    }
    Ok(found)
}

/// Tries a range of inputs in this process and says what becomes of each.
pub fn work(only: Option<Kind>, seed: u64, range: Range<u64>) -> anyhow::Result<()> {
    keep_panics();
    let bench = Workbench::new(Thoroughness::ByTurns).context("cannot write the files that scenes name")?;
    let tried = Arc::new(AtomicU64::new(0));
    guard(Arc::clone(&tried));
    let tell = |line: String| -> std::io::Result<()> {
        let mut out = std::io::stdout().lock();
        writeln!(out, "{line}")?;
        out.flush()
    };
    let mut peak = 0;
    for number in range {
        tell(format!("at {number}"))?;
        let input = Input::of(only, seed, number);
        let (verdict, bytes) = measured(&bench, &input);
        tried.fetch_add(1, Ordering::Relaxed);
        if bytes > peak {
            peak = bytes;
            tell(format!("peak {peak}"))?;
        }
        tell(match verdict {
            Verdict::Accepted => "accepted".to_string(),
            Verdict::Refused(_) => "refused".to_string(),
            Verdict::Failed(what) => format!("failed {}", one_line(&what)),
        })?;
    }
    Ok(())
}

/// Tries an input, and says how much memory the process had at most meanwhile; more than is allowed is a failure.
fn measured(bench: &Workbench, input: &Input) -> (Verdict, u64) {
    let before = memory("VmRSS:");
    // From now on the peak is that of this input; where it cannot be reset it is that of all, and nobody is blamed.
    let is_reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
    let verdict = bench.judge(input);
    let peak = memory("VmHWM:");
    let allowed = MEMORY + MEMORY_FACTOR * input.bytes.len() as u64;
    if is_reset && !verdict.is_failure() && peak.saturating_sub(before) > allowed {
        let megabytes = (peak - before) >> 20;
        let what = format!("memory: {megabytes} MiB for {} bytes, {verdict}", input.bytes.len());
        return (Verdict::Failed(what), peak);
    }
    (verdict, peak)
}

/// A line of what Linux says of this process, in bytes; 0 elsewhere.
fn memory(name: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name));
    let number = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok());
    number.unwrap_or(0) << 10
}

/// Ends the process, with a word of it, when one input takes too long or too much.
fn guard(tried: Arc<AtomicU64>) {
    std::thread::spawn(move || {
        let mut current = tried.load(Ordering::Relaxed);
        let mut start = ProcessTime::now();
        loop {
            std::thread::sleep(Duration::from_millis(50));
            let number = tried.load(Ordering::Relaxed);
            if number != current {
                (current, start) = (number, ProcessTime::now());
            }
            let is_late = start.elapsed() > LIMIT;
            let resident = memory("VmRSS:");
            if is_late || resident > TOO_MUCH {
                let what = if is_late {
                    format!("had not ended after {LIMIT:?} of processor time")
                } else {
                    format!("memory: more than {} MiB", TOO_MUCH >> 20)
                };
                let _unheard = writeln!(std::io::stdout().lock(), "failed {what}");
                std::process::exit(3);
            }
        }
    });
}

/// Tries one input in this process, which ends if that takes too long or too much.
pub fn watched(input: &Input) -> anyhow::Result<Verdict> {
    keep_panics();
    let bench = Workbench::new(Thoroughness::All).context("cannot write the files that scenes name")?;
    guard(Arc::new(AtomicU64::new(0)));
    Ok(measured(&bench, input).0)
}

/// Tries one input in a process of its own.
pub fn alone(input: &Input) -> anyhow::Result<Verdict> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join(format!("one.{}", input.kind.ending()));
    std::fs::write(&path, &input.bytes)?;
    let output = Command::new(std::env::current_exe()?)
        .args(["--is-child", "--only", input.kind.name(), "--file"])
        .arg(&path)
        .env("RAYON_NUM_THREADS", "1")
        .stderr(Stdio::null())
        .output()
        .context("cannot start a process")?;
    let said = String::from_utf8_lossy(&output.stdout);
    let line = said.lines().last().unwrap_or_default();
    Ok(if line == "accepted" {
        Verdict::Accepted
    } else if let Some(why) = line.strip_prefix("refused: ") {
        Verdict::Refused(why.to_string())
    } else if let Some(what) = line.strip_prefix("failed: ").or(line.strip_prefix("failed ")) {
        Verdict::Failed(what.to_string())
    } else {
        Verdict::Failed(format!("the process died: {}", output.status))
    })
}
