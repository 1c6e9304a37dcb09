//! Light that leaves, with its rounding.

/// Roundings of a term of the sums, in units of its magnitude.
const ULPS: f64 = 16.0;

/// A sum, and the sum of the magnitudes of its terms: rounding is a few units of the last place of that.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Light {
    pub value: f64,
    pub magnitude: f64,
}

impl Light {
    pub fn of(value: f64) -> Self {
        Light { value, magnitude: value.abs() }
    }

    pub fn plus(self, other: Self) -> Self {
        Light { value: self.value + other.value, magnitude: self.magnitude + other.magnitude }
    }

    pub fn scaled(self, factor: f64) -> Self {
        Light { value: self.value * factor, magnitude: self.magnitude * factor.abs() }
    }

    pub fn rounding(self) -> f64 {
        ULPS * f64::EPSILON * self.magnitude
    }
}

/// Scattered light that leaves through the lit face and through the far one, and all that is absorbed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fluxes {
    pub reflected: Light,
    pub transmitted: Light,
    pub absorbed: Light,
}

impl Fluxes {
    /// Whether rounding takes more than `share` of any.
    pub fn loses(self, share: f64) -> bool {
        let parts = [self.reflected, self.transmitted, self.absorbed];
        parts.iter().any(|part| part.rounding() > share * part.value.abs())
    }
}
