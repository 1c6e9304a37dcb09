//! What the cells of one medium say of one method: typical and rare errors against photons and time, and what resampling the cells makes
//! of them.

use super::cases::{LOOKED_AT, Medium, Method, RAYS, answer, filling, name, reading};
use crate::dimension::results::PICTURE;
use crate::harness::{Cells, Estimate};
use crate::theory::exponent;
use turbid::rng::{Purpose, Stream};
use turbid::stats::{Interval, Moments};

/// Samples of the cells with replacement: intervals leave out the twelve at each end.
const RESAMPLES: u64 = 500;
/// Most that a radius may cost in mean squared error for the sake of time.
const MOST: f64 = 4.0;
/// Part of all errors that the rare ones are beyond.
const RARE: f64 = 0.9;

/// What a radius is best for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// The least mean squared error of so many photons.
    Error,
    /// The least product of that and the time, of radii whose error is at most twice the least one: where maps find next to nothing they
    /// are quick, and say nothing.
    Time,
}

/// One number of photons, at the best radius.
pub struct Rung {
    /// Photons of a map.
    pub photons: u64,
    /// The radii that each half of the cells chose, where there is a choice \[mfp\].
    pub radii: Option<[f64; 2]>,
    /// Errors of the rays, relative to the exact value, by cell.
    errors: Vec<Vec<f64>>,
    /// CPU seconds of a map and the rays of a small picture.
    pub seconds: f64,
    /// CPU seconds of a ray.
    pub ray: f64,
    /// Records looked at for a ray.
    pub looked_at: f64,
}

impl Rung {
    /// Root mean square error.
    pub fn root(&self) -> Estimate {
        let mean = |errors: &Vec<f64>| errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        Estimate::mean(&self.errors.iter().map(mean).collect::<Moments>()).root()
    }

    /// Mean error.
    pub fn mean(&self) -> Moments {
        self.errors.iter().map(|errors| errors.iter().sum::<f64>() / errors.len() as f64).collect()
    }

    /// Two quantiles of the size of the error over the rays of some cells: its median, and what a tenth is beyond.
    fn quantiles(&self, cells: impl Iterator<Item = usize>) -> [f64; 2] {
        let mut sizes: Vec<f64> =
            cells.flat_map(|cell| &self.errors[cell]).map(|error| error.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        [0.5, RARE].map(|part| quantile(&sizes, part))
    }
}

/// A quantile of sorted values, between which it goes straight.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * sorted.len() as f64 - 0.5;
    let below = place.clamp(0.0, sorted.len() as f64 - 1.0) as usize;
    let above = (below + 1).min(sorted.len() - 1);
    let share = (place - below as f64).clamp(0.0, 1.0);
    // An error of exactly nothing has no logarithm.
    (sorted[below] + share * (sorted[above] - sorted[below])).max(f64::MIN_POSITIVE)
}

/// One method in one medium.
pub struct Curve {
    /// Where.
    pub medium: Medium,
    /// What answers.
    pub method: Method,
    /// From few photons to many.
    pub rungs: Vec<Rung>,
    /// Median and rare error of each rung.
    pub quantiles: Vec<[f64; 2]>,
    /// The same of each sample of the cells.
    samples: Vec<Vec<[f64; 2]>>,
}

/// Which of the two quantiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Half of the errors are larger.
    Typical = 0,
    /// A tenth of them is.
    Rare = 1,
}

