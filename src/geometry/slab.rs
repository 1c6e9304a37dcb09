//! An unbounded plane-parallel layer.

use super::Hit;
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// The layer `top <= z <= top + thickness`, without end in x and y. Depth grows with z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    top: f64,
    thickness: f64,
}

/// A face of a slab.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Face {
    /// Smaller z, outward normal -z.
    Top,
    /// Larger z, outward normal +z.
    Bottom,
}

impl Face {
    /// Outward unit normal.
    pub fn normal(self) -> DVec3 {
        match self {
            Face::Top => DVec3::NEG_Z,
            Face::Bottom => DVec3::Z,
        }
    }
}

/// A hit of a plane.
fn plane(t: f64, normal: DVec3) -> Hit {
    Hit { t, normal, shading: normal, uv: DVec2::ZERO, primitive: 0 }
}

impl Slab {
    /// A layer from its upper plane's z and its thickness \[L\].
    pub fn new(top: f64, thickness: f64) -> Result<Self> {
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Err(Error::out_of_range("thickness", thickness, "finite and above 0"));
        }
        if !top.is_finite() {
            return Err(Error::out_of_range("top", top, "finite"));
        }
        Ok(Slab { top, thickness })
    }

    /// z of the upper plane \[L\].
    pub fn top(&self) -> f64 {
        self.top
    }

    /// Thickness \[L\].
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// z of a face \[L\].
    pub fn face(&self, face: Face) -> f64 {
        match face {
            Face::Top => self.top,
            Face::Bottom => self.top + self.thickness,
        }
    }

    /// Distances to the planes of entry and exit along the line, or none for a ray along the planes.
    fn crossings(&self, ray: &Ray) -> Option<(f64, f64)> {
        if ray.dir.z == 0.0 {
            return None;
        }
        let a = (self.top - ray.origin.z) / ray.dir.z;
        let b = (self.top + self.thickness - ray.origin.z) / ray.dir.z;
        Some((a.min(b), a.max(b)))
    }

    pub(super) fn hit(&self, ray: &Ray, from_here: bool) -> Option<Hit> {
        let (t0, t1) = self.crossings(ray)?;
        let along = DVec3::Z * ray.dir.z.signum();
        if from_here {
            // It starts on one plane: either the other one is ahead, or none.
            let middle = self.top + 0.5 * self.thickness;
            let is_inward = (ray.origin.z < middle) == (ray.dir.z > 0.0);
            return is_inward.then_some(plane(t1, along));
        }
        if t0 > 0.0 { Some(plane(t0, -along)) } else { (t1 > 0.0).then_some(plane(t1, along)) }
    }

    pub(super) fn interval(&self, ray: &Ray) -> Option<Interval> {
        match self.crossings(ray) {
            None => self.contains(ray.origin).then_some(Interval { start: 0.0, end: f64::INFINITY }),
            Some((t0, t1)) => (t1 > 0.0).then_some(Interval { start: t0.max(0.0), end: t1 }),
        }
    }

    pub(super) fn contains(&self, p: DVec3) -> bool {
        self.top <= p.z && p.z <= self.top + self.thickness
    }

    pub(super) fn area(&self) -> f64 {
        f64::INFINITY
    }
}
