//! A vertex of a subpath: where light scatters in a medium or on a diffuse surface.

use super::weights::Ways;
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::geometry::Normals;
use crate::math::{Ray, cosine_pair, exp};
use crate::phase::{Phase, PhaseFunction};
use crate::scene::{Scene, SceneHit, Start, Target};
use crate::surface::Surface;
use crate::transport::{Arrival, Flags};
use glam::DVec3;
use std::f64::consts::PI;

/// Squares of distances are no less \[L^2\]: bodies that touch have points in one place.
pub(super) const NEAREST: f64 = 1e-60;

/// Optical depths that weights take for the largest: behind it a technique counts as hardly any.
const DEEPEST: f64 = 200.0;

/// What scatters.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scatterer<'a> {
    /// A medium, with its albedo and mean extinction there.
    Medium { albedo: Spectrum, sigma_t: f64, phase: &'a Phase },
    /// A diffuse surface: its reflection function [1/sr], and its normals on the side of arrival.
    Surface { fraction: Spectrum, normals: Normals },
}

/// A scattering, before the albedo decides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex<'a> {
    /// Where \[L\].
    pub position: DVec3,
    /// Direction of travel of the subpath as it arrives.
    pub from: DVec3,
    /// Throughput, or power \[W\], as it arrives.
    pub weight: Spectrum,
    /// Number of scatterings of the subpath, this one included.
    pub order: u32,
    /// The body that rays from here start on.
    pub body: Option<Start>,
    /// Number of the interior that it is in.
    pub interior: usize,
    /// What scatters.
    pub scatterer: Scatterer<'a>,
    /// What the weights need.
    pub ways: Ways,
}

impl<'a> Vertex<'a> {
    fn new(arrival: &Arrival, body: Option<Start>, scatterer: Scatterer<'a>) -> Self {
        let walker = arrival.walker;
        Vertex {
            position: arrival.position,
            from: walker.ray.dir,
            weight: walker.weight,
            order: walker.order + 1,
            body,
            interior: walker.interior,
            scatterer,
            ways: Ways::FIRST,
        }
    }

    /// A collision in the medium of this number.
    pub fn in_medium(scene: &'a Scene, arrival: &Arrival, number: usize) -> Self {
        let medium = scene.medium(number);
        let (albedo, sigma_t) = (medium.albedo(arrival.position), medium.sigma_t(arrival.position).mean());
        Vertex::new(arrival, None, Scatterer::Medium { albedo, sigma_t, phase: medium.phase() })
    }

    /// An arrival at a diffuse surface; none at any other body.
    pub fn on_surface(scene: &Scene, arrival: &Arrival, found: &SceneHit) -> Option<Self> {
        let Target::Object(index) = found.target else { return None };
        let Surface::Lambertian(surface) = &scene.objects()[index].surface else { return None };
        let fraction = surface.eval(arrival.position, found.hit.uv);
        let normals = found.hit.normals(arrival.walker.ray.dir);
        Some(Vertex::new(arrival, Some(found.start()), Scatterer::Surface { fraction, normals }))
    }

    /// What kind of event it is.
    pub fn kind(&self) -> Flags {
        match self.scatterer {
            Scatterer::Medium { .. } => Flags::MEDIUM,
            Scatterer::Surface { .. } => Flags::DIFFUSE,
        }
    }

    /// Fraction of the radiance from a direction that a path gathers [1/sr].
    pub fn gathered(&self, towards: DVec3) -> Spectrum {
        match &self.scatterer {
            Scatterer::Medium { albedo, .. } => *albedo * self.pdf(towards),
            Scatterer::Surface { fraction, normals } => *fraction * normals.cosine(towards),
        }
    }

    /// Fraction of a photon's power that leaves into a direction [1/sr].
    pub fn sent(&self, towards: DVec3) -> Spectrum {
        match &self.scatterer {
            Scatterer::Medium { albedo, .. } => *albedo * self.pdf(towards),
            Scatterer::Surface { fraction, normals } => {
                let cosine = towards.dot(normals.geometric).max(0.0);
                *fraction * if planted(Fault::ConnectionCosineForgotten) { cosine.signum() } else { cosine }
            }
        }
    }

    /// Density with which the subpath goes on into a direction [1/sr].
    pub fn pdf(&self, towards: DVec3) -> f64 {
        match &self.scatterer {
            Scatterer::Medium { phase, .. } => {
                let (one_minus_mu, one_plus_mu) = cosine_pair(self.from, towards);
                phase.eval(one_minus_mu, one_plus_mu)
            }
            Scatterer::Surface { normals, .. } => towards.dot(normals.geometric).max(0.0) / PI,
        }
    }

