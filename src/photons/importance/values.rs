//! What photons are worth where.

use super::grid::{Aim, DIRECTIONS, Grid};
use crate::photons::Emitter;

/// The importance map of a scene and its camera: how photons leave the lights, and what they are worth where.
#[derive(Debug, Clone)]
pub struct Importance {
    pub(super) grid: Grid,
    pub(super) aim: Aim,
    /// By box and direction: what a photon that leaves it scores, over its weight; never 0.
    pub(super) values: Vec<f64>,
    /// What a whole emission scores \[W\].
    pub(super) response: f64,
    pub(super) emitter: Emitter,
}

impl Importance {
    /// How photons leave the lights.
    pub fn emitter(&self) -> &Emitter {
        &self.emitter
    }

    /// Values of the directions in which a photon may leave `p`.
    pub(super) fn values_at(&self, p: glam::DVec3) -> &[f64] {
        let start = self.grid.index(p) * DIRECTIONS;
        &self.values[start..start + DIRECTIONS]
    }
}
