//! Tells the program `turbid` where git keeps the revision that it is built from: in the log of HEAD, which the program includes, so
//! that a new revision builds it alone again, and not the library. `TURBID_REVISION` says another one, for packages without git.

use std::io::{Error, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() -> std::io::Result<()> {
    let variable = |name: &str| std::env::var(name).map_err(Error::other);
    let sources = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let given = std::env::var("TURBID_REVISION").ok();
    let log = match given.as_ref().map_or_else(|| log_of_head(&sources), |_| None) {
        Some(log) => log,
        None => {
            let log = Path::new(&variable("OUT_DIR")?).join("revision");
            std::fs::write(&log, given.map_or_else(String::new, |revision| format!("- {revision}\n")))?;
            log
        }
    };
    let mut out = std::io::stdout().lock();
    writeln!(out, "cargo::rerun-if-changed=build.rs")?;
    writeln!(out, "cargo::rerun-if-env-changed=TURBID_REVISION")?;
    // A log that is gone is looked for again. HEAD itself changes with the branch, and not with each revision.
    if let Some(head) = log.ancestors().nth(2).map(|git| git.join("HEAD")).filter(|head| head.exists()) {
        writeln!(out, "cargo::rerun-if-changed={}", head.display())?;
    }
    writeln!(out, "cargo::rustc-env=TURBID_SOURCES={}", sources.display())?;
    writeln!(out, "cargo::rustc-env=TURBID_LOG={}", log.display())
}

/// Where git logs what HEAD has been, if this folder is the top of a work tree and git does.
fn log_of_head(sources: &Path) -> Option<PathBuf> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(sources).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8(output.stdout).ok()).flatten()
    };
    let top = std::fs::canonicalize(git(&["rev-parse", "--show-toplevel"])?.trim()).ok()?;
    (top == std::fs::canonicalize(sources).ok()?).then_some(())?;
    let log =
        std::fs::canonicalize(sources.join(git(&["rev-parse", "--git-path", "logs/HEAD"])?.trim())).ok()?;
    std::fs::metadata(&log).is_ok_and(|log| log.len() > 0).then_some(log)
}
