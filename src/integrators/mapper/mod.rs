//! The photon mapper of Jensen and Christensen (1998): radiance along a ray from three photon maps, rays and shadow rays.
//!
//! From the eye the ray is followed through specular surfaces. Media on its way are marched through (`volume`); on the
//! first diffuse surface the radiance is the sum of (`surface`)
//! - direct light, by shadow rays through media and filters;
//! - caustics, from the caustic map;
//! - the rest, by a final gathering into the global map (`gather`), or from the global map where the eye looks: what
//!   the map holds decides which (`Indirect`), so that every class of light is counted once.
//!
//! Lights that no shadow ray can aim at (isotropic incidence, emitting media, volume sources from within the ball about
//! them) are direct light too: one ray in a sampled direction looks for them. Their photons, those of emitting media among
//! them, bring what is neither direct nor scattered once.

mod accepted;
mod extents;
mod gather;
mod settings;
mod surface;
mod volume;

pub use extents::{MediumExtent, medium_extents};
pub use settings::{LEAST_K, Settings, scene_size};

use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::{BeamBlur, Estimate, Estimator, RayEstimate};
use crate::geometry::Shape;
use crate::integrators::path::{Rays, next_event, seen_straight, uncollided};
use crate::integrators::{Layer, Layers};
use crate::light::Light;
use crate::math::{Positive, Ray};
use crate::photons::maps::{Maps, MediumSamples};
use crate::photons::tree::Radii;
use crate::rng::{Stream, Work};
use crate::scene::{Scene, SceneHit, Start, Target};
use crate::transport::{Roulette, Step, Visitor, Walker, emission, transmittance, walk};
use accepted::Bodies;
use glam::DVec3;
use std::ops::AddAssign;

/// Where mirrors have taken nine tenths of the light, rays play roulette. Any value gives the same mean.
const ROULETTE: f64 = 0.1;

/// Look-ups in one map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gathers {
    /// How many.
    pub count: u64,
    /// How many of them found fewer than k photons within the largest radius.
    pub underfull: u64,
    /// Sum of their radii \[L\].
    pub radii: f64,
    /// Sum of the radii of those that found fewer \[L\].
    pub underfull_radii: f64,
    /// Photons or beams found.
    pub found: u64,
    /// Planes across rays, found beside beams or alone.
    pub planes: u64,
    /// Photons found over the radius to the power that they spread in, d, and the same times the radius: their ratio is the mean radius where
    /// photons are, each look-up weighted by the density that it finds.
    pub density: [f64; 2],
    /// How many found photons on a surface of which no line found any: taken for dark.
    pub unknown: u64,
}

impl Gathers {
    /// Counts an estimate from photons that spread in `d` dimensions.
    fn add(&mut self, estimate: &Estimate, d: i32) {
        self.count += 1;
        if estimate.found > 0 && estimate.radius > 0.0 {
            let density = estimate.found as f64 / (0..d).map(|_| estimate.radius).product::<f64>();
            self.density[0] += density;
            self.density[1] += density * estimate.radius;
        }
        self.underfull += u64::from(estimate.underfull);
        self.radii += estimate.radius;
        self.underfull_radii += if estimate.underfull { estimate.radius } else { 0.0 };
        self.found += estimate.found as u64;
    }

    fn add_along(&mut self, radius: Positive, estimate: &RayEstimate) {
        self.count += 1;
        self.radii += radius.get();
        self.found += estimate.found as u64;
    }

    /// Counts planes across a stretch of a ray, which are not another look-up where they stand beside beams.
    fn add_planes(&mut self, estimate: &RayEstimate, is_beside: bool) {
        self.count += u64::from(!is_beside);
        self.planes += estimate.found as u64;
    }

    /// Mean radius where photons are, which few look-ups in their midst weigh more than many far off \[L\]; none where none was found.
    pub fn radius_by_density(&self) -> Option<f64> {
        let [density, radii] = self.density;
        Some(radii / density).filter(|radius| radius.is_finite() && *radius > 0.0)
    }

    /// Mean radius \[L\]; 0 of no look-ups.
    pub fn mean_radius(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.radii / self.count as f64 }
    }
}

impl AddAssign for Gathers {
    fn add_assign(&mut self, other: Gathers) {
        self.count += other.count;
        self.underfull += other.underfull;
        self.radii += other.radii;
        self.underfull_radii += other.underfull_radii;
        self.found += other.found;
        self.planes += other.planes;
        self.density = [0, 1].map(|i| self.density[i] + other.density[i]);
        self.unknown += other.unknown;
    }
}

