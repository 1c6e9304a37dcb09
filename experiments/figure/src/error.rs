//! What a figure refuses to draw, and what to change.

/// A figure that would be wrong or illegible, and why.
///
/// `place` names the panel and the layer, such as `panel 2, points "measured"`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The figure has no panel, or a panel has no layer.
    #[error("{place} is empty: a figure needs panels, a panel needs layers with data")]
    Empty {
        /// Where.
        place: String,
    },
    /// A number that is infinite or not a number.
    #[error("{place}: {column}[{index}] is {value}; a figure draws finite numbers only and drops none")]
    NotFinite {
        /// Where.
        place: String,
        /// The list that holds it.
        column: &'static str,
        /// Its place in the list, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A number that a logarithmic axis cannot show.
    #[error(
        "{place}: {column}[{index}] is {value}, on a logarithmic axis; use Scale::LogClipped to mark it at the border, or Scale::SymLog"
    )]
    NotPositive {
        /// Where.
        place: String,
        /// The list that holds it.
        column: &'static str,
        /// Its place in the list, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Two lists that should be as long as each other.
    #[error("{place}: {column} has {found} entries, expected {expected}")]
    Length {
        /// Where.
        place: String,
        /// The list of the wrong length.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The length that the other lists ask for.
        expected: usize,
    },
    /// An interval whose lower end is above its upper end.
    #[error("{place}: {column}[{index}] runs from {low} down to {high}; give (low, high)")]
    Interval {
        /// Where.
        place: String,
        /// The list that holds it.
        column: &'static str,
        /// Its place in the list, from 0.
        index: usize,
        /// The lower end as given.
        low: f64,
        /// The upper end as given.
        high: f64,
    },
    /// Edges of bins or cells that do not increase.
    #[error("{place}: {column} must increase strictly, and {column}[{index}] does not")]
    Edges {
        /// Where.
        place: String,
        /// The list of edges.
        column: &'static str,
        /// The first edge that is not above the one before it.
        index: usize,
    },
    /// A range or a threshold that makes no axis.
    #[error(
        "{place}: {axis} cannot run from {low} to {high}; give finite limits, low below high by more than 1e-300, positive on a logarithmic axis"
    )]
    Range {
        /// Where.
        place: String,
        /// The axis.
        axis: &'static str,
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
    /// A size, height or threshold that is not positive.
    #[error("{place}: {what} is {value}; it must be finite and above zero")]
    Size {
        /// Where.
        place: String,
        /// Which size.
        what: &'static str,
        /// The size as given.
        value: f64,
    },
    /// A character that the embedded font does not have.
    #[error("the text {text:?} holds {character:?}, which the embedded font cannot draw")]
    Glyph {
        /// The whole text.
        text: String,
        /// The character.
        character: char,
    },
    /// Not enough room for the panels beside their labels.
    #[error(
        "{columns} columns leave {left:.0} pt for each plot: fewer columns, shorter labels or a wider figure"
    )]
    Narrow {
        /// Columns of panels.
        columns: usize,
        /// What is left for each plot, in points.
        left: f64,
    },
    /// A page that is too high, even with the lowest plots: its panels are those of several figures.
    #[error(
        "the page is {millimetres:.0} mm high; allowed: up to {allowed:.0} mm: fewer panels, or a wider figure"
    )]
    Tall {
        /// Its height.
        millimetres: f64,
        /// The greatest height.
        allowed: f64,
    },
    /// A page that is too wide: its drawing would take memory in proportion.
    #[error("the page is {millimetres:.0} mm wide; allowed: up to {allowed:.0} mm")]
    Wide {
        /// Its width.
        millimetres: f64,
        /// The greatest width.
        allowed: f64,
    },
    /// A CSV file that says no figure.
    #[error("{line}{}: {problem}", .column.map_or_else(String::new, |c| format!(":{c}")))]
    Csv {
        /// The line, from 1.
        line: usize,
        /// In a line of the header: the character, from 1, at the end of what is wrong.
        column: Option<usize>,
        /// What is wrong, and what is allowed.
        problem: String,
    },
    /// The font or a drawing backend failed.
    #[error("drawing failed: {0}")]
    Backend(String),
}

impl Error {
    /// The row of a layer's table that is at fault, from 0, if it is one.
    pub(crate) fn row(&self) -> Option<usize> {
        match self {
            // Named ticks belong to an axis, and a note's two coordinates are one row.
            Self::NotFinite { column: "names", .. } | Self::NotPositive { column: "names", .. } => None,
            Self::NotFinite { column: "at", .. } | Self::NotPositive { column: "at", .. } => Some(0),
            Self::NotFinite { index, .. }
            | Self::NotPositive { index, .. }
            | Self::Interval { index, .. } => Some(*index),
            _ => None,
        }
    }
}
