//! The sun: a distant disc of uniform radiance.

use super::bundle::patch;
use super::emission::emissive;
use super::portal::Portal;
use super::spot::one_minus_cos_degrees;
use super::{Bundle, EmissionCell, LightSample, Needs, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Rectangle, Sphere};
use crate::math::{Frame, Ray, cosine_pair, warp};
use glam::DVec3;
use std::f64::consts::PI;

/// A disc of uniform radiance infinitely far away, seen by rays that leave the scene; a disc of no extent is a delta
/// light that lights everything in parallel.
///
/// With angular radius alpha its radiance is irradiance / (pi sin^2 alpha). Photons cross a disc about the middle of the
/// scene, perpendicular to the axis, wide enough for the scene seen from everywhere on the sun: radius R / cos alpha,
/// where R is that of the sphere that holds the scene; their directions are those of the cone, in proportion to the
/// cosine, and their power is irradiance x pi (R / cos alpha)^2.
///
/// With a portal only those of its rays exist whose line crosses a rectangle, as behind a window in a dark wall. Photons
/// cross the portal, and none is lost on the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    frame: Frame,
    irradiance: Spectrum,
    /// 1 - cos of the angular radius.
    one_minus_mu_max: f64,
    /// What photons must cover; none before the light is part of a scene.
    bounds: Option<Sphere>,
    portal: Option<Portal>,
}

impl Sun {
    /// A sun whose light travels along `dir` (of any length but 0), with `irradiance` [W/L^2] on a plane perpendicular
    /// to it, and an angular radius in degrees, 0 or 1e-6 to 45.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange`, naming what is wrong.
    pub fn new(dir: DVec3, irradiance: Spectrum, angular_radius: f64) -> Result<Self> {
        let Some(dir) = dir.try_normalize() else {
            return Err(Error::Scene("a sun needs a finite direction other than 0 0 0".into()));
        };
        if angular_radius != 0.0 && !(1e-6..=45.0).contains(&angular_radius) {
            return Err(Error::out_of_range("angular_radius", angular_radius, "0, or 1e-6 to 45 degrees"));
        }
        Ok(Sun {
            frame: Frame::new(dir),
            irradiance: emissive("irradiance", irradiance)?,
            one_minus_mu_max: one_minus_cos_degrees(angular_radius),
            bounds: None,
            portal: None,
        })
    }

    /// The same sun through a window: of its rays those alone whose line crosses `rectangle`, which they leave by the
    /// front.
    ///
    /// # Errors
    /// `Error::Scene` if a part of the disc is behind the rectangle or sees it edge-on.
    pub fn through(self, rectangle: Rectangle) -> Result<Self> {
        let portal = Portal::new(rectangle, self.frame.z, self.sin2_max().sqrt())?;
        Ok(Sun { portal: Some(portal), ..self })
    }

    /// The same sun, its photons covering a sphere.
    pub fn covering(self, bounds: Sphere) -> Self {
        Sun { bounds: Some(bounds), ..self }
    }

    /// Unit direction of travel of the light from the disc's middle.
    pub fn dir(&self) -> DVec3 {
        self.frame.z
    }

    /// Irradiance at normal incidence [W/L^2].
    pub fn irradiance(&self) -> Spectrum {
        self.irradiance
    }

    /// Whether its light comes through a rectangle alone.
    pub fn has_portal(&self) -> bool {
        self.portal.is_some()
    }

    /// Whether the disc has no extent.
    pub fn is_delta(&self) -> bool {
        self.one_minus_mu_max == 0.0
    }

    /// Squared sine of the angular radius.
    fn sin2_max(&self) -> f64 {
        self.one_minus_mu_max * (2.0 - self.one_minus_mu_max)
    }

    /// Radiance of the disc [W/(L^2 sr)]; it has an extent.
    fn radiance(&self) -> Spectrum {
        self.irradiance / (PI * self.sin2_max())
    }

    /// What photons cover and the radius of the disc that they cross \[L\].
    pub(super) fn disc(&self) -> Option<(Sphere, f64)> {
        self.bounds.map(|bounds| (bounds, bounds.radius() / (1.0 - self.one_minus_mu_max)))
    }

    pub(super) fn power(&self) -> Spectrum {
        let disc = || self.disc().map_or(f64::INFINITY, |(_, radius)| PI * radius * radius);
        self.irradiance * self.portal.map_or_else(disc, |portal| portal.projected_area())
    }

