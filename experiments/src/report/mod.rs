//! The report: one self-contained page, readable as a paper, and the summary on the terminal.

mod page;
mod style;
mod summary;

pub use page::page;
pub use summary::summary;
