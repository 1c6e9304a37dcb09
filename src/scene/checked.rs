//! A scene that has been checked: what it holds, and the media along a ray.

use super::bodies::Bodies;
use super::regions::RegionTree;
use super::{Camera, Object, Plan, Region, SURROUNDINGS, SceneParts, Segment, Segments, Sensor, bounds};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::geometry::Sphere;
use crate::light::{Light, PeriodicCell};
use crate::math::{Interval, Ray, exp};
use crate::medium::Medium;
use glam::DVec3;
use std::sync::OnceLock;

/// A scene whose parts have been checked together.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    pub(super) parts: SceneParts,
    pub(super) media: Vec<Medium>,
    pub(super) filling: Vec<Option<usize>>,
    /// Those of the parts, then media that emit.
    pub(super) lights: Vec<Light>,
    /// Whether photons can start wherever media emit.
    pub(super) is_emission_bounded: bool,
    pub(super) light_within: Vec<Option<usize>>,
    /// The interiors that reach out of the scene.
    pub(super) far: Vec<usize>,
    /// Places on dielectric surfaces.
    pub(super) marks: Vec<DVec3>,
    pub(super) bodies: Bodies,
    pub(super) region_tree: Option<RegionTree>,
    pub(super) periodic_cell: Option<PeriodicCell>,
    pub(super) bounds: Option<Sphere>,
    pub(super) plan: Plan,
    pub(super) answers: Answers,
}

/// Answers to questions that are asked of a scene once; scenes that are equal have equal ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Answers {
    /// Whether light ends.
    pub(super) ends: OnceLock<Result<()>>,
    /// Power and its standard error.
    pub(super) power: OnceLock<(Spectrum, Spectrum)>,
}

impl PartialEq for Answers {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Scene {
    /// Asks whether all light in the scene comes to an end, which takes histories of it: the first time only.
    pub(crate) fn once(&self, ask: impl FnOnce() -> Result<()>) -> Result<()> {
        self.answers.ends.get_or_init(ask).clone()
    }

    /// Media and where they are.
    pub fn regions(&self) -> &[Region] {
        &self.parts.regions
    }

    /// Surfaces and where they are.
    pub fn objects(&self) -> &[Object] {
        &self.parts.objects
    }

    /// Lights: those that were named, then media that emit.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Lights that were named.
    pub fn named_lights(&self) -> &[Light] {
        &self.parts.lights
    }

    /// Whether photons can start wherever light does.
    ///
    /// # Errors
    /// [`Error::Unreachable`] if a medium emits that has no end, where no cell stands for it
    pub fn check_emission(&self) -> Result<()> {
        if self.is_emission_bounded {
            return Ok(());
        }
        Err(Error::Unreachable(
            "photons cannot start in a medium that emits and has no end: bound it, name `cell`, or use paths"
                .into(),
        ))
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
    pub fn periodic_cell(&self) -> Option<&PeriodicCell> {
        self.periodic_cell.as_ref()
    }

    /// A sphere about every medium, surface and body of a light; none where one of them has no end, or there is none.
    pub fn bounds(&self) -> Option<&Sphere> {
        self.bounds.as_ref()
    }

    /// The same about all of them that have an end, which a slab has not; none if there is none.
    pub fn bounds_of_bounded(&self) -> Option<Sphere> {
        bounds::of_bounded(&self.parts)
    }

    /// What photons of all lights carry together if none is refused \[W\]: see [`Light::power_bound`].
    pub fn power_bound(&self) -> Spectrum {
        self.lights().iter().fold(Spectrum::ZERO, |sum, light| sum + light.power_bound(self.periodic_cell()))
    }

    /// The stretches of medium on the ray up to distance `end`, nearest first, in the interior of this number: the
    /// regions of the surroundings, or what fills another one, all the way.
    pub fn segments(&self, ray: &Ray, end: f64, interior: usize) -> Segments {
        if interior == SURROUNDINGS {
            return Segments::new(self.regions(), self.region_tree.as_ref(), ray, end);
        }
        let interval = Interval { start: 0.0, end };
        Segments::filled(self.filling(interior).map(|medium| Segment { interval, medium }))
    }

    /// Optical depth up to distance `end` \[1\]: exact but in clouds, where it is a quadrature. Estimates of light use
    /// `transport::transmittance`.
    pub fn optical_depth(&self, ray: &Ray, end: f64, interior: usize) -> Spectrum {
        let mut depth = Spectrum::ZERO;
        for segment in self.segments(ray, end, interior).iter() {
            depth += self.medium(segment.medium).integrated_depth(ray, segment.interval);
        }
        depth
    }

    /// Optical depth of a part of a segment in a homogeneous medium.
    fn depth_of(&self, segment: &Segment, part: Interval) -> Spectrum {
        self.medium(segment.medium).matter().depth(part.length())
    }

    /// Emission collected along a ray from a source of emission coefficient `emission` [W/(L^3 sr)] that fills
    /// `part` of the ray: the integral of emission times transmittance, in closed form. All media are homogeneous.
    pub fn collected(&self, ray: &Ray, part: Interval, interior: usize, emission: Spectrum) -> Spectrum {
        let segments = self.segments(ray, part.end, interior);
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
                let sigma_t = self.medium(segment.medium).matter().sigma_t();
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
