//! An orthonormal frame about a direction.

use glam::DVec3;

/// Right-handed orthonormal frame (x, y, z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub x: DVec3,
    /// Second tangent.
    pub y: DVec3,
    /// The direction the frame was made from.
    pub z: DVec3,
}

impl Frame {
    /// The frame whose third axis is the unit vector `z`; defined for every direction, the poles included.
    ///
    /// Source: Duff et al. 2017, "Building an orthonormal basis, revisited".
    pub fn new(z: DVec3) -> Self {
        let sign = 1.0f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
        let y = DVec3::new(b, sign + z.y * z.y * a, -z.y);
        Frame { x, y, z }
    }

    /// A vector given in this frame, in world coordinates.
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// A vector given in world coordinates, in this frame.
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
}
