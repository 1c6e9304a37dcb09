//! Root mean square error over probes and maps, split into bias and noise without bias.

use super::cases::LAYERS;
use crate::harness::Estimate;
use turbid::math::exp;
use turbid::stats::{Jackknife, jackknife, jackknife_log};

/// What one map says of one setting: the relative error of each layer, averaged over its lateral probes, and its
/// square. By translation invariance the probes of one layer share their expectation.
#[derive(Debug, Clone, PartialEq)]
pub struct MapError {
    /// Mean relative error by layer.
    pub error: [f64; LAYERS],
    /// Mean squared relative error over all probes.
    pub square: f64,
}

/// Mean squares over probes and maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// Of the relative error.
    pub total: f64,
    /// Of its expectation: the bias that no number of maps removes.
    pub bias: f64,
}

impl Split {
    /// The split of some maps, at least two. The square of a mean over M maps is high by its variance over M, which
    /// is taken off: the squared bias may come out below zero where there is none.
    pub fn of(maps: &[MapError]) -> Self {
        let n = maps.len() as f64;
        let total = maps.iter().map(|m| m.square).sum::<f64>() / n;
        let layer = |index: usize| {
            let mean = maps.iter().map(|m| m.error[index]).sum::<f64>() / n;
            let spread: f64 = maps.iter().map(|m| (m.error[index] - mean) * (m.error[index] - mean)).sum();
            mean * mean - spread / ((n - 1.0) * n)
        };
        Split { total, bias: (0..LAYERS).map(layer).sum::<f64>() / LAYERS as f64 }
    }

    /// Mean variance of one estimate.
    pub fn noise(&self) -> f64 {
        self.total - self.bias
    }
}

/// The root of a mean square that may have come out below zero.
fn root(x: f64) -> f64 {
    if x > 0.0 { x.sqrt() } else { 0.0 }
}

/// A positive statistic, whose relative error is that of its logarithm: statistics of squares are skewed, their
/// logarithms nearly normal.
pub fn positive<T: Clone>(maps: &[T], statistic: impl Fn(&[T]) -> f64) -> Estimate {
    let log = jackknife_log(maps, statistic);
    let value = exp(log.value);
    Estimate::jackknife(&Jackknife { value, std_error: value * log.std_error, ..log })
}

/// Root mean square error, with its error over maps.
pub fn rms(maps: &[MapError]) -> Estimate {
    let squares: Vec<f64> = maps.iter().map(|m| m.square).collect();
    let mean = |squares: &[f64]| root(squares.iter().sum::<f64>() / squares.len() as f64);
    positive(&squares, mean)
}

/// Root mean squared bias, with its error over maps. The jackknife stands on the mean square, which is smooth.
pub fn rms_bias(maps: &[MapError]) -> Estimate {
    Estimate::jackknife(&jackknife(maps, |m| Split::of(m).bias)).root()
}

/// Root mean variance of one estimate, with its error over maps.
pub fn rms_noise(maps: &[MapError]) -> Estimate {
    positive(maps, |m| root(Split::of(m).noise()))
}

/// The maps on which settings are chosen, and those on which the chosen ones are reported: every other one.
pub fn halves<T: Clone>(maps: &[T]) -> (Vec<T>, Vec<T>) {
    let half = |parity| maps.iter().skip(parity).step_by(2).cloned().collect();
    (half(0), half(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::math::{ln, sin_cos};
    use turbid::rng::{Purpose, Stream};

    /// Maps of 256 independent probes a layer, of known bias and noise.
    fn maps(set: u64, count: usize, bias: f64, noise: f64) -> Vec<MapError> {
        let mut stream = Stream::new(5, Purpose::Synthetic, set, 0);
        let mut normal =
            || (-2.0 * ln(stream.open_unit())).sqrt() * sin_cos(std::f64::consts::TAU * stream.unit()).1;
        let one = |_| {
            let (mut error, mut square) = ([0.0; LAYERS], 0.0);
            for slot in &mut error {
                for _ in 0..16 {
                    let e = bias + noise * normal();
                    *slot += e / 16.0;
                    square += e * e / (16 * LAYERS) as f64;
                }
            }
            MapError { error, square }
        };
        (0..count).map(one).collect()
    }

    /// The naive split, the mean's square, is high by noise/(maps x probes): with bias 0 that is all it finds. The
    /// mean over many sets tells them apart.
    #[test]
    fn the_split_is_unbiased_and_the_naive_split_is_not() {
        let (bias, noise) = (0.02, 1.0);
        let (mut right, mut naive) = (Vec::new(), Vec::new());
        for set in 0..400 {
            let maps = maps(set, 8, bias, noise);
            right.push(Split::of(&maps).bias);
            let mean = |layer: usize| maps.iter().map(|m| m.error[layer]).sum::<f64>() / 8.0;
            naive.push((0..LAYERS).map(|l| mean(l) * mean(l)).sum::<f64>() / LAYERS as f64);
        }
        let z = |values: &[f64]| {
            let moments: turbid::stats::Moments = values.iter().collect();
            (moments.mean() - bias * bias) / moments.std_error()
        };
        // Two-sided 1e-6 is 4.9; the naive split has a bias of 1/128 with an error of 7e-5.
        assert!(z(&right).abs() < 4.9, "{}", z(&right));
        assert!(z(&naive) > 50.0, "{}", z(&naive));
    }

    #[test]
    fn the_parts_of_known_noise_and_bias() {
        let maps = maps(1000, 64, 0.3, 0.4);
        for (found, truth) in [(rms(&maps), 0.5), (rms_bias(&maps), 0.3), (rms_noise(&maps), 0.4)] {
            assert!((found.value() - truth).abs() < 4.9 * found.std_error(), "{found:?}, {truth}");
            assert!(found.std_error() < 0.01 && found.maps() == Some(64));
        }
        let (choose, report) = halves(&maps);
        assert!(choose.len() == 32 && report.len() == 32 && choose[0] == maps[0] && report[0] == maps[1]);
    }
}
