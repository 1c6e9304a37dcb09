//! What is stored of a photon: exact data, no estimate.

use crate::transport::Flags;
use glam::{DVec3, Vec3};

/// A photon as it arrives at a collision or a surface, before the albedo decides what becomes of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photon {
    /// Where it arrived \[L\].
    pub position: DVec3,
    /// Unit direction of travel.
    pub dir: Vec3,
    /// Unit geometric normal of the surface where it arrived, on the side of its arrival; 0 in a medium.
    pub normal: Vec3,
    /// Power it arrives with \[W\], as though its history were the only one emitted: estimates divide by the
    /// number emitted. On a smooth mesh, times what it counts about the shading normal
    /// ([`Normals::arriving`](crate::geometry::Normals::arriving)).
    pub power: Vec3,
    /// Number of scatterings so far, by media and non-specular surfaces.
    pub order: u16,
    /// What the path met.
    pub flags: Flags,
}
