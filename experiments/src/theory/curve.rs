//! Squared error against the number of photons, along one rule for the radius.

use super::{exponent, exponent_of_means};
use crate::harness::Estimate;
use turbid::stats::Moments;

/// Squared error against the number of photons along one rule for the radius.
pub struct Curve {
    /// Name in cases and claims.
    pub name: &'static str,
    /// What it is, for readers.
    pub title: String,
    /// Place of the radius of each size in the ladder.
    pub chosen: Vec<usize>,
    /// Mean squared error of each size, over the cells that report it.
    pub measured: Vec<Moments>,
    /// What was predicted for these radii; for the best, at the radius that is best in theory.
    pub predicted: Vec<f64>,
    /// What no number of photons takes away; subtracted before the fit.
    pub floors: Vec<f64>,
    /// The exponent.
    pub exponent: Estimate,
    /// The one that the same fit finds in the predictions.
    pub theory: f64,
    /// What it tends to.
    pub limit: (f64, &'static str),
}

impl Curve {
    /// Fits the exponents.
    ///
    /// # Arguments
    /// `sizes` photons of a map; for each of them the place of the radius `chosen`, the squared errors `reported` by cells, what is
    /// `predicted`, and the `floors`
    pub fn new(
        (name, title, limit): (&'static str, String, (f64, &'static str)),
        sizes: &[u64],
        chosen: Vec<usize>,
        reported: &[Vec<f64>],
        predicted: Vec<f64>,
        floors: Vec<f64>,
    ) -> Curve {
        let x: Vec<f64> = sizes.iter().map(|&n| n as f64).collect();
        let cells = reported.iter().map(Vec::len).min().unwrap_or(0);
        let joined: Vec<Vec<f64>> = (0..cells).map(|c| reported.iter().map(|r| r[c]).collect()).collect();
        let above: Vec<f64> = predicted.iter().zip(&floors).map(|(p, f)| p - f).collect();
        Curve {
            name,
            title,
            limit,
            chosen,
            measured: reported.iter().map(|r| r.iter().collect()).collect(),
            exponent: exponent_of_means(&x, &joined, &floors),
            theory: exponent(&x, &above),
            predicted,
            floors,
        }
    }
}

/// The best of some radii for each size, chosen on the even cells, and the squared errors that the odd ones report of it, so that luck
/// in choosing is not taken for accuracy: `ladders` has the squared errors by cells of every radius, for each size.
pub fn best_by_halves(ladders: &[Vec<&[f64]>]) -> (Vec<usize>, Vec<Vec<f64>>) {
    let half = |squares: &[f64], from: usize| -> Vec<f64> {
        squares.iter().skip(from).step_by(2).copied().collect()
    };
    let mean = |squares: &[f64]| {
        let even = half(squares, 0);
        even.iter().sum::<f64>() / even.len().max(1) as f64
    };
    let of_one = |ladder: &Vec<&[f64]>| {
        let means: Vec<f64> = ladder.iter().map(|squares| mean(squares)).collect();
        let place = (0..means.len()).fold(0, |best, i| if means[i] < means[best] { i } else { best });
        (place, half(ladder[place], 1))
    };
    ladders.iter().map(of_one).unzip()
}
