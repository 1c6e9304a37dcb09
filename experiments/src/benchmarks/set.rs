//! What a set of published numbers is.

use super::comparison::Comparison;
use super::scene::Bench;

/// How a set is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plot {
    /// Values over the abscissa, a curve a case, and differences over errors below.
    Curves {
        /// Label and unit of the abscissa.
        x: (&'static str, &'static str),
        /// Label and unit of the values.
        y: (&'static str, &'static str),
        /// Whether values are drawn on a logarithmic axis.
        is_log: bool,
    },
    /// Relative differences with their errors, row by row, and differences over errors below.
    Rows,
}

/// A set of published numbers.
pub struct Set {
    /// What the command line calls it.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Who published it.
    pub source: &'static str,
    /// What is asked, with its normalisation.
    pub about: &'static str,
    /// What is said of the error of theirs, and by whom.
    pub trust: &'static str,
    /// What a comparison that differs is explained by: who answered, and why.
    pub explained: &'static [(&'static str, &'static str)],
    /// Whether the column of theirs is empty until the user brings a file.
    pub open: bool,
    /// How it is drawn.
    pub plot: Plot,
    /// Seconds that it takes, quick and full.
    pub seconds: [f64; 2],
    /// Answers it.
    pub run: fn(&Bench) -> anyhow::Result<Vec<Comparison>>,
}
