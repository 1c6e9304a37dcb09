//! Where a result comes from: program, settings, machine. No host name, user or absolute path.

use super::Settings;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// The version of the tables beside it: 2 since fractions are no longer in per cent, and parameters are columns.
pub const FORMAT: u32 = 2;

fn first_format() -> u32 {
    1
}

/// The circumstances of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the tables; 1 where it is not stated.
    #[serde(default = "first_format")]
    pub format: u32,
    /// Name of the study.
    pub study: String,
    /// The command that repeats it.
    pub command: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// What the cells depend on, in words.
    pub settings: String,
    /// Version of the package.
    pub version: String,
    /// Revision of the sources, with `-dirty` if they were changed since.
    pub revision: String,
    /// Digest of the program's bytes.
    pub program: String,
    /// Compiler.
    pub rustc: String,
    /// Processor.
    pub cpu: String,
    /// Logical cores.
    pub cores: usize,
    /// Memory, in GiB.
    pub memory_gib: f64,
    /// Operating system.
    pub system: String,
    /// Threads that measured.
    pub threads: usize,
    /// When the measurement ended, UTC.
    pub date: String,
    /// Cells in the study.
    pub cells: usize,
    /// Cells measured in the last run; the others were there already.
    pub measured: usize,
    /// Cells made by another build and taken because of `--reuse-cells`.
    pub foreign: usize,
    /// CPU seconds of all cells.
    pub cpu_seconds: f64,
    /// Wall-clock seconds of the last run's measurement.
    pub wall_seconds: f64,
    /// Whether predictions changed although cells were already measured.
    pub late_predictions: bool,
}

impl Provenance {
    /// The circumstances of this run; the counts are for the caller to fill in.
    pub(super) fn now(study: &str, settings: &Settings, program: &str) -> Self {
        Provenance {
            format: FORMAT,
            study: study.to_string(),
            command: settings.command(study),
            seed: settings.seed,
            settings: settings.words(),
            version: env!("CARGO_PKG_VERSION").to_string(),
            revision: revision().unwrap_or_else(unknown),
            program: program.to_string(),
            rustc: env!("TURBID_RUSTC").to_string(),
            cpu: field("/proc/cpuinfo", "model name").unwrap_or_else(unknown),
            cores: std::thread::available_parallelism().map_or(0, usize::from),
            memory_gib: memory_gib().unwrap_or(0.0),
            system: system(),
            threads: settings.threads,
            date: utc(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs())),
            cells: 0,
            measured: 0,
            foreign: 0,
            cpu_seconds: 0.0,
            wall_seconds: 0.0,
            late_predictions: false,
        }
    }
}

fn unknown() -> String {
    "unknown".to_string()
}

/// `key : value` or `key=value` in a file of such lines.
fn field(path: &str, key: &str) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let (_, value) = line.split_once([':', '='])?;
    Some(value.trim().trim_matches('"').to_string())
}

fn memory_gib() -> Option<f64> {
    let kib: f64 = field("/proc/meminfo", "MemTotal")?.split(' ').next()?.parse().ok()?;
    Some((kib / 1024.0 / 1024.0 * 10.0).round() / 10.0)
}

fn system() -> String {
    let name = field("/etc/os-release", "PRETTY_NAME").unwrap_or_else(|| std::env::consts::OS.to_string());
    let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    format!("{name} {} {}", kernel.trim(), std::env::consts::ARCH).replace("  ", " ")
}

/// Revision of the folder that the program was built from, if git is there and the folder is a work tree's own.
fn revision() -> Option<String> {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    let git = |args: &[&str]| {
        let output = Command::new("git").arg("-C").arg(sources).args(args).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_string())
    };
    let top = std::fs::canonicalize(git(&["rev-parse", "--show-toplevel"])?).ok()?;
    (top == std::fs::canonicalize(sources).ok()?).then_some(())?;
    git(&["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"])
}

/// Date and time of seconds since 1970, proleptic Gregorian.
///
/// # Source
/// Hinnant 2013, "chrono-compatible low-level date algorithms": days counted from March in eras of 400 years.
fn utc(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * march_month + 2) / 5 + 1;
    let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02} UTC", rest / 3600, rest / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `date -u -d @SECONDS`.
    #[test]
    fn dates() {
        assert_eq!(utc(0), "1970-01-01 00:00 UTC");
        assert_eq!(utc(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(utc(1_735_689_599), "2024-12-31 23:59 UTC");
        assert_eq!(utc(4_107_542_400), "2100-03-01 00:00 UTC");
    }

    #[test]
    fn nothing_private_is_kept() {
        let provenance = Provenance::now("study", &Settings::new("/home/somebody/out"), "00");
        let text = serde_json::to_string(&provenance).unwrap();
        assert!(!text.contains("/home") && !text.contains(env!("CARGO_MANIFEST_DIR")), "{text}");
        for key in ["/etc/hostname", "/proc/sys/kernel/hostname"] {
            let host = std::fs::read_to_string(key).unwrap_or_default();
            assert!(host.trim().len() < 4 || !text.contains(host.trim()));
        }
    }
}
