//! Estimators of the transmittance of a line.

use super::line::{Line, Places};
use super::series::{Orders, about_each};
use turbid::math::{exp, ln};
use turbid::rng::Stream;
use turbid::transport::segment_transmittance;

/// What an estimator says, and what it looked up for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The transmittance \[1\]; of a series it may be below 0 or above 1.
    pub value: f64,
    /// Densities looked up.
    pub look_ups: u64,
}

/// An estimator of exp(-tau), tau the integral of the extinction along a line.
#[derive(Debug, Clone, PartialEq)]
pub enum Estimator {
    /// 1 if delta tracking, of the rate of the largest extinction, meets no collision.
    Analogue,
    /// Ratio tracking of that rate.
    Ratio,
    /// Ratio tracking of what differs from a control [1/L].
    Residual(f64),
    /// Ratio tracking between local bounds, the lower ones as control: the renderer's.
    Local,
    /// The power series about a pivot, by places at random.
    Series {
        /// How the order is drawn.
        orders: Orders,
        /// The pivot, best at the optical depth \[1\].
        pivot: f64,
    },
    /// The power series about combs: evenly spaced places with one random offset each.
    Comb {
        /// How the order is drawn.
        orders: Orders,
        /// Where places are.
        places: Places,
        /// Places of a comb.
        teeth: u32,
    },
    /// The exponential of a mean over so many places at random: biased.
    March(u32),
    /// The exponential of one comb: biased.
    Marched(Places, u32),
    /// The march of so many places less the bias that leaving out each in turn tells: biased less.
    Jackknife(u32),
    /// A march of so many places, and one difference between marches of twice as many and of their halves, drawn among all:
    /// unbiased.
    Telescoped(u32),
}

/// Chance of a level of the telescoping sum over that of the one before: 2^(-3/2), between the 1/4 that squared differences fall
/// by, and the 1/2 that look-ups grow by.
pub const LEVEL: f64 = 0.353_553_390_593_273_8;

/// Tentative collisions of a rate [1/L] on the line; `meet` says whether to go on.
fn tentative(line: &Line, rate: f64, stream: &mut Stream, mut meet: impl FnMut(f64, &mut Stream) -> bool) {
    if rate <= 0.0 {
        return;
    }
    let (mut depth, end) = (0.0, rate * line.length());
    loop {
        depth -= ln(stream.open_unit());
        if depth >= end || !meet(line.at(depth / end), stream) {
            return;
        }
    }
}

/// Optical depth by a place at random \[1\].
fn at_random(line: &Line, stream: &mut Stream) -> f64 {
    line.extinction(line.at(stream.unit())) * line.length()
}

/// Mean optical depth by places at random \[1\].
fn mean(line: &Line, count: u64, stream: &mut Stream) -> f64 {
    (0..count).map(|_| at_random(line, stream)).sum::<f64>() / count as f64
}

/// Optical depth by a comb \[1\].
fn comb(line: &Line, places: &Places, teeth: u32, stream: &mut Stream) -> f64 {
    if places.is_empty() {
        return places.control;
    }
    let offset = stream.unit();
    let tooth = |i: u32| places.depth_at(line, (f64::from(i) + offset) / f64::from(teeth));
    places.control + (0..teeth).map(tooth).sum::<f64>() / f64::from(teeth)
}

impl Estimator {
    /// One estimate.
    pub fn estimate(&self, line: &Line, stream: &mut Stream) -> Estimate {
        let mut look_ups = 0;
        let value = match self {
            Estimator::Analogue => {
                let (mut passed, high) = (1.0, line.bounds().1);
                tentative(line, high, stream, |t, stream| {
                    look_ups += 1;
                    let is_real = stream.unit() * high < line.extinction(t);
                    passed = if is_real { 0.0 } else { 1.0 };
                    !is_real
                });
                passed
            }
            Estimator::Ratio => return Estimator::Residual(0.0).estimate(line, stream),
            Estimator::Residual(control) => {
                let (low, high) = line.bounds();
                let rate = (high - control).max(control - low);
                let mut passed = exp(-control * line.length());
                tentative(line, rate, stream, |t, _| {
                    look_ups += 1;
                    passed *= 1.0 - (line.extinction(t) - control) / rate;
                    passed != 0.0
                });
                passed
            }
            Estimator::Local => {
                let (medium, ray, part) = line.way();
                let before = stream.work.densities;
                let value = segment_transmittance(medium, ray, part, stream)[0];
                look_ups = stream.work.densities - before;
                value
            }
            Estimator::Series { orders, pivot } => {
                let order = orders.draw(stream);
                look_ups = order as u64;
                let (mut sum, mut product) = (1.0, 1.0);
                for k in 1..=order {
                    product *= (pivot - at_random(line, stream)) / k as f64;
                    sum += product / orders.reaches(k);
                }
                exp(-pivot) * sum
            }
            Estimator::Comb { orders, places, teeth } => {
                let count = if places.is_empty() { 1 } else { orders.draw(stream) + 1 };
                look_ups = if places.is_empty() { 0 } else { count as u64 * u64::from(*teeth) };
                let depths: Vec<f64> = (0..count).map(|_| comb(line, places, *teeth, stream)).collect();
                about_each(&depths, *orders)
            }
            Estimator::March(count) => {
                look_ups = u64::from(*count);
                exp(-mean(line, look_ups, stream))
            }
            Estimator::Marched(places, teeth) => {
                look_ups = if places.is_empty() { 0 } else { u64::from(*teeth) };
                exp(-comb(line, places, *teeth, stream))
            }
            Estimator::Jackknife(count) => {
                look_ups = u64::from(*count);
                let depths: Vec<f64> = (0..*count).map(|_| at_random(line, stream)).collect();
                let (sum, n) = (depths.iter().sum::<f64>(), f64::from(*count));
                let without = depths.iter().map(|depth| exp((depth - sum) / (n - 1.0))).sum::<f64>() / n;
                n * exp(-sum / n) - (n - 1.0) * without
            }
            Estimator::Telescoped(first) => {
                let start = exp(-mean(line, u64::from(*first), stream));
                let (mut half, mut chance) = (u64::from(*first), 1.0 - LEVEL);
                while stream.unit() < LEVEL {
                    (half, chance) = (2 * half, chance * LEVEL);
                }
                look_ups = u64::from(*first) + 2 * half;
                start + halves(line, half, stream) / chance
            }
        };
        Estimate { value, look_ups }
    }
}

/// What a march over twice so many places is above the mean of the marches over its halves \[1\].
pub fn halves(line: &Line, half: u64, stream: &mut Stream) -> f64 {
    let (a, b) = (mean(line, half, stream), mean(line, half, stream));
    exp(-0.5 * (a + b)) - 0.5 * (exp(-a) + exp(-b))
}