impl Curve {
    /// From the cells: each half of them chooses the radius at which the errors of the other half are told.
    pub fn new(
        cells: &Cells,
        (medium, exact): (Medium, f64),
        method: Method,
        (sizes, aim): (&[u64], Aim),
    ) -> anyhow::Result<Self> {
        let errors = |photons: u64, radius: Option<f64>| -> anyhow::Result<Vec<Vec<f64>>> {
            let case = name(medium, method, photons, radius);
            let rays: Vec<Vec<f64>> =
                (0..RAYS).map(|ray| cells.values(&case, &answer(ray))).collect::<Result<_, _>>()?;
            let of_cell = |cell: usize| rays.iter().map(|ray| ray[cell] / exact - 1.0).collect();
            Ok((0..rays[0].len()).map(of_cell).collect())
        };
        let radii: Vec<Option<f64>> = match method.has_radius() {
            true => medium.radii().into_iter().map(Some).collect(),
            false => vec![None],
        };
        let mut rungs = Vec::new();
        for &photons in sizes {
            let all = radii.iter().map(|&radius| errors(photons, radius)).collect::<Result<Vec<_>, _>>()?;
            let mean = |phase: &str| cells.seconds(&medium.group(photons), phase).iter().collect::<Moments>();
            let stored = if method == Method::Balls { Method::Points } else { method };
            let map = mean(&filling(stored)).mean();
            let rays: Vec<f64> =
                radii.iter().map(|&radius| mean(&reading(method, radius)).mean() / RAYS as f64).collect();
            let seconds: Vec<f64> = rays.iter().map(|ray| map + PICTURE * ray).collect();
            let (places, errors) = match aim {
                Aim::Error => best(&all, &vec![1.0; all.len()]),
                Aim::Time => best(&all, &seconds),
            };
            let looked_at = |place: usize| {
                let values = cells.values(&name(medium, method, photons, radii[place]), LOOKED_AT)?;
                anyhow::Ok(values.iter().collect::<Moments>().mean())
            };
            let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
            rungs.push(Rung {
                photons,
                radii: radii[places[0]].zip(radii[places[1]]).map(|(a, b)| [a, b]),
                errors,
                seconds: middle(places.map(|place| seconds[place])),
                ray: middle(places.map(|place| rays[place])),
                looked_at: middle([looked_at(places[0])?, looked_at(places[1])?]),
            });
        }
        let quantiles = rungs.iter().map(|rung| rung.quantiles(0..rung.errors.len())).collect();
        let samples = (0..RESAMPLES).map(|sample| resampled(&rungs, sample)).collect();
        Ok(Curve { medium, method, rungs, quantiles, samples })
    }

    /// A quantile of the error on one rung, and its error.
    pub fn estimate(&self, rung: usize, size: Size) -> Estimate {
        let value = self.quantiles[rung][size as usize];
        self.resampled(value, |quantiles| quantiles[rung][size as usize])
    }

    /// Its 95 % interval.
    pub fn interval(&self, rung: usize, size: Size) -> Interval {
        interval(self.samples.iter().map(|quantiles| quantiles[rung][size as usize]))
    }

    /// The exponent of the typical error in the number of photons.
    pub fn in_photons(&self) -> Estimate {
        self.exponent(|rung| rung.photons as f64)
    }

    /// The exponent of the typical error in time.
    pub fn in_time(&self) -> Estimate {
        self.exponent(|rung| rung.seconds)
    }

    fn exponent(&self, x: impl Fn(&Rung) -> f64) -> Estimate {
        let x: Vec<f64> = self.rungs.iter().map(x).collect();
        let of = |quantiles: &[[f64; 2]]| {
            exponent(&x, &quantiles.iter().map(|of_rung| of_rung[0]).collect::<Vec<f64>>())
        };
        self.resampled(of(&self.quantiles), of)
    }

    /// A statistic and its standard error over the samples.
    fn resampled(&self, value: f64, of: impl Fn(&[[f64; 2]]) -> f64) -> Estimate {
        let spread: Moments = self.samples.iter().map(|quantiles| of(quantiles)).collect();
        let cells = self.rungs.iter().map(|rung| rung.errors.len()).min().unwrap_or(0);
        Estimate::resampled(value, spread.std_dev(), cells as u64)
    }

    /// Typical errors against time, as found and in each sample: logarithms.
    pub fn lines(&self) -> (Vec<f64>, Vec<f64>, impl Iterator<Item = Vec<f64>>) {
        let logs = |quantiles: &Vec<[f64; 2]>| -> Vec<f64> {
            quantiles.iter().map(|of_rung| libm::log(of_rung[0])).collect()
        };
        let times = self.rungs.iter().map(|rung| libm::log(rung.seconds)).collect();
        (times, logs(&self.quantiles), self.samples.iter().map(logs))
    }

