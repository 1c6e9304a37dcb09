//! A diffuse surface.

use super::Texture;
use crate::Spectrum;
use crate::error::Result;
use crate::math::{Frame, warp};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Reflected radiance is the same in all directions: `f_r = reflectance / pi`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lambertian {
    reflectance: Texture,
}

impl Lambertian {
    /// A surface of the given reflectance \[1\], each channel in [0, 1].
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        Ok(Lambertian { reflectance: Texture::constant("reflectance", reflectance)? })
    }

    /// A surface whose reflectance varies from place to place.
    pub fn textured(reflectance: Texture) -> Self {
        Lambertian { reflectance }
    }

    /// The reflectance over the whole surface.
    pub fn texture(&self) -> &Texture {
        &self.reflectance
    }

    /// Fraction of the arriving power that is reflected, at a point \[L\] with these surface parameters.
    pub fn reflectance(&self, position: DVec3, uv: DVec2) -> Spectrum {
        self.reflectance.at(position, uv)
    }

    /// An upper bound of the reflectance, over the whole surface.
    pub fn largest_reflectance(&self) -> Spectrum {
        self.reflectance.brightest()
    }

    /// Reflection function there [1/sr].
    pub fn eval(&self, position: DVec3, uv: DVec2) -> Spectrum {
        self.reflectance(position, uv) / PI
    }

    /// A direction about `normal` with density cos/pi, and that density.
    pub fn scatter(normal: DVec3, u: [f64; 2]) -> (DVec3, f64) {
        let local = warp::square_to_cosine_hemisphere(u);
        (Frame::new(normal).to_world(local), warp::pdf_cosine_hemisphere(local.z))
    }
}
