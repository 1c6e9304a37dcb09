//! Files that are read whole: of a bounded size, and no devices or pipes, which may have no end.

pub(crate) mod literal;
pub(crate) mod npy;

use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Component, Path};

/// The bytes of a file of at most `most` bytes.
///
/// # Errors
/// What the system says of a file that cannot be read; one line about what is not a file, or too large
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let refuse = |what: String| Err(Error::new(ErrorKind::InvalidInput, what));
    // Asked first: to open a pipe that nobody writes to would wait for ever.
    let about = std::fs::metadata(path)?;
    if !about.is_file() {
        return refuse("a folder, a device or a pipe; allowed: a file".into());
    }
    if about.len() > most {
        return refuse(format!("has {} bytes; allowed: up to {most}", about.len()));
    }
    read_stream(path, most)
}

/// The same of whatever can be read, pipes and devices too.
///
/// # Errors
/// As [`read`]
pub fn read_stream(path: &Path, most: u64) -> Result<Vec<u8>> {
    read_all(std::fs::File::open(path)?, most)
}

/// The bytes of what is open, at most `most` of them.
///
/// # Errors
/// As [`read`]
pub fn read_all(input: impl Read, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(Error::new(
            ErrorKind::InvalidInput,
            format!("has more than {most} bytes, which are allowed"),
        ));
    }
    Ok(bytes)
}

/// The text of a file of at most `most` bytes.
///
/// # Errors
/// As [`read`], and for what is not UTF-8
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    text(read(path, most)?)
}

/// Whether a name of a file leads into a folder: not by being absolute, by `..`, or through a link. What is not there counts as
/// inside; who reads it refuses it.
pub fn is_inside(name: &str, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let is_plain =
        Path::new(name).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    let leads_inside = match (folder.canonicalize(), folder.join(name).canonicalize()) {
        (Ok(folder), Ok(file)) => file.starts_with(folder),
        _ => true,
    };
    is_plain && leads_inside
}

/// Line and column of a place in a text, given in bytes: both from 1, columns in characters.
pub fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
    (before.matches('\n').count() + 1, column)
}

/// Bytes as text.
///
/// # Errors
/// For what is not UTF-8
pub fn text(bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).map_err(|_| Error::new(ErrorKind::InvalidData, "not UTF-8 text"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        assert_eq!(read(&path, 4).unwrap_err().to_string(), "has 5 bytes; allowed: up to 4");
        std::fs::write(&path, b"\xff").unwrap();
        assert_eq!(read_text(&path, 4).unwrap_err().to_string(), "not UTF-8 text");
        assert!(read(&folder.path().join("none"), 4).unwrap_err().to_string().starts_with("No such file"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_has_no_end_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        let pipe = made.is_ok_and(|status| status.success()).then_some(pipe.as_path());
        let endless = read_stream(Path::new("/dev/zero"), 100).unwrap_err().to_string();
        assert_eq!(endless, "has more than 100 bytes, which are allowed");
        for path in [Some(Path::new("/dev/zero")), Some(folder.path()), pipe].into_iter().flatten() {
            let said = read(path, 100).unwrap_err().to_string();
            assert_eq!(said, "a folder, a device or a pipe; allowed: a file", "{}", path.display());
        }
    }
}
