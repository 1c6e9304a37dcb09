//! The intervals that the laboratory makes, each as it makes them, from the maps of one repeat.

use super::field::{Exact, PLACES, RADII};
use crate::harness::Estimate;
use turbid::stats::{Moments, amplitude_per_map, jackknife, jackknife_log};

/// What a map says at one row of places. Estimates are relative errors.
#[derive(Debug, Clone, Copy, Default)]
pub struct Answer {
    /// Mean error over the places, by radius.
    pub fixed: [f64; RADII.len()],
    /// Error at each place, largest radius.
    pub places: [f64; PLACES],
    /// Mean error of the nearest estimate over the places.
    pub nearest: f64,
    /// Mean of the photon counts in the largest balls.
    pub count: f64,
    /// Their variance over the places.
    pub count_variance: f64,
}

/// What an interval is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Error at a fixed radius: the mean over maps.
    Radius,
    /// Error of the k nearest: the mean over maps.
    Nearest,
    /// Measured over predicted error of several radii: the mean of one fit a map, with weights from all maps.
    Amplitude,
    /// Variance over mean of counts: refitted without each map, on the logarithm.
    Fano,
    /// Root mean square error: likewise.
    RootMeanSquare,
    /// Photons that reach a given error: likewise.
    Price,
    /// The same price refitted as it is, not its logarithm: for comparison.
    PlainPrice,
}

impl Kind {
    /// Those that the laboratory makes, in the order of tables.
    pub const MADE: [Kind; 6] =
        [Kind::Radius, Kind::Nearest, Kind::Amplitude, Kind::Fano, Kind::RootMeanSquare, Kind::Price];
    /// All.
    pub const ALL: [Kind; 7] = [
        Kind::Radius,
        Kind::Nearest,
        Kind::Amplitude,
        Kind::Fano,
        Kind::RootMeanSquare,
        Kind::Price,
        Kind::PlainPrice,
    ];

    /// File-safe name.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Radius => "radius",
            Kind::Nearest => "nearest",
            Kind::Amplitude => "amplitude",
            Kind::Fano => "fano",
            Kind::RootMeanSquare => "rms",
            Kind::Price => "price",
            Kind::PlainPrice => "price-plain",
        }
    }

    /// What it is, for readers.
    pub fn title(self) -> &'static str {
        match self {
            Kind::Radius => "error at a fixed radius",
            Kind::Nearest => "error of the k nearest",
            Kind::Amplitude => "measured over predicted error",
            Kind::Fano => "variance over mean of counts",
            Kind::RootMeanSquare => "root mean square error",
            Kind::Price => "price of 5 % error",
            Kind::PlainPrice => "the price without its logarithm",
        }
    }

    /// What its interval should contain.
    pub fn truth(self, exact: &Exact) -> f64 {
        match self {
            Kind::Radius => exact.errors[RADII.len() - 1],
            Kind::Nearest => exact.nearest,
            Kind::Amplitude => 1.0,
            // The variance over places of a fixed number of photons is their mean, exactly.
            Kind::Fano => 0.0,
            Kind::RootMeanSquare => libm::log(exact.root_mean_square()),
            Kind::Price => libm::log(exact.price(exact.variance)),
            Kind::PlainPrice => exact.price(exact.variance),
        }
    }

    /// The statistic of some maps with its error. None where the maps do not fix it.
    pub fn estimate(self, maps: &[Answer], exact: &Exact) -> Option<Estimate> {
        let mean = |f: &dyn Fn(&Answer) -> f64| Estimate::mean(&maps.iter().map(f).collect::<Moments>());
        let price = |e: &[[f64; PLACES]]| exact.price(variance(e));
        let places = || maps.iter().map(|m| m.places).collect::<Vec<_>>();
        Some(match self {
            Kind::Radius => mean(&|m| m.fixed[RADII.len() - 1]),
            Kind::Nearest => mean(&|m| m.nearest),
            Kind::Amplitude => return amplitude(maps, exact),
            Kind::Fano => Estimate::jackknife(&jackknife_log(maps, fano)),
            Kind::RootMeanSquare => {
                let squares: Vec<f64> = maps.iter().map(|m| mean_square(&m.places)).collect();
                let root = |v: &[f64]| (v.iter().sum::<f64>() / v.len() as f64).sqrt();
                Estimate::jackknife(&jackknife_log(&squares, root))
            }
            Kind::Price => Estimate::jackknife(&jackknife_log(&places(), price)),
            Kind::PlainPrice => Estimate::jackknife(&jackknife(&places(), price)),
        })
    }
}

/// Variance over mean of the counts of all maps.
fn fano(maps: &[Answer]) -> f64 {
    maps.iter().map(|m| m.count_variance).sum::<f64>() / maps.iter().map(|m| m.count).sum::<f64>()
}

/// One fit a map, weighted by what all maps say of the noise.
fn amplitude(maps: &[Answer], exact: &Exact) -> Option<Estimate> {
    let by_map: Vec<Vec<f64>> = maps.iter().map(|m| m.fixed.to_vec()).collect();
    let weight = |i: usize| 1.0 / by_map.iter().map(|m| m[i]).collect::<Moments>().variance();
    let weights: Vec<f64> = (0..RADII.len()).map(weight).collect();
    amplitude_per_map(&exact.errors, &by_map, &weights).map(|a| Estimate::mean(&a.moments))
}

fn mean_square(errors: &[f64]) -> f64 {
    errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64
}

/// Variance over maps, averaged over the places: in two passes and without higher moments, since the jackknife asks for
/// it once a map.
fn variance(maps: &[[f64; PLACES]]) -> f64 {
    let n = maps.len() as f64;
    let at = |place: usize| {
        let mean = maps.iter().map(|m| m[place]).sum::<f64>() / n;
        maps.iter().map(|m| (m[place] - mean) * (m[place] - mean)).sum::<f64>() / (n - 1.0)
    };
    (0..PLACES).map(at).sum::<f64>() / PLACES as f64
}
