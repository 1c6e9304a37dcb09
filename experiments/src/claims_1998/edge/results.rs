//! What the maps say of edges.

use super::{BEHIND, DEPTHS, SIZES, edge_case, wall_case};
use crate::harness::{Cells, Estimate, percent, percent_with_error, signed};
use crate::prediction::Predictions;
use crate::setups::Size;
use turbid::estimators::boundary::Rejection;
use turbid::stats::Moments;

/// One measured number beside its prediction.
pub struct Beside {
    /// Over maps.
    pub measured: Moments,
    /// Before the run.
    pub predicted: f64,
}

impl Beside {
    fn of(cells: &Cells, known: &Predictions, case: &str, quantity: &str) -> anyhow::Result<Self> {
        Ok(Beside { measured: cells.moments(case, quantity)?, predicted: known.get(case, quantity)?.0 })
    }

    pub fn ratio(&self) -> Estimate {
        Estimate::mean(&self.measured).times(1.0 / self.predicted)
    }

    pub fn words(&self) -> String {
        format!(
            "{} % (predicted {})",
            percent_with_error(&self.measured),
            signed(percent(self.predicted), 1).replace('+', "")
        )
    }
}

/// The error below the open edge, and what leaks through the wall.
pub struct Edges {
    /// By size and depth.
    pub edge: Vec<(Size, f64, Beside)>,
    /// By size, rejection and distance.
    pub wall: Vec<(Size, Rejection, f64, Beside)>,
}

impl Edges {
    pub fn read(cells: &Cells, known: &Predictions) -> anyhow::Result<Self> {
        let (mut edge, mut wall) = (Vec::new(), Vec::new());
        for size in SIZES {
            for depth in DEPTHS {
                edge.push((size, depth, Beside::of(cells, known, &edge_case(size, depth), "error")?));
            }
            for rejection in Rejection::ALL {
                for distance in BEHIND {
                    let case = wall_case(size, rejection, distance);
                    wall.push((size, rejection, distance, Beside::of(cells, known, &case, "leak")?));
                }
            }
        }
        Ok(Edges { edge, wall })
    }

    pub fn at_edge(&self, size: Size) -> Option<&Beside> {
        self.edge.iter().find(|e| e.0 == size && e.1 == DEPTHS[0]).map(|e| &e.2)
    }

    pub fn leak(&self, size: Size, rejection: Rejection, distance: f64) -> Option<&Beside> {
        self.wall.iter().find(|w| w.0 == size && w.1 == rejection && w.2 == distance).map(|w| &w.3)
    }
}
