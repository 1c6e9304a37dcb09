//! A point light.

use super::emission::emissive;
use super::{LightSample, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::math::{FOUR_PI, Ray, warp};
use glam::DVec3;

/// A point that emits the same intensity in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    position: DVec3,
    power: Spectrum,
}

impl Point {
    /// A light at `position` \[L\] of the given total power \[W\].
    pub fn new(position: DVec3, power: Spectrum) -> Result<Self> {
        if !position.is_finite() {
            return Err(Error::Scene("a point light needs a finite position".into()));
        }
        Ok(Point { position, power: emissive("power", power)? })
    }

    /// Where it is \[L\].
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Intensity [W/sr].
    pub fn intensity(&self) -> Spectrum {
        self.power / FOUR_PI
    }

    pub(super) fn power(&self) -> Spectrum {
        self.power
    }

    pub(super) fn ray(&self, numbers: &PrimarySample) -> Ray {
        Ray::new(self.position, warp::square_to_sphere(numbers.direction).normalize())
    }

    pub(super) fn sample(&self, p: DVec3) -> Option<LightSample> {
        let to_light = self.position - p;
        let d2 = to_light.length_squared();
        if d2 == 0.0 {
            return None;
        }
        let distance = d2.sqrt();
        let value = self.intensity() / d2;
        Some(LightSample { dir: to_light / distance, distance, value, pdf_solid_angle: None })
    }
}
