//! Collimated light.

use super::bundle::patch;
use super::emission::emissive;
use super::{Bundle, EmissionCell, LightSample, PeriodicCell, PrimarySample};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::geometry::{Face, Rectangle, Sphere};
use crate::math::{Frame, Interval, Ray, warp};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// The cross-section of a beam, perpendicular to its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section {
    /// Without edge: enters a slab through the whole of one face.
    Unbounded,
    /// A disc about a point.
    Disc {
        /// Where the axis starts \[L\].
        center: DVec3,
        /// Radius \[L\].
        radius: f64,
    },
    /// A rectangle whose front faces along the beam.
    Rectangle(Rectangle),
}

/// Parallel light of the same irradiance over its section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    dir: DVec3,
    irradiance: Spectrum,
    section: Section,
}

impl Beam {
    /// A beam along `dir` (of any length but 0) with `irradiance` [W/L^2] on a plane perpendicular to it.
    pub fn new(dir: DVec3, irradiance: Spectrum, section: Section) -> Result<Self> {
        let Some(dir) = dir.try_normalize() else {
            return Err(Error::Scene("a beam needs a finite direction other than 0 0 0".into()));
        };
        match section {
            Section::Unbounded => {}
            Section::Disc { center, radius } => {
                Sphere::new(center, radius)?;
            }
            // The rectangle's own rounding: its normal is a cross product of two rounded edges.
            Section::Rectangle(r) if (r.normal() - dir).length() > 1e-12 => {
                return Err(Error::Scene("a beam's rectangle lies across it, with its front ahead; allowed: u and v whose cross product is along dir".into()));
            }
            Section::Rectangle(_) => {}
        }
        Ok(Beam { dir, irradiance: emissive("irradiance", irradiance)?, section })
    }

    /// Unit direction of travel.
    pub fn dir(&self) -> DVec3 {
        self.dir
    }

    /// Irradiance on a perpendicular plane [W/L^2].
    pub fn irradiance(&self) -> Spectrum {
        self.irradiance
    }

    /// Cross-section.
    pub fn section(&self) -> Section {
        self.section
    }

    /// The face that an unbounded beam enters.
    fn entry(&self) -> Face {
        if self.dir.z > 0.0 { Face::Top } else { Face::Bottom }
    }

    pub(super) fn power(&self, periodic_cell: Option<&PeriodicCell>) -> Spectrum {
        let area = match (self.section, periodic_cell) {
            (Section::Unbounded, Some(periodic_cell)) => {
                periodic_cell.side.x * periodic_cell.side.y * self.dir.z.abs()
            }
            (Section::Unbounded, None) => f64::INFINITY,
            (Section::Disc { radius, .. }, _) => PI * radius * radius,
            (Section::Rectangle(r), _) => r.area(),
        };
        self.irradiance * area
    }