    /// The typical error at a time between those of its rungs; none before the first.
    pub fn typical_at(&self, seconds: f64) -> Option<f64> {
        let (times, found, _) = self.lines();
        let place = libm::log(seconds);
        let is_within = times[0] <= place && place <= times[times.len() - 1] + 1e-9;
        is_within.then(|| libm::exp(at((&times, &found), place)))
    }

    /// Cells that tell its errors.
    pub fn cells(&self) -> u64 {
        self.rungs.iter().map(|rung| rung.errors.len() as u64).min().unwrap_or(0)
    }
}

/// A line through points, at a place between them.
pub fn at((x, y): (&[f64], &[f64]), place: f64) -> f64 {
    let above = x.partition_point(|&x| x < place).clamp(1, x.len() - 1);
    let share = (place - x[above - 1]) / (x[above] - x[above - 1]);
    y[above - 1] + share * (y[above] - y[above - 1])
}

/// The 95 % interval of sampled values.
pub fn interval(values: impl Iterator<Item = f64>) -> Interval {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let end = (0.025 * values.len() as f64) as usize;
    match values.as_slice() {
        [] => Interval::new(f64::NEG_INFINITY, f64::INFINITY),
        sorted => Interval::new(sorted[end], sorted[sorted.len() - 1 - end]),
    }
}

/// The places of the radii that the even and the odd cells find best, by mean squared error times a weight, which may cost no more than four
/// times the least mean squared error; and the errors of each cell at the one that the other half chose, so that luck in choosing is not
/// taken for accuracy.
fn best(all: &[Vec<Vec<f64>>], weights: &[f64]) -> ([usize; 2], Vec<Vec<f64>>) {
    let chosen = [0, 1].map(|half| {
        let square = |cells: &Vec<Vec<f64>>| -> f64 {
            cells.iter().skip(half).step_by(2).flatten().map(|error| error * error).sum()
        };
        let squares: Vec<f64> = all.iter().map(square).collect();
        let most = MOST * squares.iter().copied().fold(f64::INFINITY, f64::min);
        let score = |&place: &usize| squares[place] * weights[place];
        let allowed = (0..all.len()).filter(|&place| squares[place] <= most);
        allowed.min_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(0)
    });
    let errors = (0..all[0].len()).map(|cell| all[chosen[1 - cell % 2]][cell].clone()).collect();
    (chosen, errors)
}

/// The quantiles of one sample of each rung's cells. Methods that read the same maps are sampled alike.
fn resampled(rungs: &[Rung], sample: u64) -> Vec<[f64; 2]> {
    let of_rung = |rung: &Rung| {
        let mut stream = Stream::new(rung.photons, Purpose::Resampling, sample, 0);
        let count = rung.errors.len();
        rung.quantiles((0..count).map(|_| stream.index(count)))
    };
    rungs.iter().map(of_rung).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_by_hand() {
        let values = [1.0, 2.0, 3.0, 4.0];
        assert_eq!([0.5, 0.75, 0.0, 1.0].map(|part| quantile(&values, part)), [2.5, 3.5, 1.0, 4.0]);
        assert!(quantile(&[0.0], 0.5) > 0.0);
    }

    /// Each half of the cells chooses for the other one.
    #[test]
    fn the_best_radius_is_told_of_by_the_other_half() {
        let narrow = vec![vec![1.0], vec![3.0], vec![1.0], vec![3.0]];
        let wide = vec![vec![1.5], vec![2.0], vec![1.5], vec![2.0]];
        let noisy = vec![vec![9.0]; 4];
        let all = [wide, narrow, noisy];
        // The even cells choose the narrow one for the odd ones.
        let told = vec![vec![1.5], vec![3.0], vec![1.5], vec![3.0]];
        assert_eq!(best(&all, &[1.0; 3]), ([1, 0], told));
        // Where the narrow one takes a hundred times as long; and the noisy one no time, which does not help it.
        assert_eq!(best(&all, &[1.0, 100.0, 0.0]).0, [0, 0]);
    }

    #[test]
    fn intervals_leave_out_a_fortieth_at_each_end() {
        let found = interval((0..1000).map(f64::from));
        assert_eq!((found.low, found.high), (25.0, 974.0));
    }
}
