//! Where rays meet shapes.

use glam::{DVec2, DVec3};

/// Where rays look to tell inside from outside, a unit vector. Its components, as sqrt 2 - 1 to sqrt 3 - 1 to sqrt 5 - 1, are
/// independent over the rationals: it lies in no lattice plane, so that from places on a lattice it meets no edge and no corner
/// of bodies with such coordinates. A ray that touches an edge meets a front and a back there, at once.
pub(crate) const ASLANT: DVec3 =
    DVec3::new(0.277_046_696_451_239_86, 0.489_632_103_568_690_86, 0.826_743_933_234_682_7);

/// Where a ray meets a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray \[L\].
    pub t: f64,
    /// Unit geometric normal: outwards for closed shapes, the front for a rectangle.
    pub normal: DVec3,
    /// Unit normal that light scatters about: the one interpolated between the corners of a smooth mesh, on the outer side
    /// too, and the geometric normal of all else.
    pub shading: DVec3,
    /// Where on the surface: along u and v of a rectangle, around and along a lathe, as the file of a mesh says; 0 on the
    /// other shapes.
    pub uv: DVec2,
    /// Which part of the shape was hit: the triangle of a mesh, the frustum of a lathe, 0 on a shape without parts.
    pub primitive: u32,
}

/// A plane in front of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    /// Unit normal on the side of the point.
    pub normal: DVec3,
    /// Distance of the point \[L\], above 0.
    pub distance: f64,
}

impl Front {
    /// Height above the plane, on the side of the point, of what lies in this direction and distance of it \[L\].
    pub fn height(&self, away: DVec3) -> f64 {
        away.dot(self.normal) + self.distance
    }
}
