//! The digest of the running program, by which cells of another build are told.

use anyhow::Context;
pub use turbid::output::Digest;

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

    #[test]
    fn a_program_has_one_digest() {
        assert_eq!(program_digest().unwrap(), program_digest().unwrap());
    }
}
