//! The body and what lights it.

/// Where the light of a cuboid or a duct comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CuboidSource {
    /// Isotropic light of irradiance 1 (radiance 1/pi) on the face x = 0.
    Face,
    /// The same on every face.
    Faces,
    /// Isotropic emission of unit power (of a duct: per mean free path of its length), spread evenly.
    Uniform,
    /// A beam along x of irradiance 1 on the face x = 0.
    Beam,
}

/// A box, or a duct whose third axis is endless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    /// Sides in mean free paths; an endless one counts as 1.
    pub(super) sides: [f64; 3],
    pub(super) endless: bool,
}

impl Body {
    pub(super) fn axes(&self) -> usize {
        if self.endless { 2 } else { 3 }
    }

    pub(super) fn volume(&self) -> f64 {
        self.sides.iter().product()
    }

    /// Area of the face with this normal.
    pub(super) fn face(&self, axis: usize) -> f64 {
        self.volume() / self.sides[axis]
    }

    /// Area of all faces.
    pub(super) fn surface(&self) -> f64 {
        (0..self.axes()).map(|axis| 2.0 * self.face(axis)).sum()
    }
}