    /// Density with which what comes from a direction is scattered back along the subpath [1/sr].
    pub fn turned(&self, towards: DVec3) -> f64 {
        match &self.scatterer {
            Scatterer::Medium { .. } => self.pdf(towards),
            Scatterer::Surface { normals, .. } => (-self.from.dot(normals.geometric)).max(0.0) / PI,
        }
    }

    /// What makes a density of places, area or volume, of one of directions: the cosine of a ray along `dir`, or the extinction,
    /// times the square of its length.
    pub fn met(&self, dir: DVec3) -> f64 {
        match &self.scatterer {
            Scatterer::Medium { sigma_t, .. } => *sigma_t,
            Scatterer::Surface { normals, .. } => dir.dot(normals.geometric).abs(),
        }
    }

    /// The ways of the vertex that comes behind this one on its subpath, which leaves it along `leaving`.
    pub fn ways_to(&self, scene: &Scene, next: &Vertex, leaving: DVec3, is_direct: bool) -> Ways {
        let (pdf, turned) = (self.pdf(leaving), self.turned(leaving));
        let [here, there] = if is_direct {
            let (distance, between) = self.between(scene, next.position, leaving);
            let flight = between / (distance * distance).max(NEAREST);
            [self.met(leaving) * flight, next.met(next.from) * flight]
        } else {
            [(self, leaving), (next, next.from)].map(|(vertex, dir)| {
                let index = scene.interiors()[vertex.interior].index;
                vertex.met(dir) * index * index
            })
        };
        self.ways.next(pdf * there, here, turned, is_direct)
    }

    /// Distance to a place along a direction \[L\], and about what passes between.
    fn between(&self, scene: &Scene, place: DVec3, dir: DVec3) -> (f64, f64) {
        let distance = self.position.distance(place);
        (distance, self.passes(scene, dir, distance))
    }

    /// About what passes from here up to a distance, through media alone: a function of the two ends, whatever density there is between.
    pub fn passes(&self, scene: &Scene, dir: DVec3, distance: f64) -> f64 {
        if !scene.plan().has_media {
            return 1.0;
        }
        let (mut ray, mut body, mut interior) = (Ray::new(self.position, dir), self.body, self.interior);
        let (mut end, mut depth) = (distance, 0.0);
        while scene.plan().has_matched && depth < DEEPEST {
            let Some(found) = scene.hit(&ray, body).filter(|found| found.hit.t < end) else { break };
            let Some((_, behind)) = scene.straight_on(&ray, &found, interior) else { break };
            depth += depth_about(scene, &ray, found.hit.t, interior);
            (ray, end) = (Ray::new(ray.at(found.hit.t), dir), end - found.hit.t);
            (body, interior) = (Some(found.start()), behind);
        }
        depth += depth_about(scene, &ray, end, interior);
        // Written so that what has no number counts as deep.
        exp(-depth.min(DEEPEST))
    }

    /// Share of the balance heuristic that the connection from this vertex of light to one of the eye has.
    ///
    /// # Arguments
    /// `dir` from the eye's vertex to this one, `distance` between them \[L\]
    pub fn share(&self, scene: &Scene, eye: &Vertex, dir: DVec3, distance: f64) -> f64 {
        let flight = eye.passes(scene, dir, distance) / (distance * distance).max(NEAREST);
        let to_eye = self.pdf(-dir) * eye.met(dir) * flight;
        let to_light = eye.pdf(dir) * self.met(dir) * flight;
        let light = self.ways.others(to_light, self.turned(-dir));
        1.0 / (1.0 + light + eye.ways.others(to_eye, eye.turned(dir)))
    }
}

/// About the optical depth of the first part of a ray \[1\], its mean over channels.
fn depth_about(scene: &Scene, ray: &Ray, end: f64, interior: usize) -> f64 {
    let segments = scene.segments(ray, end, interior);
    segments.iter().map(|s| scene.medium(s.medium).depth_by_bounds(ray, s.interval).mean()).sum()
}

/// Whether a body is a mirror or refracts.
pub(super) fn is_specular(scene: &Scene, found: &SceneHit) -> bool {
    matches!(found.target, Target::Object(index) if scene.objects()[index].surface.is_specular())
}
