//! How radii shrink from map to map, so that the mean over maps converges to the light itself.

use crate::faults::{Fault, planted};
use crate::math::{Positive, exp};

/// What photons are counted in, by the power of its radius that the variance of an estimate falls with: the dimensions of space, less
/// that of what is stored and that of what asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Codimension {
    /// A strip about a ray, which beams cross.
    One,
    /// A disc on a surface, or a tube about a ray, with points.
    Two,
    /// A ball about a place, with points.
    Three,
}

impl Codimension {
    /// The factor of the first map's radius in the map of this number, the first being 0.
    ///
    /// With c the codimension and i the number counted from 1, r_(i+1)^c = r_i^c (i + a)/(i + 1) with a = 4/(c + 4): the variance of a
    /// map grows as i^(1-a) and its squared bias falls as i^(-4(1-a)/c), so that those of the mean over n maps fall at one pace, n^(-a).
    ///
    /// # Source
    /// Hachisuka, Ogaki and Jensen 2008, "Progressive photon mapping"; Knaus and Zwicker 2011, "Progressive photon mapping: a
    /// probabilistic approach", for a at its best
    pub fn shrinkage(self, map: u64) -> f64 {
        let c = match self {
            Codimension::One => 1.0,
            Codimension::Two => 2.0,
            Codimension::Three => 3.0,
        };
        let root = if planted(Fault::ScheduleOfSpace) { 3.0 } else { c };
        let (a, i) = (4.0 / (c + 4.0), map as f64 + 1.0);
        // Gamma(i + a) / (Gamma(1 + a) Gamma(i + 1)), the product of the ratios.
        exp((libm::lgamma(i + a) - libm::lgamma(1.0 + a) - libm::lgamma(i + 1.0)) / root)
    }

    /// The radius in the map of this number, from that in the first.
    pub fn radius(self, first: Positive, map: u64) -> Positive {
        Positive::new("the radius", first.get() * self.shrinkage(map)).unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tenth radius at the best a in one, two and three dimensions, and the product itself.
    #[test]
    fn radii_follow_the_recurrence() {
        let all = [
            (Codimension::One, 1.0, 0.672_098),
            (Codimension::Two, 2.0, 0.713_103),
            (Codimension::Three, 3.0, 0.744_980),
        ];
        for (codimension, c, tenth) in all {
            assert!((codimension.shrinkage(9) - tenth).abs() < 1e-6);
            let a = 4.0 / (c + 4.0);
            let mut product = 1.0;
            for map in 0..100_000u64 {
                if map < 100 || map == 99_999 {
                    let expected = libm::pow(product, 1.0 / c);
                    assert!((codimension.shrinkage(map) / expected - 1.0).abs() < 1e-9, "{c} {map}");
                }
                product *= (map as f64 + 1.0 + a) / (map as f64 + 2.0);
            }
        }
    }

    #[test]
    fn radii_shrink_for_ever_and_stay_numbers() {
        for codimension in [Codimension::One, Codimension::Two, Codimension::Three] {
            assert!((codimension.shrinkage(0) - 1.0).abs() < 1e-15);
            let radii: Vec<f64> = (0..64).map(|power| codimension.shrinkage((1u64 << power) - 1)).collect();
            assert!(
                radii.windows(2).take(40).all(|pair| pair[1] < pair[0]) && radii.iter().all(|r| *r > 0.0)
            );
        }
    }
}
