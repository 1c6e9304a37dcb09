//! Scenes of other programs: a scene written as a scene of Mitsuba 3, and one of Mitsuba 3 read as a scene file; and scenes from anywhere.
//!
//! What the other side cannot say is refused by name, in one line; nothing is left out in silence.

mod export;
mod import;
mod open;
mod xml;

pub use export::{Exported, to_mitsuba};
pub use import::{Imported, from_mitsuba};
pub use open::{Opened, is_of_mitsuba, open};

/// A file that stands beside another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Beside {
    /// Its name, without a folder.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}