    pub(super) fn ray(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Ray {
        let u = [numbers.position[0], numbers.position[1]];
        let origin = match (self.section, periodic_cell) {
            (Section::Unbounded, periodic_cell) => {
                let (side, z) =
                    periodic_cell.map_or((DVec2::ZERO, 0.0), |s| (s.side, s.slab.face(self.entry())));
                DVec3::new(u[0] * side.x, u[1] * side.y, z)
            }
            (Section::Disc { center, radius }, _) => {
                let p = warp::square_to_disc(u) * radius;
                center + Frame::new(self.dir).to_world(DVec3::new(p.x, p.y, 0.0))
            }
            (Section::Rectangle(r), _) => r.sample(u),
        };
        Ray::new(origin, self.dir)
    }

    pub(super) fn bundle(&self, cell: &EmissionCell) -> Option<Bundle> {
        let (center, radius) = match self.section {
            Section::Unbounded => return None,
            Section::Disc { center, radius } => {
                let (middle, reach) = patch(cell, &Frame::new(self.dir));
                (center + middle * radius, reach * radius)
            }
            Section::Rectangle(r) => {
                let [a, b] = [cell.low.position, cell.high.position].map(|[u, v, _]| r.sample([u, v]));
                (0.5 * (a + b), 0.5 * a.distance(b))
            }
        };
        Some(Bundle { center, radius, axis: self.dir, angle: 0.0 })
    }

    /// How far back along the beam its section lies, or none outside the beam.
    pub(super) fn distance_back(&self, p: DVec3) -> Option<f64> {
        match self.section {
            Section::Unbounded => Some(f64::INFINITY),
            Section::Disc { center, radius } => {
                let v = p - center;
                let along = v.dot(self.dir);
                let off = v - self.dir * along;
                (along >= 0.0 && off.length_squared() <= radius * radius).then_some(along)
            }
            // By its plane, not by a hit: points on the section itself are lit too, as those of a disc are.
            Section::Rectangle(r) => Some(r.height(p)).filter(|along| *along >= 0.0 && r.covers(p)),
        }
    }

    /// The part of a ray that the beam lights, within its sides and not before its section; none too of an unbounded beam,
    /// which has no sides.
    pub fn interval(&self, ray: &Ray) -> Option<Interval> {
        match self.section {
            Section::Unbounded => None,
            Section::Disc { center, radius } => {
                let from = ray.origin - center;
                let (along, slope) = (from.dot(self.dir), ray.dir.dot(self.dir));
                let (off, across) = (from - self.dir * along, ray.dir - self.dir * slope);
                let square = across.length_squared();
                let inside = if square > 0.0 {
                    let nearest = -off.dot(across) / square;
                    let left = radius * radius - (off + across * nearest).length_squared();
                    let half = (left.max(0.0) / square).sqrt();
                    Interval { start: nearest - half, end: nearest + half }
                } else {
                    Interval::of_positive(radius - off.length(), 0.0)
                };
                let ahead = Interval { start: 0.0, end: f64::INFINITY };
                inside.intersection(Interval::of_positive(along, slope))?.intersection(ahead)
            }
            Section::Rectangle(r) => r.above(ray),
        }
    }

    /// How far a point is from the edge of the space that the beam lights, its section and sides, across which the
    /// fluence jumps \[L\].
    pub(crate) fn distance_to_edge(&self, p: DVec3) -> f64 {
        // Along the beam, and how far inside its section; negative before it and beside it.
        let (along, inside) = match self.section {
            Section::Unbounded => return f64::INFINITY,
            Section::Disc { center, radius } => {
                let v = p - center;
                let along = v.dot(self.dir);
                (along, radius - (v - self.dir * along).length())
            }
            Section::Rectangle(r) => (r.height(p), r.inside(p)),
        };
        if along >= 0.0 && inside >= 0.0 {
            along.min(inside)
        } else {
            libm::hypot(along.min(0.0), inside.min(0.0))
        }
    }

    pub(super) fn sample(&self, p: DVec3) -> Option<LightSample> {
        let distance = self.distance_back(p)?;
        Some(LightSample { dir: -self.dir, distance, value: self.irradiance, pdf_solid_angle: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside, beside, before and diagonally before a beam along z whose section is 2 wide.
    #[test]
    fn the_edge_is_where_light_ends() {
        let corner = DVec3::new(-1.0, -1.0, 0.0);
        let square = Rectangle::new(corner, DVec3::X * 2.0, DVec3::Y * 2.0).unwrap();
        let disc = Section::Disc { center: DVec3::ZERO, radius: 1.0 };
        for section in [Section::Rectangle(square), disc] {
            let beam = Beam::new(DVec3::Z, Spectrum::ONE, section).unwrap();
            for (x, z, distance) in
                [(0.25, 2.0, 0.75), (0.0, 0.5, 0.5), (1.0, 2.0, 0.0), (3.0, 2.0, 2.0), (0.0, -2.0, 2.0)]
            {
                assert!((beam.distance_to_edge(DVec3::new(x, 0.0, z)) - distance).abs() < 1e-14, "{x} {z}");
            }
            assert!((beam.distance_to_edge(DVec3::new(4.0, 0.0, -4.0)) - 5.0).abs() < 1e-14);
        }
        let corner = Beam::new(DVec3::Z, Spectrum::ONE, Section::Rectangle(square)).unwrap();
        assert!((corner.distance_to_edge(DVec3::new(4.0, 5.0, 1.0)) - 5.0).abs() < 1e-14);
    }
}
