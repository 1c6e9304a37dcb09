//! What the header of a file of photons says.

use super::layout::Layout;

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    /// Photons.
    pub count: u64,
    /// How they are written.
    pub body: Body,
    /// Whether nothing else is in the file.
    pub is_alone: bool,
    /// Photons sent out, where the header says it.
    pub emitted: Option<u64>,
}

/// How photons are written.
#[derive(Debug)]
pub(super) enum Body {
    /// One record behind the other.
    Binary(Layout),
    /// A line each; the layout is that of its numbers as doubles.
    Text(Layout),
}

/// Checks that records of a size fill the rest of a file, or fit it where more may follow.
///
/// # Errors
/// What the header says, and what there is
pub(super) fn check_size(count: u64, size: usize, rest: u64, is_last: bool) -> Result<(), String> {
    let needed = count.checked_mul(size as u64);
    match needed {
        Some(needed) if needed == rest || (needed < rest && !is_last) => Ok(()),
        Some(needed) if needed < rest => {
            Err(format!("{} bytes follow its {count} photons of {size} bytes; allowed: none", rest - needed))
        }
        _ => Err(format!(
            "its header promises {count} photons of {size} bytes, {rest} bytes follow; allowed: as many as it promises"
        )),
    }
}
