//! The library's one error: each variant says what to change.

/// Why a request was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number outside its range: names the quantity, the value and what is allowed.
    #[error("{name} is {}; allowed: {allowed}", plain(*value))]
    OutOfRange {
        /// The quantity, as the user calls it.
        name: String,
        /// What was given.
        value: f64,
        /// The range, in words.
        allowed: &'static str,
    },
    /// A scene whose parts are each valid, but not together.
    #[error("{0}")]
    Scene(String),
    /// The request needs a path class that no sampler at hand can reach.
    #[error("{0}")]
    Unreachable(String),
    /// The user stopped the work.
    #[error("cancelled")]
    Cancelled,
    /// Non-finite contributions were met; nothing non-finite is dropped in silence.
    #[error("{count} non-finite contributions in {place}; allowed: 0")]
    NonFinite {
        /// How many.
        count: u64,
        /// Where they were met.
        place: &'static str,
    },
}

/// A number without rows of zeros.
pub(crate) fn plain(value: f64) -> String {
    let is_near_one = value == 0.0 || (1e-4..1e9).contains(&value.abs()) || !value.is_finite();
    if is_near_one { format!("{value}") } else { format!("{value:e}") }
}

impl Error {
    /// The error of a number outside its range.
    pub fn out_of_range(name: impl Into<String>, value: f64, allowed: &'static str) -> Self {
        Error::OutOfRange { name: name.into(), value, allowed }
    }

    /// The same error, met in a part of a scene: says which.
    pub fn within(self, part: &str) -> Self {
        match self {
            Error::OutOfRange { name, value, allowed } => {
                Error::OutOfRange { name: format!("{part}.{name}"), value, allowed }
            }
            Error::Scene(text) => Error::Scene(format!("{part}: {text}")),
            other => other,
        }
    }
}

/// A result with the library's error.
pub type Result<T> = std::result::Result<T, Error>;
