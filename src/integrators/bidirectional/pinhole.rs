//! The camera as the last vertex of a path: the technique that connects photons to it, and what it is worth beside the others.

use super::vertex::{NEAREST, Vertex};
use super::weights::Ways;
use crate::scene::{Camera, Scene};
use glam::{DVec2, DVec3};

/// A camera, each of whose pixels has one path where so many photons are connected to it.
#[derive(Debug, Clone, Copy)]
pub struct Pinhole<'a> {
    camera: &'a Camera,
    photons: f64,
}

impl<'a> Pinhole<'a> {
    /// A camera with this number of photons to a path of each pixel.
    pub fn new(camera: &'a Camera, photons: u64) -> Self {
        Pinhole { camera, photons: photons as f64 }
    }

    /// Where a place is seen, in raster coordinates; the direction from it to the camera, and the distance \[L\]. None where it is not.
    pub(super) fn look(&self, place: DVec3) -> Option<(DVec2, DVec3, f64)> {
        let at = self.camera.project(place).filter(|at| self.camera.is_near(*at))?;
        let to_camera = self.camera.position() - place;
        let distance = to_camera.length();
        Some((at, to_camera / distance, distance))
    }

    /// What irradiance across a ray counts as radiance of a pixel, for power that is sent along the ray \[1/(L^2 sr)\]: see
    /// [`crate::integrators::light_tracing`].
    pub(super) fn irradiance_to_radiance(&self, dir: DVec3, distance: f64) -> f64 {
        let cosine = -dir.dot(self.camera.forward());
        1.0 / ((distance * distance).max(NEAREST) * self.camera.pixel_area() * cosine * cosine * cosine)
    }

    /// Density with which the paths of a pixel choose a vertex that lies in direction `-dir` from the camera, over the number of photons.
    pub(super) fn pdf(&self, scene: &Scene, vertex: &Vertex, dir: DVec3) -> f64 {
        let distance = vertex.position.distance(self.camera.position());
        let passes = vertex.passes(scene, dir, distance);
        vertex.met(dir) * passes * self.irradiance_to_radiance(dir, distance) / self.photons
    }

    /// The ways of a first vertex that the camera sees straight.
    pub(super) fn ways(&self, scene: &Scene, vertex: &Vertex) -> Ways {
        Ways { pdf: self.pdf(scene, vertex, -vertex.from), connected: 1.0, beyond: 0.0 }
    }
}
