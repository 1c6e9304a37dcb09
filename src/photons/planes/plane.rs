//! What is stored of a flight and a scattering on it: exact data, no estimate.

use crate::photons::beams::Beam;
use glam::DVec3;

/// A flight through a medium, and a direction that it may be scattered into anywhere on it: a parallelogram.
///
/// The second leg ends at an optical depth that was drawn, wherever it starts: what passes is in its length, and a point of the
/// parallelogram is lit if the way there from the first leg is no deeper and nothing stands in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// The flight.
    pub leg: Beam,
    /// Unit direction of travel after the scattering, drawn from the medium's phase function.
    pub dir: DVec3,
    /// Optical depth of the second leg \[1\].
    pub depth: f64,
    /// No second leg is longer \[L\].
    pub reach: f64,
}

impl Plane {
    /// The point at these distances along its legs \[L\].
    pub fn at(&self, [first, second]: [f64; 2]) -> DVec3 {
        self.leg.at(first) + self.dir * second
    }

    /// Lengths of its sides \[L\].
    pub fn sides(&self) -> [f64; 2] {
        [self.leg.length, self.reach]
    }
}
