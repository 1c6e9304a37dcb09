//! Files that appear whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written: which, and why.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file that was wanted.
    pub path: PathBuf,
    /// What stopped it.
    #[source]
    pub cause: io::Error,
}

/// Writes a file through `write`, so that its path holds either the old content or all of the new.
///
/// The content goes to a temporary file in the same folder, is brought to the disk, and is then renamed. The
/// permissions are those of any new file (0o666 minus the mask). A symbolic link keeps pointing where it did; a
/// path that is no regular file, such as a device or a pipe, is written directly.
///
/// # Errors
/// [`WriteError`] if the folder does not exist or cannot be written to, the disk is full, or `write` fails; the
/// old file is then untouched and nothing is left behind.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    try_write(path, write).map_err(|cause| WriteError { path: path.to_path_buf(), cause: bare(cause) })
}

/// The system's own error, without the name of the temporary file in which it happened.
fn bare(error: io::Error) -> io::Error {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(&error);
    while let Some(inner) = cause {
        if let Some(code) = inner.downcast_ref::<io::Error>().and_then(io::Error::raw_os_error) {
            return io::Error::from_raw_os_error(code);
        }
        cause = inner.source();
    }
    error
}

fn try_write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        Ok(found) if !found.is_file() => {
            let mut file = BufWriter::new(fs::OpenOptions::new().write(true).open(&target)?);
            write(&mut file)?;
            return file.flush();
        }
        _ => {}
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // Made by std: permissions of any new file, and errors that do not name the temporary file.
    let temporary = tempfile::Builder::new()
        .prefix(".turbid-")
        .suffix(".tmp")
        .make_in(folder, |path| fs::File::create_new(path))?;
    let mut buffered = BufWriter::new(temporary);
    write(&mut buffered)?;
    let temporary = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
    temporary.as_file().sync_all()?;
    temporary.persist(&target).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_appears_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_atomically(&path, |w| w.write_all(b"one")).unwrap();
        write_atomically(&path, |w| w.write_all(b"two")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// What a temporary file adds to the system's errors, its own name, is taken off again.
    #[test]
    fn the_temporary_file_is_not_named() {
        #[derive(Debug, thiserror::Error)]
        #[error("{cause} at path \"/tmp/.turbid-x.tmp\"")]
        struct At {
            #[source]
            cause: io::Error,
        }
        let full = || io::Error::from_raw_os_error(28);
        for error in [full(), io::Error::new(io::ErrorKind::StorageFull, At { cause: full() })] {
            assert_eq!(bare(error).to_string(), full().to_string());
        }
        assert_eq!(bare(io::Error::other("no")).to_string(), "no");
    }

    #[test]
    fn a_failed_writer_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("the disk said no"))
        })
        .unwrap_err();
        assert_eq!(error.to_string(), format!("cannot write {}: the disk said no", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn errors_name_the_path_that_was_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.csv");
        let text = write_atomically(&path, |_| Ok(())).unwrap_err().to_string();
        assert!(text.starts_with(&format!("cannot write {}: ", path.display())), "{text}");
        assert!(!text.contains(".turbid-") && text.contains("os error 2"), "{text}");
        assert!(
            write_atomically(folder.path(), |_| Ok(())).unwrap_err().to_string().contains("it is a folder")
        );
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let ours = folder.path().join("ours");
        let plain = folder.path().join("plain");
        write_atomically(&ours, |_| Ok(())).unwrap();
        fs::write(&plain, b"").unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomically(&link, |w| w.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        write_atomically("/dev/null", |w| w.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
