//! A number, how far it may be off, and how that is known.

/// An exact value as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The number, in the unit that its function states.
    pub value: f64,
    /// Absolute bound on the difference from the truth, same unit.
    pub error: f64,
    /// How the number and its bound are known.
    pub method: &'static str,
}

impl Value {
    /// A value with its absolute bound.
    pub(crate) fn new(value: f64, error: f64, method: &'static str) -> Self {
        Value { value, error, method }
    }

    /// A value of a formula without cancellation, good to `ulps` roundings.
    pub(crate) fn rounded(value: f64, ulps: f64, method: &'static str) -> Self {
        Value { value, error: ulps * f64::EPSILON * value.abs() + f64::MIN_POSITIVE, method }
    }

    /// The same value in another unit.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        let value = self.value * factor;
        Value { value, error: self.error * factor.abs() + f64::EPSILON * value.abs(), method: self.method }
    }

    /// The sum of two values, known in some other way.
    pub(crate) fn plus(self, other: Value, method: &'static str) -> Self {
        let value = self.value + other.value;
        Value { value, error: self.error + other.error + f64::EPSILON * value.abs(), method }
    }

    /// Whether `other` lies within the bound.
    pub fn covers(&self, other: f64) -> bool {
        (self.value - other).abs() <= self.error
    }
}
