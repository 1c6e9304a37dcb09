//! What theory says of every case, before anything is measured.

use super::cases::{QUERIES, best, name, photons, radii, schedules, stops};
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::uncollided::{Case, Query};

/// The predicted error of a mean over maps, relative to the exact value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Mean of the blurs of the maps.
    pub blur: f64,
    /// Bound on its numerical error.
    pub error: f64,
    /// Variance of the mean.
    pub variance: f64,
}

impl Expected {
    /// The mean over maps of so many photons each, read within these radii: blurs and variances of the maps are exact.
    pub fn after(query: Query, photons: u64, radii: &[f64]) -> anyhow::Result<Self> {
        let n = radii.len() as f64;
        let mut all = Expected { blur: 0.0, error: 0.0, variance: 0.0 };
        for radius in radii {
            let Case { blur, error, variance } = Case::new(query, photons, *radius)?;
            all.blur += blur / n;
            all.error += error / n;
            all.variance += variance / (n * n);
        }
        Ok(all)
    }

    /// Predicted mean squared error.
    pub fn squared(&self) -> f64 {
        self.blur * self.blur + self.variance
    }

    /// The chance that 1.96 standard errors about the mean hold the exact value, if the mean is normal and its variance known.
    pub fn coverage(&self) -> f64 {
        let shift = self.blur / self.variance.sqrt();
        let below = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
        below(1.96 - shift) - below(-1.96 - shift)
    }
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let photons = photons(settings);
    let mut predictions = Vec::new();
    for query in QUERIES {
        let (first, oracle) = best(settings, query)?;
        for schedule in schedules(query) {
            for stop in stops(settings) {
                let expected = Expected::after(query, photons, &radii(query, schedule, stop, first, oracle))?;
                let name = name(query, schedule, stop);
                let blur = (expected.blur, expected.error);
                let source = "mean over maps of the kernel mean of an exponential field";
                predictions.push(Prediction::new(&name, "error", Unit::ONE, blur, source));
                let bound = 2.0 * expected.blur * expected.error + 1e-12 * expected.variance;
                let source = "squared mean blur, and variance of independent photons over the number of maps";
                let squared = (expected.squared(), bound);
                predictions.push(Prediction::new(name, "squared error", Unit::ONE, squared, source));
            }
        }
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progressive::cases::Schedule;
    use turbid_analytic::kernel::Dimension;
    use turbid_analytic::progressive::{optimum_alpha, progressive, progressive_radius};

    /// Small radii: blur and variance of the mean are those of the referee's sums, and the radii of simulator and referee agree.
    #[test]
    fn sums_are_those_of_the_referee() {
        for (query, d) in
            [(Query::Places, Dimension::Three), (Query::Rays, Dimension::Two), (Query::Beams, Dimension::One)]
        {
            let alpha = optimum_alpha(d).value;
            let (first, n) = (1e-3, 40);
            let radii = radii(query, Schedule::Own, n, first, first);
            for (map, radius) in radii.iter().enumerate() {
                let expected = progressive_radius(d, alpha, map as f64 + 1.0).unwrap().value;
                assert!((radius / first / expected - 1.0).abs() < 1e-12, "{query:?} {map}");
            }
            let of_one = Case::new(query, 1000, first).unwrap();
            let all = Expected::after(query, 1000, &radii).unwrap();
            let sums = progressive(d, alpha, n as u32).unwrap();
            assert!((all.blur / of_one.blur / sums.bias.value - 1.0).abs() < 1e-5, "{query:?}");
            assert!((all.variance / of_one.variance / sums.variance.value - 1.0).abs() < 1e-3, "{query:?}");
        }
    }

    /// The price of going progressive, the best first radius of each: 1.0602, 1.0817, 1.0883 in the limit, from below; the mean squared
    /// error of the wrong root falls too slowly.
    #[test]
    fn the_price_tends_to_its_limit() {
        for (query, limit) in [(Query::Beams, 1.0602), (Query::Rays, 1.0817), (Query::Places, 1.0883)] {
            let least = |schedule: Schedule, maps: u64| {
                let at = |i: i32| {
                    let radius = 0.6 * libm::exp(-0.04 * f64::from(i));
                    let radii = radii(query, schedule, maps, radius, radius);
                    Expected::after(query, 1_000_000, &radii).unwrap().squared()
                };
                // Bias grows and noise falls with the radius, so that there is one minimum: every tenth, then those beside the least.
                let coarse = (0..100).step_by(10).map(|i| (at(i), i));
                let (_, near) = coarse.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
                (near - 9..=near + 9).map(at).fold(f64::INFINITY, f64::min)
            };
            let price = |maps| least(Schedule::Own, maps) / least(Schedule::Oracle, maps);
            let (few, many) = (price(30), price(300));
            assert!(1.0 < few && few < many && many < limit, "{query:?}: {few} {many}");
            assert!(limit - many < 0.02, "{query:?}: {many}");
        }
    }
}
