//! The march of a ray through media: single scattering by shadow rays, the rest from the volume map.

use super::{Eye, Mapper, Report};
use crate::Spectrum;
use crate::estimators::boundary::Boundary;
use crate::estimators::{BeamBlur, RayEnds, RayEstimate, Stretched};
use crate::faults::{Fault, planted};
use crate::integrators::march::{self, LEFT, Source};
use crate::math::{Interval, Positive, Ray, cosine_pair};
use crate::phase::PhaseFunction;
use crate::rng::Stream;
use crate::scene::Target;
use crate::transport::{Passage, Walker, connection, transmittance};
use glam::DVec3;

impl Mapper<'_> {
    /// Light that comes straight from the lights and is scattered at a point against the direction of a walker, over sigma_t
    /// [W/(L^2 sr)]: times sigma_t it is the source of the transfer equation.
    pub(super) fn single(
        &self,
        walker: &Walker,
        position: DVec3,
        number: usize,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let medium = self.scene.medium(number);
        let (phase, dir) = (medium.phase(), walker.ray.dir);
        let here = Walker { ray: Ray::new(position, dir), origin_surface: None, ..*walker };
        let value = |towards: DVec3| {
            let (one_minus_mu, one_plus_mu) = cosine_pair(dir, towards);
            phase.eval(one_minus_mu, one_plus_mu)
        };
        let blind = |stream: &mut Stream| Some(phase.scatter(dir, stream.pair()));
        medium.albedo(position) * self.direct(&here, None, report, stream, value, blind)
    }

    /// The same of all other light, from the photons or beams about the point, and their radius \[L\]; nothing of planes, which are read
    /// along whole rays alone.
    pub(super) fn multiple(
        &self,
        walker: &Walker,
        position: DVec3,
        number: usize,
        report: &mut Report,
    ) -> (Spectrum, f64) {
        let (medium, wo, volume) = (self.scene.medium(number), -walker.ray.dir, &self.settings.volume);
        let boundary = self.boundary(number);
        let (scattered, radius) = if volume.has_planes {
            (Spectrum::ZERO, 0.0)
        } else if let (Some(across), Some(map)) = (volume.of_beams(), &self.maps.beams) {
            let estimate = across.in_scattered(map, (position, wo), (number, medium), &boundary);
            report.volume.add(&estimate, 2);
            (estimate.value, estimate.radius)
        } else if let Some(map) = &self.maps.volume {
            let estimate = volume.in_scattered(map, position, wo, medium.phase(), Spectrum::ONE, &boundary);
            report.volume.add(&estimate, 3);
            // The volume map counts collisions.
            (estimate.value.over(medium.sigma_t(position)), estimate.radius)
        } else {
            (Spectrum::ZERO, 0.0)
        };
        (medium.albedo(position) * scattered, radius)
    }

    /// What a stretch of a ray through a medium brings to its near end of all light that is not direct there, where rays are read as a
    /// whole [W/(L^2 sr)].
    fn along(
        &self,
        (ray, span): (&Ray, Interval),
        number: usize,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let (scene, maps, volume) = (self.scene, self.maps, &self.settings.volume);
        let medium = scene.medium(number);
        let passage = Passage::new(medium, ray, span, stream);
        let boundary = self.extents[number].boundary();
        let (way, passed) = ((ray, span), |t: f64| passage.to(t));
        let mut sum = Spectrum::ZERO;
        if let (Some(along), Some(map)) = (volume.of_rays(), &maps.volume) {
            let estimate = match &self.radii {
                Some(radii) => along.radiance_by_radii((map, radii), way, medium, &boundary, &passed),
                None => along.radiance(map, way, medium, &boundary, &passage),
            };
            report.volume.add_along(along.radius, &estimate);
            sum += estimate.value;
        }
        if let (Some(across), Some(map)) = (volume.of_beams(), &maps.beams) {
            let of = (number, medium);
            let estimate = match volume.beam_blur {
                BeamBlur::OneD => across.radiance(map, way, of, &boundary, &passed),
                // A blur about places is refused where the mapper is checked.
                BeamBlur::TwoD | BeamBlur::ThreeD => across.radiance_in_2d(map, way, of, &boundary, &passed),
            };
            report.volume.add_along(across.radius, &estimate);
            sum += estimate.value;
        }
        if let (Some(planes), Some(map)) = (volume.of_planes(), &maps.planes) {
            let estimate = planes.radiance(map, way, (scene, number), &passed);
            report.volume.add_planes(&estimate, volume.beam_radius.is_some());
            sum += estimate.value;
        }
        sum
    }

    /// The same of a whole ray, where each photon or beam ends for itself, and its radius \[L\]; none where stretches are cut.
    fn of_own_ends(&self, ray: &Ray) -> Option<(RayEstimate, Positive)> {
        let (volume, maps) = (&self.settings.volume, self.maps);
        if volume.ray_ends == RayEnds::Cut {
            return None;
        }
        let of_points = maps.volume.as_ref().map(|map| Stretched::Points(map, self.radii.as_deref()));
        let stored = of_points.or(maps.beams.as_ref().map(Stretched::Beams))?;
        let radius = volume.ray_radius.or(volume.beam_radius)?;
        Some((volume.radiance_of_own_ends(self.scene, stored, ray), radius))
    }

    /// What such stretches bring all along the way to the next body.
    pub(super) fn all_along(
        &self,
        walker: &Walker,
        end: f64,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let segments = self.scene.segments(&walker.ray, end, walker.interior);
        segments.iter().fold(Spectrum::ZERO, |sum, segment| {
            let (span, number) = (segment.interval, segment.medium);
            let seen = transmittance(self.scene, &walker.ray, span.start, walker.interior, stream);
            if !self.scene.medium(number).is_colliding() || seen.max() < LEFT {
                return sum;
            }
            sum + seen * self.along((&walker.ray, span), number, report, stream)
        })
    }

    /// What estimates are told of what is about a medium.
    fn boundary(&self, number: usize) -> Boundary<'_> {
        let boundary = self.extents[number].boundary();
        match self.settings.needs_walls() {
            true => boundary.about(&[]).with_walls(&self.walls),
            false => boundary,
        }
    }
}

