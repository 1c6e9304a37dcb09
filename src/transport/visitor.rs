//! Who watches a walk, and what it is told.

use super::{Brightness, Flags, Lobe, Windowed};
use crate::Spectrum;
use crate::math::Ray;
use crate::rng::Stream;
use crate::scene::{SURROUNDINGS, SceneHit, Start};
use glam::DVec3;

/// Where a walk stands: a ray about to be followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// The ray ahead.
    pub ray: Ray,
    /// Power of a photon \[W\], or throughput of a path.
    pub weight: Spectrum,
    /// Number of scatterings so far by media and non-specular surfaces.
    pub order: u32,
    /// What has been met.
    pub flags: Flags,
    /// The body that the ray starts on.
    pub origin_surface: Option<Start>,
    /// Number of the interior that the ray is in.
    pub interior: usize,
    /// Where the direction was sampled \[L\]: a ray starts again behind a filter or an index-matched boundary, on the same way.
    pub sampled_at: DVec3,
    /// Events and boundaries met so far.
    pub events: u32,
    /// Total reflections since it was last scattered, or could cross a boundary.
    pub total_reflections: u32,
    /// Density with which the ray's direction was chosen [1/sr]; none where no other sampler could have chosen it.
    pub pdf_solid_angle: Option<f64>,
}

impl Walker {
    /// A walk that starts along a ray, in the surroundings.
    pub fn new(ray: Ray, weight: Spectrum) -> Self {
        Walker {
            ray,
            weight,
            order: 0,
            flags: Flags::NONE,
            origin_surface: None,
            interior: SURROUNDINGS,
            sampled_at: ray.origin,
            events: 0,
            total_reflections: 0,
            pdf_solid_angle: None,
        }
    }
}

/// An event: the walker as it arrives, before the albedo decides.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<'a> {
    /// The walker, its weight as it arrives.
    pub walker: &'a Walker,
    /// Where \[L\].
    pub position: DVec3,
}

/// What a step of the walk tells its visitor.
#[derive(Debug, Clone, Copy)]
pub enum Step<'a> {
    /// A ray is about to be followed up to the body ahead, if there is one.
    Ahead(Option<&'a SceneHit>),
    /// Light went from the ray's origin to this distance without an event, with this weight.
    Uncollided(f64, Spectrum),
    /// A collision in the medium of this number.
    Collision(Arrival<'a>, usize),
    /// An arrival at a body.
    Surface(Arrival<'a>, &'a SceneHit),
    /// A photon ended at an event: this weight is absorbed there; the number of the medium, if in one.
    Absorbed(Spectrum, Option<usize>),
    /// The weight leaves the scene.
    Escaped(Spectrum),
    /// The weight is followed no further, since nobody asked for higher orders.
    Truncated(Spectrum),
}

/// Who watches a walk.
pub trait Visitor {
    /// Whether it collects what rays meet by themselves, as paths do and photons do not: then directions keep their
    /// densities ([`Walker::pdf_solid_angle`]), and a ray of the limiting order is followed through mirrors and glass.
    const LOOKS_AHEAD: bool = true;

    /// Whether weights are those of radiance, which scales with the squared index of refraction where a photon's power
    /// does not.
    const CARRIES_RADIANCE: bool = Self::LOOKS_AHEAD;

    /// The games by which histories are split and ended on their way, beside roulette; none for most.
    #[inline(always)]
    fn windowed(&self) -> Option<Windowed<'_>> {
        None
    }

    /// The weight, in those that roulette begins at, above which a history flies on in equal parts; infinite for most. Learned directions
    /// may make weights grow at each event, without a bound.
    #[inline(always)]
    fn heaviest(&self) -> f64 {
        f64::INFINITY
    }

    /// The directions that were learned about a place in a medium, to be mixed with those of its phase function; none for most.
    #[inline(always)]
    fn lobe_in_medium(&self, _position: DVec3) -> Option<&Lobe> {
        None
    }

    /// The same on a diffuse surface with this geometric normal, on the side that the history is on.
    #[inline(always)]
    fn lobe_on_surface(&self, _position: DVec3, _normal: DVec3) -> Option<&Lobe> {
        None
    }

    /// How bright places are, for flights to end where it is bright; none for most.
    #[inline(always)]
    fn brightness(&self) -> Option<&Brightness> {
        None
    }

    /// A part of a history that was split off is about to fly on along a ray that was looked along before.
    fn resume(&mut self, _hit: Option<&SceneHit>) {}

    /// One step of the walk.
    fn visit(&mut self, walker: &Walker, step: Step, stream: &mut Stream);
}
