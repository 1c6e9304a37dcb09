//! Choice among entries by their sums.

/// What is left of a number that chose an entry from sums: where between its own sum and the one before, in [0, 1).
pub(crate) fn remainder(sums: &[f64], index: usize, target: f64) -> f64 {
    let before = if index > 0 { sums[index - 1] } else { 0.0 };
    ((target - before) / (sums[index] - before)).clamp(0.0, 1.0 - f64::EPSILON)
}
