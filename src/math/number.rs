//! Numbers with a range: checked once where they are made, trusted after.

use crate::error::{Error, Result};

macro_rules! ranged {
    ($(#[$doc:meta])* $name:ident, $allowed:literal, $is_allowed:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, serde::Serialize, serde::Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// The number, or an error that names `quantity` and the range.
            pub fn new(quantity: &str, value: f64) -> Result<Self> {
                let is_allowed: fn(f64) -> bool = $is_allowed;
                if is_allowed(value) { Ok($name(value)) } else { Err(Error::out_of_range(quantity, value, $allowed)) }
            }

            /// The plain number.
            pub fn get(self) -> f64 {
                self.0
            }
        }

        impl TryFrom<f64> for $name {
            type Error = Error;
            fn try_from(value: f64) -> Result<Self> {
                $name::new("the value", value)
            }
        }

        impl From<$name> for f64 {
            fn from(number: $name) -> f64 {
                number.0
            }
        }
    };
}

ranged!(
    /// Single-scattering albedo or reflectance.
    Albedo, "0 to 1", |x| (0.0..=1.0).contains(&x)
);
ranged!(
    /// Asymmetry g of a phase function, the mean cosine.
    Asymmetry, "above -1 and below 1", |x| -1.0 < x && x < 1.0
);
ranged!(
    /// Index of refraction, over that of vacuum.
    Index, "1 to 1000", |x| (1.0..=1000.0).contains(&x)
);
ranged!(
    /// A number above zero.
    Positive, "finite and above 0", |x| x > 0.0 && x.is_finite()
);
ranged!(
    /// A number of at least zero.
    NonNegative, "finite and at least 0", |x| x >= 0.0 && x.is_finite()
);

impl Positive {
    /// A length whose powers are numbers, as those of scenes: from 1e-30 to 1e30.
    pub fn length(quantity: &str, value: f64) -> Result<Self> {
        let positive = Self::new(quantity, value)?;
        if (1e-30..=1e30).contains(&value) {
            Ok(positive)
        } else {
            Err(Error::out_of_range(quantity, value, "from 1e-30 to 1e30"))
        }
    }

    /// One.
    pub const ONE: Positive = Positive(1.0);
}
