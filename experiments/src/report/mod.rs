//! The report: one self-contained page, readable as a paper, and the summary on the terminal.

mod claims;
mod contents;
mod figures;
mod page;
mod style;
mod summary;
mod tables;

pub use figures::with_figure;
pub use page::page;
pub use summary::summary;
