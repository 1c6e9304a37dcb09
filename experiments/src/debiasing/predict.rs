//! What theory says of every case, before anything is measured.

use super::cases::{Estimator, FIRST, MEAN_LEVELS, QUERIES, constant, difference, photons, radius, work};
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::levels::Schedule;
use crate::setups::uncollided::{Case, Query};

/// One radius: a photon counts with a chance, and brings as much as any other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Mean of the estimate over the exact value.
    pub mean: f64,
    /// The chance that a photon of the pass counts.
    chance: f64,
    /// What a photon that counts brings to an estimate of one photon, over the exact value.
    pub weight: f64,
}

impl Ball {
    /// The ball, disc or strip of a radius.
    pub fn new(query: Query, radius: f64) -> anyhow::Result<Self> {
        let one = Case::new(query, 1, radius)?;
        let mean = 1.0 + one.blur;
        let weight = (one.variance + mean * mean) / mean;
        Ok(Ball::of(mean, weight))
    }

    /// The same from its mean and what a photon that counts brings.
    pub fn of(mean: f64, weight: f64) -> Self {
        Ball { mean, chance: mean / weight, weight }
    }

    /// Variance of an estimate of one photon.
    pub fn variance(&self) -> f64 {
        self.mean * self.weight - self.mean * self.mean
    }
}

/// The difference of two radii that read the same photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Chance and weight of a photon within the smaller one.
    inside: (f64, f64),
    /// Of one between both.
    between: (f64, f64),
}

impl Difference {
    /// The smaller one less the larger one.
    pub fn new(small: &Ball, large: &Ball) -> Self {
        Difference {
            inside: (small.chance, small.weight - large.weight),
            between: (large.chance - small.chance, -large.weight),
        }
    }

    /// That of a level.
    pub fn of_level(query: Query, level: u32) -> anyhow::Result<Self> {
        Ok(Difference::new(&Ball::new(query, radius(level + 1))?, &Ball::new(query, radius(level))?))
    }

    /// Its mean.
    pub fn mean(&self) -> f64 {
        self.inside.0 * self.inside.1 + self.between.0 * self.between.1
    }

    /// Its variance for one photon.
    pub fn variance(&self) -> f64 {
        let square = |(chance, weight): (f64, f64)| chance * weight * weight;
        square(self.inside) + square(self.between) - self.mean() * self.mean()
    }

    /// The mean of its magnitude for so many photons: the counts within and between are multinomial.
    pub fn magnitude(&self, photons: u64) -> f64 {
        let (mut sum, n) = (0.0, photons as f64);
        let rest = self.between.0 / (1.0 - self.inside.0);
        for (i, p) in binomial(photons, self.inside.0).into_iter().enumerate() {
            for (j, q) in binomial(photons - i as u64, rest).into_iter().enumerate() {
                sum += p * q * (i as f64 * self.inside.1 + j as f64 * self.between.1).abs() / n;
            }
        }
        sum
    }
}

/// Chances of 0, 1, 2, ... successes, to where less than a part in 10^15 is left; means are below 100.
fn binomial(trials: u64, chance: f64) -> Vec<f64> {
    let n = trials as f64;
    let mean = n * chance;
    let most = ((mean + 12.0 * mean.sqrt() + 25.0) as u64).min(trials);
    let mut chances = vec![libm::exp(n * libm::log1p(-chance))];
    for k in 1..=most {
        let last = chances[k as usize - 1];
        chances.push(last * (n - k as f64 + 1.0) / k as f64 * chance / (1.0 - chance));
    }
    chances
}

/// The variances, for one photon each, of the first estimate of a stopped sum and of its differences.
fn parts(query: Query, levels: u32) -> anyhow::Result<Vec<f64>> {
    let mut parts = vec![Ball::new(query, FIRST)?.variance()];
    for level in 0..levels {
        parts.push(Difference::of_level(query, level)?.variance());
    }
    Ok(parts)
}

/// How many of some photons each part of a stopped sum gets: in proportion to the root of its variance, which is best, at least one.
pub fn shares(query: Query, levels: u32, photons: u64) -> anyhow::Result<Vec<u64>> {
    let roots: Vec<f64> = parts(query, levels)?.iter().map(|v| v.sqrt()).collect();
    let whole: f64 = roots.iter().sum();
    Ok(roots.iter().map(|root| ((photons as f64 * root / whole).round() as u64).max(1)).collect())
}

/// What the variance of a sum whose photons are shared out so tends to with more levels, each of half the radius, over that of the plain
/// estimate at its last radius.
pub fn limit(query: Query) -> f64 {
    let s = libm::exp2(-0.5 * query.codimension());
    (1.0 + s) / (1.0 - s)
}

