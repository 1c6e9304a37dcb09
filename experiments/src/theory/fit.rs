//! Exponents: straight lines through logarithms, refitted without each cell in turn.

use crate::harness::Estimate;
use turbid::stats::jackknife;

/// Slope of ln y against ln x by least squares.
pub fn exponent(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().map(|x| libm::log(*x)).sum::<f64>() / n;
    let (mut above, mut below) = (0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        let from_mean = libm::log(*x) - mean;
        above += from_mean * libm::log(*y);
        below += from_mean * from_mean;
    }
    above / below
}

/// The exponent of means over cells, less known floors, and its error: `cells` has one value a size for each cell.
/// Sizes have different maps; joining them by number is a free choice.
pub fn exponent_of_means(x: &[f64], cells: &[Vec<f64>], floors: &[f64]) -> Estimate {
    let slope = |cells: &[Vec<f64>]| {
        let mean = |i: usize| cells.iter().map(|c| c[i]).sum::<f64>() / cells.len().max(1) as f64 - floors[i];
        exponent(x, &(0..x.len()).map(mean).collect::<Vec<f64>>())
    };
    Estimate::jackknife(&jackknife(cells, slope))
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::rng::{Purpose, Stream};
    use turbid::stats::{ALPHA, wilson_interval};

    #[test]
    fn powers_are_found() {
        let x = [3.0, 10.0, 30.0, 100.0];
        let y = x.map(|x: f64| 5.0 * libm::pow(x, -4.0 / 7.0));
        assert!((exponent(&x, &y) + 4.0 / 7.0).abs() < 1e-14);
    }

    /// Exponential values of means 1/x and a floor: the interval of 95 % holds the exponent -1 as often as it says.
    #[test]
    fn intervals_cover() {
        let x = [1.0, 3.0, 10.0, 30.0];
        let floors = [0.2; 4];
        let inside = (0..1000).filter(|&set| {
            let mut stream = Stream::new(29, Purpose::Synthetic, set, 0);
            let mut cell = || x.iter().map(|x| 0.2 - libm::log(stream.open_unit()) / x).collect::<Vec<f64>>();
            let cells: Vec<Vec<f64>> = (0..100).map(|_| cell()).collect();
            exponent_of_means(&x, &cells, &floors).interval(0.95).contains(-1.0)
        });
        let interval = wilson_interval(inside.count() as u64, 1000, 1.0 - ALPHA);
        assert!(interval.contains(0.95), "{interval:?}");
    }
}
