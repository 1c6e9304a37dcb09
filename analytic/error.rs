//! The referee's one error: it names the parameter, what was given, and what is allowed.

/// Why a question has no answer here.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number outside the range in which the answer is known.
    #[error("{name} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// The parameter, as the user calls it.
        name: &'static str,
        /// What was given.
        value: f64,
        /// The range, in words.
        allowed: &'static str,
    },
    /// A function handed in by the caller returned something that is not a finite number.
    #[error("{name} returned {value} at {at}; allowed: finite numbers")]
    NotFinite {
        /// The function, by the name of its argument.
        name: &'static str,
        /// What it returned.
        value: f64,
        /// Where it was asked.
        at: f64,
    },
    /// The question has no finite answer.
    #[error("{0}")]
    Infinite(&'static str),
}

/// A result with the referee's error.
pub type Result<T> = std::result::Result<T, Error>;

/// Passes a number that lies in a closed range, refuses everything else, NaN included.
pub(crate) fn within(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    allowed: &'static str,
) -> Result<f64> {
    if value >= low && value <= high { Ok(value) } else { Err(Error::OutOfRange { name, value, allowed }) }
}
