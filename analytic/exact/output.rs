//! Files that appear whole or not at all, and standard output, whose reader may leave early.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that is written beside its place and waits to be moved there.
pub struct Staged {
    path: PathBuf,
    content: Content,
}

enum Content {
    Beside(NamedTempFile),
    /// A device or a pipe, which cannot be replaced.
    Direct(Vec<u8>),
}

/// Writes the bytes beside `path`; nothing is seen there before [`Staged::publish`].
pub fn stage(path: &Path, bytes: Vec<u8>) -> Result<Staged> {
    try_stage(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

fn try_stage(path: &Path, bytes: Vec<u8>) -> io::Result<Staged> {
    // A link stays a link.
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    match fs::metadata(&path) {
        Ok(found) if found.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        Ok(found) if !found.is_file() => return Ok(Staged { path, content: Content::Direct(bytes) }),
        _ => {}
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // Made by std: the permissions of any new file.
    let mut file = tempfile::Builder::new()
        .prefix(".exact-")
        .suffix(".tmp")
        .make_in(folder, |path| fs::File::create_new(path))?;
    file.write_all(&bytes)?;
    file.as_file().sync_all()?;
    Ok(Staged { path, content: Content::Beside(file) })
}

impl Staged {
    /// Moves the file to its place.
    pub fn publish(self) -> Result<()> {
        let Staged { path, content } = self;
        let done = match content {
            Content::Beside(file) => file.persist(&path).map(drop).map_err(|e| e.error),
            Content::Direct(bytes) => {
                fs::OpenOptions::new().write(true).open(&path).and_then(|mut file| file.write_all(&bytes))
            }
        };
        done.with_context(|| format!("cannot write {}", path.display()))
    }
}

/// Refuses two outputs in one place, or an output in the place of what is read.
pub fn apart(paths: &[(&str, Option<&Path>)]) -> Result<()> {
    let place = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let given: Vec<_> = paths.iter().filter_map(|&(name, path)| Some((name, path?))).collect();
    for (i, (name, path)) in given.iter().enumerate() {
        for (other, other_path) in &given[..i] {
            let device = fs::metadata(path).is_ok_and(|found| !found.is_file());
            ensure!(
                device || place(path) != place(other_path),
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
