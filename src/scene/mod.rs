//! The scene: a plain struct, validated once and trusted after; what a ray meets in it; what it requires.

mod builtin;
mod camera;
mod file;
mod plan;
mod segments;
mod sensor;
mod validate;

pub use builtin::{BUILTIN, Builtin};
pub use camera::{Camera, Filter, MAX_SIDE, View};
pub use file::SceneFile;
pub use plan::Plan;
pub use segments::{MAX_REGIONS, Segment, Segments};
pub use sensor::{Orders, Quantity, Sensor};

use crate::Spectrum;
use crate::error::Result;
use crate::faults::{Fault, planted};
use crate::geometry::Shape;
use crate::light::{Light, Stage};
use crate::math::{Interval, Ray, exp};
use crate::medium::Medium;
use crate::surface::Surface;
use glam::DVec3;

/// A medium and the shape it fills; its boundary is index-matched and no event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Where it is.
    pub shape: Shape,
    /// What it is.
    pub medium: Medium,
}

/// A surface on a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Object {
    /// Where it is.
    pub shape: Shape,
    /// How it reflects.
    pub surface: Surface,
}

/// What a scene is made of, before it is checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    /// Media; where shapes overlap, the later one counts.
    pub regions: Vec<Region>,
    /// Surfaces.
    pub objects: Vec<Object>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Side of the square cell that stands for an unbounded slab \[L\].
    pub cell: Option<f64>,
    /// What is measured.
    pub sensors: Vec<Sensor>,
    /// Who looks, if anybody does.
    pub camera: Option<Camera>,
}

/// A scene whose parts have been checked together.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    parts: Parts,
    stage: Option<Stage>,
    plan: Plan,
}

/// A body that a ray can meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The object of this index.
    Object(usize),
    /// The light of this index.
    Light(usize),
}

/// The nearest body on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneHit {
    /// Which body.
    pub target: Target,
    /// Where, and its normal.
    pub hit: crate::geometry::Hit,
}

impl Scene {
    /// A scene from its parts.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange`, naming the part, where parts do not fit together.
    pub fn new(parts: Parts) -> Result<Self> {
        let stage = validate::check(&parts)?;
        let plan = Plan::of(&parts);
        Ok(Scene { parts, stage, plan })
    }

    /// Media and where they are.
    pub fn regions(&self) -> &[Region] {
        &self.parts.regions
    }

    /// Surfaces and where they are.
    pub fn objects(&self) -> &[Object] {
        &self.parts.objects
    }

    /// Lights.
    pub fn lights(&self) -> &[Light] {
        &self.parts.lights
    }

    /// What is measured.
    pub fn sensors(&self) -> &[Sensor] {
        &self.parts.sensors
    }

    /// The camera, if the scene has one.
    pub fn camera(&self) -> Option<&Camera> {
        self.parts.camera.as_ref()
    }

    /// What the scene requires of the simulator.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The slab and its cell, where the scene has a cell.
    pub fn stage(&self) -> Option<&Stage> {
        self.stage.as_ref()
    }

    /// Power of all lights \[W\].
    pub fn power(&self) -> Spectrum {
        self.lights().iter().fold(Spectrum::ZERO, |sum, light| sum + light.power(self.stage()))
    }

    /// Index of the region that counts at a point; none in vacuum.
    pub fn region_at(&self, p: DVec3) -> Option<usize> {
        self.regions().iter().rposition(|r| r.shape.contains(p))
    }

    /// The medium at a point; none in vacuum.
    pub fn medium_at(&self, p: DVec3) -> Option<&Medium> {
        self.region_at(p).map(|index| &self.regions()[index].medium)
    }

