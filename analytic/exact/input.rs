//! Files that are read whole: of a bounded size, and no devices or pipes, which may have no end.

use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::io::Read;
use std::path::Path;

/// Largest file that is read, 16 MiB: some 10^5 questions of a table, or 10^5 lines of a phase function at 150 characters.
pub const MOST_BYTES: u64 = 16 << 20;

/// The bytes of a file.
///
/// # Errors
/// Names the file, and says what the system does of a file that cannot be read, or what it is or how large
pub fn read(path: &Path) -> Result<Vec<u8>> {
    read_up_to(path, MOST_BYTES).with_context(|| format!("{}", path.display()))
}

fn read_up_to(path: &Path, most: u64) -> Result<Vec<u8>> {
    // Asked first: to open a pipe that nobody writes to would wait for ever.
    let about = fs::metadata(path)?;
    ensure!(about.is_file(), "a folder, a device or a pipe; allowed: a file");
    ensure!(about.len() <= most, "has {} bytes; allowed: up to {most}", about.len());
    let mut bytes = Vec::new();
    // Files of the system may hold more than they say.
    fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    ensure!(bytes.len() as u64 <= most, "has more than {most} bytes, which are allowed");
    Ok(bytes)
}

/// The text of a file, without the mark that some editors put first.
///
/// # Errors
/// As [`read`], and for what is not UTF-8
pub fn read_text(path: &Path) -> Result<String> {
    match String::from_utf8(read(path)?) {
        Ok(text) => Ok(text.trim_start_matches('\u{feff}').to_string()),
        Err(_) => bail!("{}: not text; allowed: UTF-8", path.display()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "\u{feff}12").unwrap();
        assert_eq!(read_up_to(&path, 5).unwrap(), "\u{feff}12".as_bytes());
        assert_eq!(read_text(&path).unwrap(), "12");
        assert_eq!(read_up_to(&path, 4).unwrap_err().to_string(), "has 5 bytes; allowed: up to 4");
    }
}
