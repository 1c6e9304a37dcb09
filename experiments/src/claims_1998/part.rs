//! One part of the experiment: some sentences of the talk, and what was found of them.

use crate::harness::Section;

/// What the cells' random streams are named by: it stays when the experiment is renamed.
pub const STREAM: &str = "deck";

/// What a part found.
pub struct Part {
    /// Claims, figures, tables, notes and results; paragraphs of the summary other than the sentences themselves.
    pub section: Section,
    /// Each sentence of the talk with what was found.
    pub said: Vec<[String; 2]>,
}