/// The work behind pictures.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Rays followed, and shadow rays.
    pub rays: Rays,
    /// Rays of final gatherings, among them.
    pub gathering: u64,
    /// Steps of marches.
    pub steps: u64,
    /// Look-ups in the global map.
    pub global: Gathers,
    /// Look-ups in the caustic map.
    pub caustic: Gathers,
    /// Look-ups in the volume map.
    pub volume: Gathers,
    /// Work that the scene may not require.
    pub work: Work,
}

impl AddAssign for Report {
    fn add_assign(&mut self, other: Report) {
        self.rays.segments += other.rays.segments;
        self.rays.shadow += other.rays.shadow;
        self.gathering += other.gathering;
        self.steps += other.steps;
        self.global += other.global;
        self.caustic += other.caustic;
        self.volume += other.volume;
        self.work += other.work;
    }
}

/// A scene, its maps, and how they are read.
#[derive(Debug)]
pub struct Mapper<'a> {
    scene: &'a Scene,
    maps: &'a Maps,
    settings: &'a Settings,
    /// The radii of the volume map's photons about rays, where they are to have one each.
    radii: Option<Box<Radii>>,
    /// Bodies that part photons from a point of a medium, where a rule of the laboratory asks for them.
    walls: Vec<Shape>,
    /// Where surfaces end or are covered, if estimates are to be divided by what is left of their discs.
    bodies: Option<Bodies>,
    /// Where each medium is.
    extents: Vec<MediumExtent>,
    /// How large the scene is \[L\].
    size: f64,
}

impl<'a> Mapper<'a> {
    /// A mapper for a scene and the maps filled from it.
    pub fn new(scene: &'a Scene, maps: &'a Maps, settings: &'a Settings) -> Self {
        let walls = match settings.needs_walls() {
            true => scene.objects().iter().map(|object| object.shape.clone()).collect(),
            false => Vec::new(),
        };
        let bodies = settings.clips_discs.then(|| Bodies::new(scene));
        let extents = medium_extents(scene);
        let Estimator { ray_radius, ray_k, .. } = settings.volume;
        let radii = maps.volume.as_ref().zip(ray_radius.zip(ray_k));
        let radii = radii.map(|(map, (most, k))| Box::new(map.radii(k.get(), most.get())));
        Mapper { scene, maps, settings, radii, walls, bodies, extents, size: scene_size(scene) }
    }

    /// Checks that the maps tell positions apart finely enough for their gathers' radii. Where the k nearest photons lie closer
    /// together than that, as in a focus, a picture goes on: their own errors only spread the light over that distance, far less
    /// than a pixel sees of a scene 10^6 times as large.
    ///
    /// # Errors
    /// `Error::Scene` that says which map, and which radius is allowed; where the volume map holds photons and beams or planes are asked
    /// for, or the other way round; those of [`Estimator::check_ends`]
    pub fn check_radii(&self) -> Result<()> {
        let Maps { global, caustic, volume, beams, planes, .. } = self.maps;
        let is_of_beams = self.settings.volume.beam_radius.is_some();
        if is_of_beams && self.settings.volume.beam_blur == BeamBlur::ThreeD {
            return Err(Error::Scene(
                "rays know no blur of beams in three dimensions; allowed: one, two".into(),
            ));
        }
        let holds_some = volume.is_some() || beams.is_some() || planes.is_some();
        // Beams know how far they go.
        let kinds = |media: MediumSamples| (media.beams().is_some(), media.has_planes());
        if holds_some && kinds(self.maps.media) != kinds(self.settings.media()) {
            return Err(Error::Scene(
                "the volume map does not hold what is to be read of it: photons, beams, or planes; allowed: what it was filled with".into(),
            ));
        }
        self.settings.volume.check_ends(self.scene)?;
        let Settings { global: of_global, caustic: of_caustic, volume: of_volume, .. } = self.settings;
        let radii = [of_global.1.cap(), of_caustic.1.cap(), of_volume.least_named_radius()];
        let maps = [("global", global), ("caustic", caustic), ("volume", volume)];
        for ((name, map), radius) in maps.into_iter().zip(radii) {
            if let Some(map) = map {
                map.check_radius(radius).map_err(|e| e.within(&format!("the {name} map")))?;
            }
        }
        Ok(())
    }

