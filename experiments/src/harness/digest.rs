//! Digests that say "the same" or "not the same"; nothing here is secret.

use anyhow::Context;
use std::fmt;
use std::io::Read;
use std::path::Path;

/// FNV-1a of 128 bits.
///
/// # Source
/// Fowler, Noll, Vo and Eastlake, RFC 9923.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u128);

impl Digest {
    /// The digest of nothing.
    pub const EMPTY: Digest = Digest(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);

    /// The digest after more bytes.
    #[must_use]
    pub fn with(mut self, bytes: &[u8]) -> Self {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
        self
    }

    /// The digest of some bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Digest::EMPTY.with(bytes)
    }

    /// The digest of a file's bytes.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of_file(path: &Path) -> std::io::Result<Self> {
        let mut file = std::fs::File::open(path)?;
        let mut digest = Digest::EMPTY;
        let mut buffer = vec![0; 1 << 16];
        loop {
            let count = file.read(&mut buffer)?;
            if count == 0 {
                return Ok(digest);
            }
            digest = digest.with(&buffer[..count]);
        }
    }

    /// Its low 64 bits.
    pub fn word(self) -> u64 {
        self.0 as u64
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Digest of the running program's own bytes.
///
/// # Errors
/// If the system does not say where the program is, or it cannot be read.
pub fn program_digest() -> anyhow::Result<Digest> {
    let path = std::env::current_exe().context("cannot find the running program")?;
    Digest::of_file(&path).context("cannot read the running program")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published vectors of FNV-1a 128.
    #[test]
    fn known_answers() {
        assert_eq!(Digest::of(b"").to_string(), "6c62272e07bb014262b821756295c58d");
        assert_eq!(Digest::of(b"a").to_string(), "d228cb696f1a8caf78912b704e4a8964");
        assert_eq!(Digest::of(b"foobar").to_string(), "343e1662793c64bf6f0d3597ba446f18");
    }

    #[test]
    fn parts_add_up() {
        assert_eq!(Digest::of(b"foo").with(b"bar"), Digest::of(b"foobar"));
        assert_eq!(program_digest().unwrap(), program_digest().unwrap());
    }
}
