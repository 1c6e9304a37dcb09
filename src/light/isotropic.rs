//! The same radiance from all directions into a shape.

use super::emission::emissive;
use super::{PeriodicCell, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Face, Shape};
use crate::math::{Frame, Ray, warp};
use crate::rng::Stream;
use glam::DVec3;
use std::f64::consts::PI;

/// Which faces of a slab let the light in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Faces {
    /// The top face: Lambertian incidence on one side.
    Top,
    /// Both faces.
    Both,
}

/// Isotropic incidence: every inward direction brings the same radiance to every point of a convex boundary.
/// A radiance of 1/pi is an irradiance of 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Isotropic {
    shape: Shape,
    faces: Faces,
    radiance: Spectrum,
}

impl Isotropic {
    /// Incidence on a sphere, a cuboid, or faces of a slab, of the given radiance [W/(L^2 sr)].
    pub fn new(shape: Shape, faces: Faces, radiance: Spectrum) -> Result<Self> {
        if !shape.is_solid() {
            return Err(Error::Scene(
                "isotropic incidence needs a convex shape with an inside: a sphere, a cuboid or a slab"
                    .into(),
            ));
        }
        Ok(Isotropic { shape, faces, radiance: emissive("radiance", radiance)? })
    }

    /// The shape that is lit.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The faces of a slab that are lit.
    pub fn faces(&self) -> Faces {
        self.faces
    }

    /// Radiance [W/(L^2 sr)].
    pub fn radiance(&self) -> Spectrum {
        self.radiance
    }

    /// Whether light comes in against a ray that leaves along `dir`.
    pub fn is_lit_against(&self, dir: DVec3) -> bool {
        !matches!(self.shape, Shape::Slab(_)) || self.faces == Faces::Both || dir.z < 0.0
    }

    pub(super) fn power(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        let (_, _, area) = self.shape.sample_boundary(Face::Top, PeriodicCell::side(periodic_cell), [0.0; 3]);
        let faces = if self.has_two_faces() { 2.0 } else { 1.0 };
        self.radiance * (PI * area * faces)
    }

    /// Whether the first number drawn chooses between two faces: it is then the last of the position, which a slab does
    /// not need.
    fn has_two_faces(&self) -> bool {
        matches!(self.shape, Shape::Slab(_)) && self.faces == Faces::Both
    }

    /// The numbers of a photon, the choice of the face drawn first.
    pub(super) fn numbers(&self, stream: &mut Stream) -> PrimarySample {
        let face = self.has_two_faces().then(|| stream.unit());
        let mut position = stream.triple();
        if let Some(face) = face {
            position[2] = face;
        }
        PrimarySample { position, direction: stream.pair() }
    }

    pub(super) fn ray(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Ray {
        let face = if self.has_two_faces() && numbers.position[2] < 0.5 { Face::Bottom } else { Face::Top };
        let (origin, outward, _) =
            self.shape.sample_boundary(face, PeriodicCell::side(periodic_cell), numbers.position);
        let local = warp::square_to_cosine_hemisphere(numbers.direction);
        Ray::new(origin, Frame::new(-outward).to_world(local))
    }
}
