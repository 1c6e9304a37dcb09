//! One study at a time in a folder.

use super::outputs::check_plain;
use super::{Share, Watch};
use anyhow::{Context, bail};
use std::fs::{File, TryLockError};
use std::path::Path;

/// The lock's file; it stays when the study ends, and says nothing by itself.
const FILE: &str = ".lock";

/// The file of the lock of a part: parts work in one folder at once, each of them once.
fn file(part: Option<Share>) -> String {
    part.map_or_else(|| FILE.to_string(), |part| format!("{FILE}-{}-of-{}", part.number, part.of))
}

/// A folder that is held.
pub(super) struct Held(File);

impl Drop for Held {
    /// A process that is being started has a copy of the file until it runs, which would hold the folder on: closing is
    /// not enough.
    fn drop(&mut self) {
        // What cannot be unlocked was not locked.
        let _unlocked = self.0.unlock();
    }
}

/// Holds a folder, which is made if it is not there, until the value is dropped or the process ends in whatever way.
///
/// # Errors
/// If another study holds it, or the folder cannot be written to
pub(super) fn hold(folder: &Path, part: Option<Share>, watch: &dyn Watch) -> anyhow::Result<Held> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let path = folder.join(file(part));
    check_plain(&path)?;
    let file = File::create(&path).with_context(|| format!("cannot write {}", path.display()))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            bail!(
                "another study is at work in {}; allowed: wait for its end, or name another --out",
                folder.display()
            )
        }
        // Some network drives have no locks.
        Err(TryLockError::Error(error)) => watch.say(&format!(
            "{} cannot be locked ({error}): start no second study there before this one ends.",
            folder.display()
        )),
    }
    Ok(Held(file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::Terminal;

    /// As a process that another thread starts just then has one.
    #[test]
    fn a_copy_of_the_file_holds_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let hold = |folder: &Path| hold(folder, None, &Terminal::default());
        let held = hold(folder.path()).unwrap();
        assert!(hold(folder.path()).is_err());
        let _copy = held.0.try_clone().unwrap();
        drop(held);
        assert!(hold(folder.path()).is_ok());
    }
}