    /// What it looks at.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// One sample of the radiance that arrives at the origin of `ray` from ahead [W/(L^2 sr)], by class, and the work.
    ///
    /// # Arguments
    /// `from` the body that the ray starts on, if it does; `within` the number of the interior that it starts in
    pub fn radiance(
        &self,
        ray: Ray,
        origin_surface: Option<Start>,
        interior: usize,
        stream: &mut Stream,
    ) -> (Layers, Report) {
        let mut eye = Eye { mapper: self, layers: Layers::ZERO, report: Report::default() };
        let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
        walk(self.scene, start, Roulette::below(ROULETTE), Some(0), stream, &mut eye);
        (eye.layers, eye.report)
    }

    /// What a ray meets by itself of media and lights that it runs through, but for lights that are aimed at from `aimed_from`.
    fn met(&self, walker: &Walker, end: f64, aimed_from: Option<DVec3>, stream: &mut Stream) -> Spectrum {
        let scene = self.scene;
        let media = emission(scene, &walker.ray, end, walker.interior, stream);
        let is_aimed = |light: &Light| aimed_from.is_some_and(|p| light.has_direction_from(p));
        let lights = scene.lights().iter().filter(|light| !is_aimed(light));
        lights.fold(media, |sum, light| sum + uncollided(scene, light, walker, end, stream))
    }

    /// Light that arrives at a place straight from all lights, each direction weighted by `scattered`; `walker` says in
    /// which interior. Of lights without direction: what the ray `blind` meets, nothing where there is none.
    fn direct(
        &self,
        walker: &Walker,
        origin_surface: Option<Start>,
        report: &mut Report,
        stream: &mut Stream,
        scattered: impl Fn(DVec3) -> f64,
        blind: impl FnOnce(&mut Stream) -> Option<DVec3>,
    ) -> Spectrum {
        let (position, interior) = (walker.ray.origin, walker.interior);
        let mut sum = Spectrum::ZERO;
        for index in 0..self.scene.lights().len() {
            let place = (position, origin_surface, interior);
            if let Some((sample, received)) = next_event(self.scene, index, place, stream, &mut report.rays) {
                sum += received * scattered(sample.dir);
            }
        }
        let scene = self.scene;
        let is_missed = |light: &Light| !light.has_direction_from(position);
        if (scene.plan().has_emission || scene.lights().iter().any(is_missed))
            && let Some(dir) = blind(stream)
        {
            let ray = Ray::new(position, dir);
            let start = Walker { origin_surface, interior, ..Walker::new(ray, Spectrum::ONE) };
            sum += seen_straight(scene, start, &mut report.rays.segments, stream, |walker, end, stream| {
                self.met(walker, end, Some(position), stream)
            });
        }
        sum
    }
}

/// One sample of the radiance that arrives at the origin of `ray`, which starts in free space in the surroundings
/// [W/(L^2 sr)], by class.
pub fn radiance(scene: &Scene, maps: &Maps, settings: &Settings, ray: Ray, stream: &mut Stream) -> Layers {
    Mapper::new(scene, maps, settings).radiance(ray, None, scene.interior_at(ray.origin), stream).0
}

/// Looks along a ray and on through specular surfaces.
struct Eye<'a, 'm> {
    mapper: &'m Mapper<'a>,
    layers: Layers,
    report: Report,
}

impl Eye<'_, '_> {
    fn look(&mut self, walker: &Walker, hit: Option<&SceneHit>, stream: &mut Stream) {
        let (scene, ray) = (self.mapper.scene, &walker.ray);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        self.report.rays.segments += 1;
        self.layers.emission += walker.weight * self.mapper.met(walker, end, None, stream);
        if scene.plan().has_media {
            self.march(walker, end, stream);
        }
        let Some(found) = hit else {
            for light in scene.lights() {
                if let Some((radiance, _)) = light.background(ray) {
                    let seen = walker.weight * transmittance(scene, ray, end, walker.interior, stream);
                    self.layers.emission += seen * radiance;
                }
            }
            return;
        };
        match found.target {
            Target::Light(index) => {
                let radiance = scene.lights()[index].emitted(ray, &found.hit).0;
                let seen = walker.weight * transmittance(scene, ray, end, walker.interior, stream);
                self.layers[Layer::Emission] += seen * radiance;
            }
            Target::Object(_) => self.surface(walker, found, stream),
        }
    }
}

impl Visitor for Eye<'_, '_> {
    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream) {
        if let Step::Ahead(hit) = step {
            self.look(walker, hit, stream);
        }
    }
}
