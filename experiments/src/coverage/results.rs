//! What the maps say of p-values.

use super::intervals::Kind;
use super::measure::{MAPS, case, p_names};
use crate::harness::Cells;
use turbid::stats::{KolmogorovSmirnov, kolmogorov_smirnov_test};

/// The p-values of one kind, one a repeat.
pub fn p_values(cells: &Cells, kind: Kind) -> Vec<f64> {
    let names = p_names().filter_map(|name| cells.values(&case(kind, MAPS), &name).ok());
    names.flatten().collect()
}

/// Kolmogorov's distance of the p-values from uniform ones.
pub fn uniformity(cells: &Cells, kind: Kind) -> (KolmogorovSmirnov, usize) {
    let values = p_values(cells, kind);
    (kolmogorov_smirnov_test(&values, |p| p), values.len())
}
