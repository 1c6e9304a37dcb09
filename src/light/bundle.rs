//! Where the photons of a part of a light's numbers go: bundles of rays, for emission towards chosen bodies.

use super::PrimarySample;
use crate::math::{Frame, atan2, warp};
use crate::rng::Stream;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// A box in the unit cube of a light's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmissionCell {
    /// Its lower corner.
    pub low: PrimarySample,
    /// Its upper corner; 1 for the numbers that the light does not need.
    pub high: PrimarySample,
}

impl EmissionCell {
    /// All numbers.
    pub const WHOLE: EmissionCell = EmissionCell {
        low: PrimarySample { position: [0.0; 3], direction: [0.0; 2] },
        high: PrimarySample { position: [1.0; 3], direction: [1.0; 2] },
    };

    /// Its volume: the share of the light's power that it sends out.
    pub fn volume(&self) -> f64 {
        let position = (0..3).map(|i| self.high.position[i] - self.low.position[i]);
        let direction = (0..2).map(|i| self.high.direction[i] - self.low.direction[i]);
        position.chain(direction).product()
    }

    /// Uniform numbers in the cell, as many as are needed of each kind.
    pub fn numbers(&self, (position, direction): (usize, usize), stream: &mut Stream) -> PrimarySample {
        let mut numbers = PrimarySample::default();
        let mut between = |low: f64, high: f64| low + (high - low) * stream.unit();
        for i in 0..position {
            numbers.position[i] = between(self.low.position[i], self.high.position[i]);
        }
        for i in 0..direction {
            numbers.direction[i] = between(self.low.direction[i], self.high.direction[i]);
        }
        numbers
    }

    /// The two numbers in the middle of its directions.
    pub(super) fn direction_middle(&self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.low.direction[i] + self.high.direction[i]))
    }

    /// The three numbers in the middle of its positions.
    pub(super) fn position_middle(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| 0.5 * (self.low.position[i] + self.high.position[i]))
    }
}

/// Rays that start within a ball and go along directions within a cone: all those of a cell, and perhaps more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bundle {
    /// Middle of the starts \[L\].
    pub center: DVec3,
    /// How far starts are from it \[L\].
    pub radius: f64,
    /// Middle of the directions, a unit vector.
    pub axis: DVec3,
    /// Largest angle of a direction to it \[rad\].
    pub angle: f64,
}

/// Angle between two vectors \[rad\].
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    atan2(a.cross(b).length(), a.dot(b))
}

impl Bundle {
    /// Whether a ray of the bundle can meet a ball.
    ///
    /// Exact for the bundle: a ray from a ball of radius a meets a ball of radius b if, and only if, the parallel ray from
    /// the first one's middle can meet a ball of radius a + b about the other's.
    pub fn reaches(&self, center: DVec3, radius: f64) -> bool {
        let (way, both) = (center - self.center, radius + self.radius);
        let distance = way.length();
        distance <= both || angle_between(self.axis, way) <= self.angle + libm::asin(both / distance)
    }
}

/// The cone about the directions of a cell: 1 - cos to the axis of `frame` grows with the first number as `one_minus_mu`
/// says, the second is the azimuth. Returns its axis and half-angle.
///
/// From the middle any of them is reached by half the range of polar angles, then along a parallel.
pub(super) fn cone(cell: &EmissionCell, frame: &Frame, one_minus_mu: impl Fn(f64) -> f64) -> (DVec3, f64) {
    let polar = |u: f64| 2.0 * libm::asin((0.5 * one_minus_mu(u)).clamp(0.0, 1.0).sqrt());
    let (near, far) = (polar(cell.low.direction[0]), polar(cell.high.direction[0]));
    let sine = if near <= FRAC_PI_2 && far >= FRAC_PI_2 {
        1.0
    } else {
        crate::math::sin(near).max(crate::math::sin(far))
    };
    let half = crate::math::sin(0.25 * (near + far));
    let middle = 2.0 * half * half;
    let axis = frame.to_world(warp::direction((middle, 2.0 - middle), cell.direction_middle()[1]));
    let azimuth = PI * (cell.high.direction[1] - cell.low.direction[1]);
    (axis.normalize(), 0.5 * (far - near) + sine * azimuth)
}

/// The disc about the points of a cell on the unit disc, in the frame's plane: the squared distance from the middle grows
/// with the first number, the second is the azimuth. Returns its middle and radius, for a disc of radius 1.
pub(super) fn patch(cell: &EmissionCell, frame: &Frame) -> (DVec3, f64) {
    let (near, far) = (cell.low.position[0].sqrt(), cell.high.position[0].sqrt());
    let middle = 0.5 * (near + far);
    let p = warp::square_to_disc([middle * middle, cell.position_middle()[1]]);
    let azimuth = PI * (cell.high.position[1] - cell.low.position[1]);
    (frame.to_world(DVec3::new(p.x, p.y, 0.0)), 0.5 * (far - near) + far * azimuth)
}

/// One minus the cosine of a direction on the sphere, of a cosine-weighted one on the hemisphere, by its first number.
pub(super) mod by_number {
    /// On the sphere.
    pub fn sphere(u: f64) -> f64 {
        2.0 * u
    }

    /// On the hemisphere, in proportion to the cosine.
    pub fn cosine_hemisphere(u: f64) -> f64 {
        u / (1.0 + (1.0 - u).sqrt())
    }
}