    /// The nearest body ahead; `from` is the body that the ray starts on.
    pub fn hit(&self, ray: &Ray, from: Option<Target>) -> Option<SceneHit> {
        let mut nearest: Option<SceneHit> = None;
        let mut consider = |target, hit: Option<crate::geometry::Hit>| {
            if let Some(hit) = hit
                && nearest.is_none_or(|n| hit.t < n.hit.t)
            {
                nearest = Some(SceneHit { target, hit });
            }
        };
        for (i, object) in self.objects().iter().enumerate() {
            let target = Target::Object(i);
            consider(target, object.shape.hit(ray, from == Some(target)));
        }
        for (i, light) in self.lights().iter().enumerate() {
            let target = Target::Light(i);
            // Light leaves a light's body outwards, so a ray that starts on it never meets it again.
            if from != Some(target) {
                consider(target, light.hit(ray));
            }
        }
        nearest
    }

    /// The stretches of medium on the ray up to distance `end`, nearest first.
    pub fn segments(&self, ray: &Ray, end: f64) -> Segments {
        Segments::new(self.regions(), ray, end)
    }

    /// Optical depth up to distance `end` \[1\].
    pub fn optical_depth(&self, ray: &Ray, end: f64) -> Spectrum {
        let mut depth = Spectrum::ZERO;
        for segment in self.segments(ray, end).iter() {
            depth += self.depth_of(segment, segment.interval);
        }
        depth
    }

    /// Optical depth of a part of a segment: 0 where nothing extinguishes, however long the part.
    fn depth_of(&self, segment: &Segment, part: Interval) -> Spectrum {
        self.regions()[segment.region]
            .medium
            .sigma_t()
            .map(|s| if s == 0.0 { 0.0 } else { s * part.length() })
    }

    /// Fraction of the light that passes up to distance `end` without a collision \[1\].
    pub fn transmittance(&self, ray: &Ray, end: f64) -> Spectrum {
        decay(self.optical_depth(ray, end))
    }

    /// Whether no body stands between the ray's origin and distance `end`, except the body at the far end.
    pub fn is_clear(&self, ray: &Ray, from: Option<Target>, end: f64, towards: Target) -> bool {
        match self.hit(ray, from) {
            None => true,
            Some(found) => found.target == towards || found.hit.t >= end,
        }
    }

    /// Emission collected along a ray from a source of emission coefficient `emission` [W/(L^3 sr)] that fills
    /// `part` of the ray: the integral of emission times transmittance, in closed form.
    pub fn collected(&self, ray: &Ray, part: Interval, emission: Spectrum) -> Spectrum {
        let segments = self.segments(ray, part.end);
        let (mut depth, mut cursor, mut sum) = (Spectrum::ZERO, part.start, Spectrum::ZERO);
        for segment in segments.iter() {
            let before = Interval { start: cursor, end: segment.interval.start.min(part.end) };
            if before.length() > 0.0 {
                sum += decay(depth) * before.length();
                cursor = before.end;
            }
            let outside =
                Interval { start: segment.interval.start, end: segment.interval.end.min(part.start) };
            depth += self.depth_of(segment, outside);
            let inside = Interval { start: segment.interval.start.max(cursor), end: segment.interval.end };
            let length = inside.length();
            if length > 0.0 {
                let sigma_t = self.regions()[segment.region].medium.sigma_t();
                let path =
                    sigma_t.map(|s| if s == 0.0 { length } else { -crate::math::exp_m1(-s * length) / s });
                sum += decay(depth) * path;
                depth += self.depth_of(segment, inside);
                cursor = inside.end;
            }
        }
        if part.end > cursor {
            sum += decay(depth) * (part.end - cursor);
        }
        sum * emission
    }
}

/// `exp(-depth)` by channel, with one exponential where the channels are equal.
pub fn decay(depth: Spectrum) -> Spectrum {
    if planted(Fault::TransmittanceUnderflows) {
        return depth.map(|d| f64::from(exp(-d) as f32));
    }
    if depth.is_grey() { Spectrum::grey(exp(-depth[0])) } else { depth.map(|d| exp(-d)) }
}
