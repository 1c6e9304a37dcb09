//! Where a ray meets the plane of a parallelogram.

use super::Plane;
use crate::math::Ray;

/// Where a ray meets the plane that both legs lie in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneCrossing {
    /// Distance along the ray \[L\].
    pub along_ray: f64,
    /// Distances along the legs \[L\].
    pub along_legs: [f64; 2],
    /// |d.(w0 x w1)| \[1\], above 0: d the ray, w0 and w1 the legs.
    pub determinant: f64,
}

impl PlaneCrossing {
    /// Cramer's rule for b + t0 w0 + t1 w1 = o + s d, v = o - b: t0 = v.(w1 x d)/D, t1 = w0.(v x d)/D, s = -v.(w0 x w1)/D with
    /// D = d.(w0 x w1). None of a ray in the plane, or of legs along one line.
    pub fn new(ray: &Ray, plane: &Plane) -> Option<Self> {
        let (first, second, away) = (plane.leg.dir, plane.dir, ray.origin - plane.leg.start);
        let normal = first.cross(second);
        let determinant = ray.dir.dot(normal);
        // Its inverse is finite.
        if !determinant.is_normal() {
            return None;
        }
        Some(PlaneCrossing {
            along_ray: -away.dot(normal) / determinant,
            along_legs: [
                away.dot(second.cross(ray.dir)) / determinant,
                first.dot(away.cross(ray.dir)) / determinant,
            ],
            determinant: determinant.abs(),
        })
    }
}