impl Mapper<'_> {
    /// The light that a medium scatters once at a point against the direction of a walker, over sigma_t
    /// [W/(L^2 sr)], each light aimed at in its middle: what steps are chosen by. Lights that cannot be aimed at count
    /// nothing.
    fn probed(
        &self,
        walker: &Walker,
        position: DVec3,
        number: usize,
        report: &mut Report,
        stream: &mut Stream,
    ) -> Spectrum {
        let (scene, dir) = (self.scene, walker.ray.dir);
        let medium = scene.medium(number);
        let sum = scene.lights().iter().enumerate().fold(Spectrum::ZERO, |sum, (index, light)| {
            let Some(sample) = light.sample(position, [0.5; 2]) else { return sum };
            let ray = Ray::new(position, sample.dir);
            report.rays.shadow += 1;
            let start = (&ray, None, walker.interior);
            let towards = Some(Target::Light(index));
            let Some(transmitted) = connection(scene, start, sample.distance, towards, stream) else {
                return sum;
            };
            let (one_minus_mu, one_plus_mu) = cosine_pair(dir, sample.dir);
            sum + sample.value * transmitted * medium.phase().eval(one_minus_mu, one_plus_mu)
        });
        medium.albedo(position) * sum
    }
}

impl Eye<'_, '_> {
    /// Adds what media bring to the ray up to distance `end`.
    pub(super) fn march(&mut self, walker: &Walker, end: f64, stream: &mut Stream) {
        let scene = self.mapper.scene;
        if let Some((estimate, radius)) = self.mapper.of_own_ends(&walker.ray) {
            self.report.volume.add_along(radius, &estimate);
            self.layers.multiple += walker.weight * estimate.value;
        }
        for segment in scene.segments(&walker.ray, end, walker.interior).iter() {
            let seen = walker.weight
                * transmittance(scene, &walker.ray, segment.interval.start, walker.interior, stream);
            // Of media that vary it is an estimate of its own for each segment: what one of them says ends no other.
            if seen.max() < LEFT * walker.weight.max() {
                continue;
            }
            self.march_segment(walker, seen, segment.interval, segment.medium, stream);
        }
    }

