//! A number with what is known of its error.

use super::format::{percent, with_error};
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
        Estimate {
            value: jackknife.value,
            std_error: jackknife.std_error,
            maps: Some(jackknife.n),
            is_heavy_tailed: jackknife.is_heavy_tailed(),
        }
    }

    /// A statistic of which resampling the maps gives the error: one that has no jackknife.
    pub fn resampled(value: f64, std_error: f64, maps: u64) -> Self {
        Estimate { value, std_error, maps: Some(maps), is_heavy_tailed: false }
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

    /// One over the statistic, with the same relative error.
    #[must_use]
    pub fn inverse(self) -> Self {
        let value = 1.0 / self.value;
        Estimate { value, std_error: self.std_error * value * value, ..self }
    }

    /// The root of a mean square, 0 where that came out below 0; its error follows from the mean square's, and where that
    /// is within its own error of 0, from the root of that.
    #[must_use]
    pub fn root(self) -> Self {
        let value = self.value.max(0.0).sqrt();
        let slope = 0.5 / if self.value > self.std_error { value } else { self.std_error.sqrt() };
        Estimate { value, std_error: self.std_error * slope, ..self }
    }

    /// The mean of independent statistics, with as many maps as the one of the fewest; none of none.
    pub fn average(estimates: &[Estimate]) -> Option<Self> {
        let count = estimates.len() as f64;
        let square: f64 = estimates.iter().map(|e| e.std_error * e.std_error).sum();
        (!estimates.is_empty()).then(|| Estimate {
            value: estimates.iter().map(|e| e.value).sum::<f64>() / count,
            std_error: square.sqrt() / count,
            maps: estimates.iter().filter_map(|e| e.maps).min(),
            is_heavy_tailed: estimates.iter().any(|e| e.is_heavy_tailed),
        })
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Standard error, or the bound of a computed value.
    pub fn std_error(&self) -> f64 {
        self.std_error
    }

    /// A fraction in per cent, with its error.
    pub fn in_percent(&self) -> String {
        with_error(percent(self.value), percent(self.std_error))
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

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::stats::jackknife;

    fn five() -> Estimate {
        Estimate::mean(&[1.0, 2.0, 3.0, 4.0, 5.0].iter().collect())
    }

    /// The inverse of 3 has the error of 3 over 9, and its inverse is 3 again.
    #[test]
    fn an_inverse_keeps_the_relative_error() {
        let inverse = five().inverse();
        assert!((inverse.std_error() - 0.5f64.sqrt() / 9.0).abs() < 1e-15);
        assert!((inverse.inverse().std_error() - 0.5f64.sqrt()).abs() < 1e-15);
    }

    /// The root of 9 ± e is 3 ± e/6; of a square of nothing, 0 with half the root of its error.
    #[test]
    fn a_root_has_half_the_relative_error() {
        let nine = five().times(3.0);
        assert!((nine.root().std_error() - nine.std_error() / 6.0).abs() < 1e-15);
        let nothing = five().minus(3.5);
        let expected = 0.5 * nothing.std_error().sqrt();
        assert!(nothing.root().value() == 0.0 && (nothing.root().std_error() - expected).abs() < 1e-15);
    }

    /// Two means of error sqrt(1/2): their mean has the error 1/2.
    #[test]
    fn independent_means_average() {
        let both = Estimate::average(&[five(), five().minus(2.0)]).unwrap();
        assert!((both.value() - 2.0).abs() < 1e-15 && (both.std_error() - 0.5).abs() < 1e-15);
        assert_eq!((both.maps(), Estimate::average(&[])), (Some(5), None));
    }

    /// Mean 3, error sqrt(1/2), t(0.975; 4) = 2.776; against 2, t = sqrt 2: p = 0.2302.
    #[test]
    fn a_mean_by_hand() {
        let estimate = five();
        assert_eq!((estimate.value(), estimate.maps()), (3.0, Some(5)));
        // Five values cannot know their variance: its own relative variance is 0.14.
        assert!(estimate.is_heavy_tailed());
        assert!((estimate.std_error() - 0.5f64.sqrt()).abs() < 1e-15);
        let interval = estimate.interval(0.95);
        assert!((interval.high - 3.0 - 2.776_445_105_197_793_4 * 0.5f64.sqrt()).abs() < 1e-9);
        // Closed form at 4 degrees: 1 - s (3 - s^2)/2, s = t/sqrt(t^2 + 4).
        let s = 1.0 / 3f64.sqrt();
        assert!((estimate.p(2.0) - (1.0 - s * (3.0 - s * s) / 2.0)).abs() < 1e-12);
        assert_eq!(estimate.p(3.0), 1.0);
        // The ends of the interval are where p is what is left of the level.
        assert!((estimate.p(interval.low) - 0.05).abs() < 1e-9);
    }

    #[test]
    fn shifts_factors_and_further_errors() {
        let estimate = five().minus(1.0).times(-2.0);
        assert_eq!(estimate.value(), -4.0);
        assert!((estimate.std_error() - 2f64.sqrt()).abs() < 1e-15 && estimate.maps() == Some(5));
        assert!((five().with_reference_error(0.5f64.sqrt()).std_error() - 1.0).abs() < 1e-15);
        assert!((five().times(3.0).p(6.0) - five().p(2.0)).abs() < 1e-12);
    }

    #[test]
    fn a_computed_value_has_its_bound() {
        let exact = Estimate::exact(1.0, -0.1);
        assert_eq!((exact.std_error(), exact.maps()), (0.1, None));
        assert_eq!((exact.p(1.05), exact.p(1.2), exact.p(f64::NAN)), (1.0, 0.0, 0.0));
        assert_eq!(exact.interval(0.95), Interval::about(1.0, 0.1));
    }

    #[test]
    fn one_map_knows_nothing_of_its_error() {
        let one = Estimate::mean(&[2.0].iter().collect());
        assert_eq!((one.interval(0.95).low, one.p(100.0)), (f64::NEG_INFINITY, 1.0));
    }

    #[test]
    fn the_jackknife_of_a_mean_is_the_mean() {
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let estimate = Estimate::jackknife(&jackknife(&[1.0, 2.0, 3.0, 4.0, 5.0], mean));
        assert!((estimate.value() - 3.0).abs() < 1e-14 && estimate.maps() == Some(5));
        assert!((estimate.std_error() - five().std_error()).abs() < 1e-14);
    }

    #[test]
    fn heavy_tails_are_told() {
        let values: Vec<f64> = (0..1000).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
        assert!(Estimate::mean(&values.iter().collect()).is_heavy_tailed());
    }
}
