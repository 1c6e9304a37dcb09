//! What theory says of an estimate from uncollided light, before anything is measured.

use super::field::{DEPTH, MU0, SPAN};
use super::query::Query;
use crate::setups::CELL;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::beams::Ray;
use turbid_analytic::kernel::{Dimension, Kernel};

/// The predicted error of an estimate, relative to the exact value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// The field bends within the radius.
    pub blur: f64,
    /// Bound on its numerical error.
    pub error: f64,
    /// Variance of one estimate.
    pub variance: f64,
}

impl Case {
    /// Exact mean and variance, uniform kernel, for so many independent photons in all.
    pub fn new(query: Query, photons: u64, radius: f64) -> anyhow::Result<Self> {
        let mean = query.blurs_as().exponential_mean(Kernel::Uniform, radius * query.slope())?;
        // Collisions in a volume, or the length of flights, where they are asked; the beam brings MU0 on each square of the face.
        let density = photons as f64 * libm::exp(-DEPTH / MU0) / (MU0 * CELL * CELL);
        let second = second_moment(query, density, radius)?;
        // One estimate is a sum over independent photons, each of which is one of so many.
        let variance = second - mean.value * mean.value / photons as f64;
        Ok(Case { blur: mean.value - 1.0, error: mean.error + 1e-14, variance })
    }

    /// Predicted mean squared error.
    pub fn squared(&self) -> f64 {
        self.blur * self.blur + self.variance
    }
}

/// Mean of the sum of the squares of what photons bring, over the square of the exact value.
fn second_moment(query: Query, density: f64, radius: f64) -> anyhow::Result<f64> {
    let ray = Ray { length: SPAN.length(), extinction: 0.0 };
    let x = radius * query.slope();
    Ok(match query {
        // The square of the uniform kernel is a uniform one.
        Query::Places | Query::BeamsAtPlaces | Query::Rays | Query::Beams => {
            let even = query.blurs_as().relative_variance(Kernel::Uniform, radius, density, ray)?;
            even.value * query.blurs_as().exponential_mean(Kernel::Uniform, x)?.value
        }
        // A photon counts by its chord of the balls' centres, (3/(2 pi)) sqrt(1 - u^2), whose square is 9/(8 pi) times the kernel of
        // Epanechnikov on the disc.
        Query::Marched => {
            let even = 9.0 / (8.0 * std::f64::consts::PI * density * radius * radius * ray.length);
            even * exponential_mean(Kernel::Epanechnikov, Dimension::Two, x)?.value
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best radius follows r^(c+4) = c B/(4 A^2 N): the same exponent, found by a search where no term is left out.
    #[test]
    fn exponents_tend_to_those_of_the_rule() {
        for query in Query::ALL {
            let best = |photons: u64| {
                let radius = |i: u32| 0.002 * libm::exp(0.01 * f64::from(i));
                let at = |i: u32| Case::new(query, photons, radius(i)).unwrap().squared();
                (0..500).map(at).fold(f64::INFINITY, f64::min)
            };
            let slope = libm::log(best(4_000_000_000) / best(1_000_000_000)) / libm::log(4.0);
            let c = query.codimension();
            assert!((slope + 4.0 / (c + 4.0)).abs() < 2e-3, "{query:?}: {slope}");
        }
    }

    /// The chord's kernel by midpoints: of the integral 1, its square as stated.
    #[test]
    fn chords_of_balls_by_midpoints() {
        let (mut whole, mut square) = (0.0, 0.0);
        let steps = 100_000;
        for i in 0..steps {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let chord = 3.0 / (4.0 * std::f64::consts::PI) * 2.0 * (1.0 - u * u).sqrt();
            let ring = 2.0 * std::f64::consts::PI * u / f64::from(steps);
            whole += chord * ring;
            square += chord * chord * ring;
        }
        assert!(
            (whole - 1.0).abs() < 1e-6 && (square / (9.0 / (8.0 * std::f64::consts::PI)) - 1.0).abs() < 1e-6
        );
        let one = second_moment(Query::Marched, 1.0 / SPAN.length(), 1e-3).unwrap() * 1e-6;
        assert!((one / square - 1.0).abs() < 1e-5);
    }
}
