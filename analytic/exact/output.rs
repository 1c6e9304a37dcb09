//! Files that appear whole or not at all, and standard output, whose reader may leave early.

use anyhow::{Context, Result, ensure};
use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// A file that is written beside its place and waits to be moved there.
pub struct Staged {
    /// As it was asked for.
    path: PathBuf,
    content: Content,
}

enum Content {
    /// Under another name, and where it goes.
    Beside(NamedTempFile<fs::File>, PathBuf),
    /// For what cannot be replaced.
    Direct(Vec<u8>),
}

/// How a file is written.
enum Place {
    /// A device, a pipe, or a stream that is open already: not replaced.
    Direct,
    /// Under another name first, then moved to this place.
    Renamed(PathBuf),
}

/// Whether a path is one of the streams that a program is started with, which may lead to a file that others write to.
fn is_stream(path: &Path) -> bool {
    ["/dev/stdout", "/dev/stderr"].iter().any(|stream| path == Path::new(stream))
        || ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path.starts_with(folder))
}

fn place(path: &Path) -> io::Result<Place> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")),
        Ok(found) if !found.is_file() || is_stream(path) => Ok(Place::Direct),
        // A link stays a link.
        Ok(_) => Ok(Place::Renamed(fs::canonicalize(path)?)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Place::Renamed(target(path))),
        // A name that is too long, a folder that is none, links in a circle.
        Err(error) => Err(error),
    }
}

/// Where a path leads to through symbolic links that end at nothing. The system has followed them already, so that
/// they are few.
fn target(path: &Path) -> PathBuf {
    const MOST_LINKS: usize = 40;
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let Ok(goal) = fs::read_link(&target) else { break };
        target = folder_of(&target).join(goal);
    }
    target
}

fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

const PREFIX: &str = ".exact-";
const SUFFIX: &str = ".tmp";

/// A new temporary file, which this process holds.
fn temporary(folder: &Path) -> io::Result<NamedTempFile<fs::File>> {
    // Made by std: the permissions of any new file.
    let file = tempfile::Builder::new()
        .prefix(PREFIX)
        .suffix(SUFFIX)
        .make_in(folder, |path| fs::File::create_new(path))?;
    // Where there are no locks nothing left over is removed either.
    let _unlocked = file.as_file().try_lock();
    Ok(file)
}

/// Removes temporary files of earlier runs that no process holds. One that was made just now may not be held yet.
fn remove_left_over(folder: &Path) {
    const SETTLED: Duration = Duration::from_secs(1);
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if !(name.starts_with(PREFIX) && name.ends_with(SUFFIX)) {
            continue;
        }
        let is_old = |about: fs::Metadata| about.modified().ok()?.elapsed().ok().map(|age| age > SETTLED);
        let is_old = fs::symlink_metadata(&path).ok().filter(fs::Metadata::is_file).and_then(is_old);
        if is_old == Some(true) && fs::File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) {
            let _kept = fs::remove_file(&path);
        }
    }
}

/// Names the file that was asked for.
fn named<T>(path: &Path, done: io::Result<T>) -> Result<T> {
    done.with_context(|| format!("cannot write {}", path.display()))
}

/// Tries whether a file could be written, but for the space that it takes, before the work is done that goes into it.
/// Leaves nothing behind, and removes what a killed run left. Pipes and devices are not touched: their readers would take
/// the end of the trial for the end of all.
///
/// # Errors
/// Names the file and says what the system does
pub fn check_writable(path: &Path) -> Result<()> {
    let try_it = || match place(path)? {
        Place::Direct => Ok(()),
        Place::Renamed(target) => {
            let folder = folder_of(&target);
            remove_left_over(folder);
            temporary(folder).map(drop)
        }
    };
    named(path, try_it())
}

/// Writes the bytes beside `path`; nothing is seen there before [`Staged::publish`].
///
/// # Errors
/// As [`check_writable`]
pub fn stage(path: &Path, bytes: Vec<u8>) -> Result<Staged> {
    let content = || match place(path)? {
        Place::Direct => Ok(Content::Direct(bytes)),
        Place::Renamed(target) => {
            let mut file = temporary(folder_of(&target))?;
            // As a plain file, whose errors do not name it.
            file.as_file_mut().write_all(&bytes)?;
            file.as_file().sync_all()?;
            Ok(Content::Beside(file, target))
        }
    };
    Ok(Staged { content: named(path, content())?, path: path.to_path_buf() })
}

impl Staged {
    /// Moves the file to its place.
    ///
    /// # Errors
    /// As [`check_writable`]
    pub fn publish(self) -> Result<()> {
        let Staged { path, content } = self;
        let done = match content {
            Content::Beside(file, target) => file.persist(target).map(drop).map_err(|e| e.error),
            // At the end of what a stream holds already.
            Content::Direct(bytes) => {
                fs::OpenOptions::new().append(true).open(&path).and_then(|mut file| file.write_all(&bytes))
            }
        };
        named(&path, done)
    }
}

/// Refuses two outputs in one place, or an output in the place of what is read.
pub fn apart(paths: &[(&str, Option<&Path>)]) -> Result<()> {
    let whole = |path: &Path| -> (PathBuf, Option<OsString>) {
        let target = target(path);
        let target = fs::canonicalize(&target).unwrap_or(target);
        let folder = folder_of(&target);
        let name = target.file_name().map(|name| name.to_os_string());
        (fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf()), name)
    };
    let given: Vec<_> = paths.iter().filter_map(|&(name, path)| Some((name, path?))).collect();
    for (i, (name, path)) in given.iter().enumerate() {
        for (other, other_path) in &given[..i] {
            let device = fs::metadata(path).is_ok_and(|found| !found.is_file());
            ensure!(
                device || whole(path) != whole(other_path),
                "{name} is {}, which is {other} too; allowed: another file",
                path.display()
            );
        }
    }
    Ok(())
}

/// Writes to standard output; a reader that has left is no error.
pub fn print(bytes: &[u8]) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        done => done.context("cannot write to standard output"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a run left that was killed while it wrote; what another one is writing stays.
    #[test]
    fn what_was_left_over_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let names = [".exact-dead.tmp", ".exact-held.tmp", ".exact-new.tmp", ".exact-mine", "mine.tmp"];
        let [dead, held, new, mine, other] = names.map(|name| folder.path().join(name));
        for path in [&dead, &held, &new, &mine, &other] {
            fs::write(path, b"x").unwrap();
        }
        let old = std::time::SystemTime::now() - Duration::from_secs(100);
        for path in [&dead, &held, &mine, &other] {
            fs::File::options().write(true).open(path).unwrap().set_modified(old).unwrap();
        }
        let file = fs::File::open(&held).unwrap();
        file.lock().unwrap();
        check_writable(&folder.path().join("a.csv")).unwrap();
        assert_eq!(
            [&dead, &held, &new, &mine, &other].map(|path| path.exists()),
            [false, true, true, true, true]
        );
    }
}