/// The radius of the least mean squared error with so many photons, at most the first of the sums.
pub fn best(query: Query, photons: u64) -> anyhow::Result<f64> {
    let mut best = (f64::INFINITY, FIRST);
    // Four octaves, in steps that are worth a thousandth of the error.
    for i in 0..64 {
        let radius = FIRST * libm::exp2(-f64::from(i) / 16.0);
        let squared = Case::new(query, photons, radius)?.squared();
        if squared < best.0 {
            best = (squared, radius);
        }
    }
    Ok(best.1)
}

/// The least mean squared error of stopped sums with so many photons, over that of the plain estimate at its best radius: whatever their
/// first radius, in a field that goes on as it is about the questions, and from one to six levels.
pub fn least(query: Query, photons: u64) -> anyhow::Result<f64> {
    let plain = Case::new(query, photons, best(query, photons)?)?.squared();
    let mut least = f64::INFINITY;
    for i in 0..48 {
        let first = 4.0 * FIRST * libm::exp2(-f64::from(i) / 16.0);
        let mut ball = Ball::new(query, first)?;
        let mut root = ball.variance().sqrt();
        for level in 1..=6 {
            let next = Ball::new(query, first * libm::exp2(-f64::from(level)))?;
            root += Difference::new(&next, &ball).variance().sqrt();
            ball = next;
            let blur = ball.mean - 1.0;
            least = least.min(blur * blur + root * root / photons as f64);
        }
    }
    Ok(least / plain)
}

/// Mean error and mean squared error of an estimator, relative to the exact value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// What is left of the blur.
    pub blur: f64,
    /// Mean squared error.
    pub squared: f64,
}