    pub(super) fn needs(&self) -> Needs {
        Needs { position: 2, direction: if self.is_delta() { 0 } else { 2 } }
    }

    /// How far before its disc, or portal, a photon starts \[L\]: outside the sphere that holds the scene, by its radius.
    /// On a line through the disc the sphere reaches R (1 + tan alpha) back at most.
    pub(super) fn run_up(&self) -> f64 {
        let tan = self.sin2_max().sqrt() / (1.0 - self.one_minus_mu_max);
        self.bounds.map_or(0.0, |bounds| {
            self.portal.map_or(bounds.radius() * (2.0 + tan), |portal| portal.run_up(bounds))
        })
    }

    /// Where a photon crosses the disc, or portal \[L\].
    pub(super) fn crossing(&self, u: [f64; 2]) -> DVec3 {
        if let Some(portal) = self.portal {
            return portal.point(u);
        }
        let (center, radius) = self.disc().map_or((DVec3::ZERO, 0.0), |(b, radius)| (b.center(), radius));
        let p = warp::square_to_disc(u) * radius;
        center + self.frame.to_world(DVec3::new(p.x, p.y, 0.0))
    }

    pub(super) fn ray(&self, numbers: &PrimarySample) -> Ray {
        let [u, v] = numbers.direction;
        let dir = if self.is_delta() {
            self.frame.z
        } else if let Some(portal) = self.portal {
            portal.direction([u, v], (self.sin2_max().sqrt(), 1.0 - self.one_minus_mu_max))
        } else {
            // In proportion to the cosine: the squared sine is uniform.
            let sin2 = u * self.sin2_max();
            let one_minus_mu = sin2 / (1.0 + (1.0 - sin2).sqrt());
            self.frame.to_world(warp::direction((one_minus_mu, 2.0 - one_minus_mu), v)).normalize()
        };
        let [a, b, _] = numbers.position;
        Ray::new(self.crossing([a, b]) - dir * self.run_up(), dir)
    }

    pub(super) fn bundle(&self, cell: &EmissionCell) -> Option<Bundle> {
        let (bounds, radius) = self.disc()?;
        let (middle, reach) = if let Some(portal) = self.portal {
            portal.patch(cell)
        } else {
            let (middle, reach) = patch(cell, &self.frame);
            (bounds.center() + middle * radius, reach * radius)
        };
        // A photon starts as far before the disc as the others, along its own direction: a chord away from the axis's.
        let chord = (2.0 * self.one_minus_mu_max).sqrt() * self.run_up();
        Some(Bundle {
            center: middle - self.frame.z * self.run_up(),
            radius: reach + chord,
            axis: self.frame.z,
            angle: libm::asin(self.sin2_max().sqrt()),
        })
    }

    /// Whether the line of a ray is one of those that there are: all without a portal.
    fn has(&self, line: &Ray) -> bool {
        self.portal.is_none_or(|portal| portal.passes(line))
    }

    pub(super) fn sample(&self, p: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let travel = if self.is_delta() {
            self.frame.z
        } else {
            self.frame.to_world(warp::square_to_cone(u, self.one_minus_mu_max)).normalize()
        };
        if !self.has(&Ray::new(p, travel)) {
            return None;
        }
        let (dir, distance) = (-travel, f64::INFINITY);
        if self.is_delta() {
            return Some(LightSample { dir, distance, value: self.irradiance, pdf_solid_angle: None });
        }
        let pdf = warp::pdf_cone(self.one_minus_mu_max);
        Some(LightSample { dir, distance, value: self.radiance() / pdf, pdf_solid_angle: Some(pdf) })
    }

    /// Radiance seen by a ray that leaves the scene [W/(L^2 sr)], and the density with which [`Self::sample`] aims along
    /// it [1/sr]; none beside the disc and beside the portal.
    pub(super) fn background(&self, ray: &Ray) -> Option<(Spectrum, f64)> {
        let (_, one_plus_mu) = cosine_pair(self.frame.z, ray.dir);
        (!self.is_delta() && one_plus_mu <= self.one_minus_mu_max && self.has(ray))
            .then(|| (self.radiance(), warp::pdf_cone(self.one_minus_mu_max)))
    }
}
