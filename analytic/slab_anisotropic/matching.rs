//! Amplitudes of the modes from the light that enters at the faces.

use super::modes::Modes;
use crate::work;
use libm::{exp, tanh};
use nalgebra::{DMatrix, DVector};

/// tanh(k tau/2)/k.
pub(super) fn half_width(k: f64, tau: f64) -> f64 {
    if k * tau == 0.0 { 0.5 * tau } else { tanh(0.5 * k * tau) / k }
}

/// The matrix of columns p_j a(k_j) + q_j b(k_j).
pub(crate) fn columns(modes: &Modes, a: impl Fn(f64) -> f64, b: impl Fn(f64) -> f64) -> DMatrix<f64> {
    let n = modes.nodes.len();
    work::add(n * n * n / 3);
    let mut matrix = DMatrix::zeros(n, n);
    for (j, &k) in modes.k.iter().enumerate() {
        matrix.set_column(j, &(modes.even.column(j) * a(k) + modes.odd.column(j) * b(k)));
    }
    matrix
}

/// The even half sees the sum of both faces, the odd half their difference.
pub(super) fn match_halves(
    modes: &Modes,
    tau: f64,
    top: &DVector<f64>,
    bottom: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let even = columns(modes, |_| 1.0, |k| k * tanh(0.5 * k * tau));
    let odd = columns(modes, |k| half_width(k, tau), |_| 1.0);
    let first = even.lu().solve(&((top + bottom) * 0.5))?;
    let second = odd.lu().solve(&((bottom - top) * 0.5))?;
    Some((first, second))
}

/// Light goes to and fro between the faces, each passage dimmed by e^(-k tau) at least: passages are added until
/// twice as many have gone as rounding would need.
pub(super) fn match_faces(
    modes: &Modes,
    tau: f64,
    top: &DVector<f64>,
    bottom: &DVector<f64>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let leaving = columns(modes, |_| 1.0, |k| k).lu();
    let arriving = columns(modes, |k| exp(-k * tau), |k| -k * exp(-k * tau));
    let mut first = leaving.solve(top)?;
    let mut second = leaving.solve(&(bottom - &arriving * &first))?;
    let mut passages = 2.0 * -libm::log(f64::EPSILON) / (modes.slowest() * tau);
    while passages > 0.0 {
        first = leaving.solve(&(top - &arriving * &second))?;
        second = leaving.solve(&(bottom - &arriving * &first))?;
        passages -= 2.0;
    }
    Some((first, second))
}

/// In a half-space nothing comes back.
pub(super) fn match_deep(modes: &Modes, top: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
    let first = columns(modes, |_| 1.0, |k| k).lu().solve(top)?;
    Some((first, DVector::zeros(top.len())))
}