impl Expected {
    /// Of an estimator.
    pub fn new(settings: &Settings, query: Query, estimator: Estimator) -> anyhow::Result<Self> {
        let plain = |photons: u64, radius: f64| {
            let case = Case::new(query, photons, radius)?;
            Ok(Expected { blur: case.blur, squared: case.squared() })
        };
        let all = photons(settings);
        match estimator {
            Estimator::Plain(levels) => plain(all, radius(levels)),
            Estimator::Best => plain(all, best(query, all)?),
            Estimator::Equal => plain(work(settings), best(query, work(settings))?),
            Estimator::Off => plain(shares(query, MEAN_LEVELS, all)?[0], FIRST),
            Estimator::Stopped(levels) => {
                let (parts, shares) = (parts(query, levels)?, shares(query, levels, all)?);
                let variance: f64 = parts.iter().zip(&shares).map(|(v, &n)| v / n as f64).sum();
                let blur = Ball::new(query, radius(levels))?.mean - 1.0;
                Ok(Expected { blur, squared: blur * blur + variance })
            }
            Estimator::Drawn => {
                let schedule = Schedule::of(query.codimension());
                let mut second = Ball::new(query, FIRST)?.variance() / schedule.first as f64;
                let mut mean = 0.0;
                for level in 0..=schedule.last {
                    let difference = Difference::of_level(query, level)?;
                    let own = difference.variance() / schedule.photons(level) as f64;
                    second += (own + difference.mean() * difference.mean()) / schedule.chance(level);
                    mean += difference.mean();
                }
                let variance = (second - mean * mean) / schedule.replicates(work(settings)) as f64;
                let blur = Ball::new(query, radius(schedule.last + 1))?.mean - 1.0;
                Ok(Expected { blur, squared: blur * blur + variance })
            }
        }
    }
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for query in QUERIES {
        let all = Estimator::of_photons().into_iter().chain([Estimator::Drawn, Estimator::Equal]);
        for estimator in all {
            let Expected { blur, squared } = Expected::new(settings, query, estimator)?;
            let name = estimator.name(query);
            let source = "kernel mean of an exponential field";
            predictions.push(Prediction::new(&name, "error", Unit::ONE, (blur, 1e-12), source));
            let source = "squared blur and variance of independent photons";
            let squared = (squared, 1e-12 * squared);
            predictions.push(Prediction::new(name, "squared error", Unit::ONE, squared, source));
        }
        let (levels, photons) = constant(query);
        for level in 0..levels {
            let magnitude = Difference::of_level(query, level)?.magnitude(photons);
            let source = "multinomial counts within and between two radii";
            let (name, value) = (difference(query, level), (magnitude, 1e-12 * magnitude));
            predictions.push(Prediction::new(name, "magnitude", Unit::ONE, value, source));
        }
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Variance of a sum whose photons are shared out best, over that of the plain estimate with the variance `plain`.
    fn price(parts: &[f64], plain: f64) -> f64 {
        let root: f64 = parts.iter().map(|v| v.sqrt()).sum();
        root * root / plain
    }

    /// The field 1 + x^2 in d dimensions, radii from 1 halved four times, Poisson counts: variances as leading order has
    /// them, and the mean at the last radius.
    #[test]
    fn the_price_of_four_levels_in_closed_form() {
        let known = [
            (1.0, 2.0, 4.657_236, 1.001_302_083),
            (2.0, PI, 2.969_290, 1.001_953_125),
            (3.0, 4.0 * PI / 3.0, 2.112_776, 1.002_343_750),
        ];
        for (d, unit, price_of_four, mean_of_four) in known {
            let ball = |k: u32| {
                let r = libm::exp2(-f64::from(k));
                let volume = unit * libm::pow(r, d);
                let mean = 1.0 + d / (d + 2.0) * r * r;
                (mean, mean * volume, 1.0 / volume)
            };
            let mut parts = vec![ball(0).0 * ball(0).2];
            for k in 0..4 {
                let ((_, inner, heavy), (_, outer, light)) = (ball(k + 1), ball(k));
                parts.push(inner * (heavy - light) * (heavy - light) + (outer - inner) * light * light);
            }
            let (mean, _, weight) = ball(4);
            let found = price(&parts, mean * weight);
            assert!((found - price_of_four).abs() < 1e-6, "{d}: {found}");
            assert!((mean - mean_of_four).abs() < 1e-9);
            // Differences telescope in the variance too: coupling does not shrink them.
            let whole: f64 = parts.iter().sum();
            assert!((whole / (mean * weight) - 1.0).abs() < 0.1);
        }
    }

    /// With ever more levels the price tends to (1 + s)/(1 - s), from below.
    #[test]
    fn prices_tend_to_their_limits() {
        for (query, known) in QUERIES.into_iter().zip([2.093_836, 3.0, 5.828_427]) {
            assert!((limit(query) - known).abs() < 1e-6);
            let of = |levels: u32| {
                price(&parts(query, levels).unwrap(), Ball::new(query, radius(levels)).unwrap().variance())
            };
            assert!(of(2) < of(4) && of(4) < of(20) && (of(20) / known - 1.0).abs() < 0.01, "{}", of(20));
        }
    }

    /// The blur telescopes, and the magnitude of a difference that seldom counts is 2 f (1 - 2^-c) whatever the level.
    #[test]
    fn magnitudes_do_not_fall() {
        for query in QUERIES {
            let sum: f64 = (0..6).map(|level| Difference::of_level(query, level).unwrap().mean()).sum();
            let ends = Ball::new(query, radius(6)).unwrap().mean - Ball::new(query, FIRST).unwrap().mean;
            assert!((sum - ends).abs() < 1e-12);
            let last = 2.0 * (1.0 - libm::exp2(-query.codimension()));
            for level in [12, 14] {
                let found = Difference::of_level(query, level).unwrap().magnitude(100);
                assert!((found / last - 1.0).abs() < 0.01, "{query:?} {level}: {found} {last}");
            }
        }
    }

    /// One photon: it counts within, between or nowhere. And many, whose counts are nearly normal.
    #[test]
    fn magnitudes_of_one_photon_and_of_many() {
        let one = Difference { inside: (0.1, 3.0), between: (0.2, -1.0) };
        assert!((one.magnitude(1) - 0.5).abs() < 1e-15 && (one.mean() - 0.1).abs() < 1e-15);
        let even = Difference { inside: (0.25, 1.0), between: (0.25, -1.0) };
        let normal = (2.0 / PI).sqrt() * (even.variance() / 200.0).sqrt();
        assert!((even.magnitude(200) / normal - 1.0).abs() < 0.01);
    }

    /// Whatever the number of levels, the stopped sum is farther off than the plain estimate at its best radius; and so is, in the
    /// root mean square, the sum that is drawn.
    #[test]
    fn no_number_of_levels_gains() {
        let settings = Settings::new("unused");
        for query in QUERIES {
            let of = |e: Estimator| Expected::new(&settings, query, e).unwrap().squared;
            for levels in 1..10 {
                assert!(of(Estimator::Stopped(levels)) > of(Estimator::Best), "{query:?} {levels}");
            }
            assert!(of(Estimator::Drawn) > of(Estimator::Equal));
            assert!(least(query, 2000).unwrap() > 1.2 && least(query, 2_000_000).unwrap() > 1.2);
        }
    }
}
