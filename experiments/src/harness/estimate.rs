//! A number with what is known of its error.

use turbid::stats::{Interval, Jackknife, Moments, student_critical, student_p};

/// A statistic: its value, and either a standard error over independent maps or a bound on its error.
///
/// There is no way to make one without an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    value: f64,
    std_error: f64,
    /// Number of independent maps; `None` for a computed value, whose error is a bound.
    maps: Option<u64>,
    is_heavy_tailed: bool,
}

impl Estimate {
    /// The mean over maps.
    pub fn mean(moments: &Moments) -> Self {
        Estimate {
            value: moments.mean(),
            std_error: moments.std_error(),
            maps: Some(moments.n()),
            is_heavy_tailed: moments.is_heavy_tailed(),
        }
    }

    /// A smooth statistic refitted without each map.
    pub fn jackknife(jackknife: &Jackknife) -> Self {
        let maps = Some(jackknife.n);
        Estimate { value: jackknife.value, std_error: jackknife.std_error, maps, is_heavy_tailed: false }
    }

    /// A value that is computed, not sampled, known to `bound`.
    pub fn exact(value: f64, bound: f64) -> Self {
        Estimate { value, std_error: bound.abs(), maps: None, is_heavy_tailed: false }
    }

    /// The same statistic less a known number.
    #[must_use]
    pub fn minus(self, reference: f64) -> Self {
        Estimate { value: self.value - reference, ..self }
    }

    /// The same statistic times a known number.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Estimate { value: self.value * factor, std_error: self.std_error * factor.abs(), ..self }
    }

    /// The same statistic with a further, independent error: that of the reference it is measured against.
    #[must_use]
    pub fn with_reference_error(self, error: f64) -> Self {
        Estimate { std_error: libm::hypot(self.std_error, error), ..self }
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Standard error, or the bound of a computed value.
    pub fn std_error(&self) -> f64 {
        self.std_error
    }

    /// Number of independent maps; `None` for a computed value.
    pub fn maps(&self) -> Option<u64> {
        self.maps
    }

    /// Whether the error itself is too uncertain to be used.
    pub fn is_heavy_tailed(&self) -> bool {
        self.is_heavy_tailed
    }

    /// Two-sided interval by Student's t; the bound, for a computed value; unbounded for fewer than two maps.
    pub fn interval(&self, level: f64) -> Interval {
        match self.maps {
            None => Interval::about(self.value, self.std_error),
            Some(maps) if maps < 2 => Interval::new(f64::NEG_INFINITY, f64::INFINITY),
            Some(maps) => {
                Interval::about(self.value, student_critical(1.0 - level, maps - 1) * self.std_error)
            }
        }
    }

    /// Two-sided p-value of the truth being `reference`. A computed value has 1 within its bound and 0 outside.
    pub fn p(&self, reference: f64) -> f64 {
        let difference = self.value - reference;
        match self.maps {
            _ if difference.is_nan() => 0.0,
            None => f64::from(u8::from(difference.abs() <= self.std_error)),
            Some(maps) if maps < 2 => 1.0,
            Some(_) if difference == 0.0 => 1.0,
            Some(maps) => student_p(difference / self.std_error, maps - 1),
        }
    }
}