    /// Marches through a stretch of one medium; `seen` is the weight at its near end.
    fn march_segment(
        &mut self,
        walker: &Walker,
        seen: Spectrum,
        span: Interval,
        number: usize,
        stream: &mut Stream,
    ) {
        let mapper = self.mapper;
        let medium = mapper.scene.medium(number);
        let is_full = mapper.scene.plan().is_full;
        if !medium.is_colliding() && (!is_full || span.end == f64::INFINITY) {
            return;
        }
        let volume = &mapper.settings.volume;
        if volume.reads_rays() && volume.ray_ends == RayEnds::Cut {
            self.layers.multiple +=
                seen * mapper.along((&walker.ray, span), number, &mut self.report, stream);
        }
        let march = &mapper.settings.march;
        let mut source = Fog { eye: self, walker, number, shared: None, radius: 0.0, found: Spectrum::ZERO };
        march::march(medium, (&walker.ray, span), (march, mapper.size), seen, stream, &mut source);
        source.gather();
    }
}

/// A medium on the way of an eye's ray.
struct Fog<'a, 'm, 's> {
    eye: &'a mut Eye<'m, 's>,
    walker: &'a Walker,
    number: usize,
    /// Steps that wait for a gather.
    shared: Option<Shared>,
    /// Radius of the last gather \[L\], and what it found [W/(L^2 sr)].
    radius: f64,
    found: Spectrum,
}

/// Steps that share a gather, at one of their places, chosen in proportion to what counts most of them.
struct Shared {
    /// The place of the first of them.
    first: DVec3,
    /// The chosen place, and what a source there counts for \[1\].
    place: DVec3,
    weight: Spectrum,
    /// Sum of the steps' largest weights.
    sum: f64,
}

impl Fog<'_, '_, '_> {
    /// Lets a step share the gather of those before it if it is near them, else starts another one. Which steps share one depends on
    /// what was read before them alone, so that the sum stays as unbiased as one gather a step.
    fn share(&mut self, place: DVec3, weight: Spectrum, stream: &mut Stream) {
        let reach = self.eye.mapper.settings.spacing * self.radius;
        if self.shared.as_ref().is_some_and(|shared| place.distance(shared.first) >= reach) {
            self.gather();
        }
        let largest = weight.max();
        let Some(shared) = &mut self.shared else {
            self.shared = Some(Shared { first: place, place, weight, sum: largest });
            return;
        };
        shared.sum += largest;
        if stream.unit() * shared.sum < largest {
            (shared.place, shared.weight) = (place, weight);
        }
    }

    /// The gather of all steps that wait for it.
    fn gather(&mut self) {
        let Some(Shared { place, weight, sum, .. }) = self.shared.take() else { return };
        let largest = weight.max();
        if largest > 0.0 {
            let mapper = self.eye.mapper;
            (self.found, self.radius) =
                mapper.multiple(self.walker, place, self.number, &mut self.eye.report);
            let steps = if planted(Fault::SharedForOne) { 1.0 } else { sum / largest };
            self.eye.layers.multiple += weight * self.found * steps;
        }
    }
}

impl Source for Fog<'_, '_, '_> {
    fn take(&mut self, place: DVec3, seen: Spectrum, weight: Spectrum, stream: &mut Stream) -> f64 {
        let mapper = self.eye.mapper;
        self.eye.report.steps += 1;
        let sigma_t = mapper.scene.medium(self.number).sigma_t(place);
        if sigma_t.is_black() && !mapper.scene.plan().is_full {
            return 0.0;
        }
        let weight = seen * sigma_t * weight;
        let single = mapper.single(self.walker, place, self.number, &mut self.eye.report, stream);
        self.eye.layers.single += weight * single;
        // Of rays that are read as a whole it is there already.
        if mapper.settings.volume.reads_rays() {
            return 0.0;
        }
        if mapper.settings.shares_gathers() {
            self.share(place, weight, stream);
        } else {
            (self.found, _) = mapper.multiple(self.walker, place, self.number, &mut self.eye.report);
            self.eye.layers.multiple += weight * self.found;
        }
        self.found.max()
    }

    fn probed(&mut self, place: DVec3, stream: &mut Stream) -> Spectrum {
        self.eye.mapper.probed(self.walker, place, self.number, &mut self.eye.report, stream)
    }
}
