//! One, two or three dimensions, and the sizes of their unit balls.

use std::f64::consts::PI;

/// The dimension of space in which a kernel lives: beams against rays, photons on surfaces, photons in a medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A line.
    One,
    /// A plane.
    Two,
    /// Space.
    Three,
}

impl Dimension {
    /// All of them.
    pub const ALL: [Dimension; 3] = [Dimension::One, Dimension::Two, Dimension::Three];

    /// The dimension as a number.
    pub fn number(self) -> u32 {
        match self {
            Dimension::One => 1,
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }

    /// Volume V_d of the unit ball: 2, pi, 4 pi/3.
    pub fn ball_volume(self) -> f64 {
        match self {
            Dimension::One => 2.0,
            Dimension::Two => PI,
            Dimension::Three => 4.0 * PI / 3.0,
        }
    }

    /// Area d V_d of the unit sphere: 2, 2 pi, 4 pi.
    pub fn sphere_area(self) -> f64 {
        f64::from(self.number()) * self.ball_volume()
    }

    /// r^d.
    pub(crate) fn power(self, r: f64) -> f64 {
        match self {
            Dimension::One => r,
            Dimension::Two => r * r,
            Dimension::Three => r * r * r,
        }
    }

    /// x^(1/d).
    pub(crate) fn root(self, x: f64) -> f64 {
        match self {
            Dimension::One => x,
            Dimension::Two => x.sqrt(),
            Dimension::Three => libm::cbrt(x),
        }
    }
}
