//! Free flights that end where photons say it is bright.
//!
//! A flight ends with a collision or at the body ahead, and what a path finds there differs: under the lamp light is scattered that
//! the far corner has not. The media ahead are cut into pieces; with the probability P of a flight to end in one, and the brightness b
//! that photons tell of it, it ends there with the probability P (share b/B + 1 - share), B the mean of b by P, and the weight is
//! divided by the bracket: at most 1/(1 - share). Within a piece flights are what they are. A surface behind the media is as bright as
//! photons tell of it; one that they tell nothing of, as a specular one, keeps its probability.
//!
//! # Source
//! Herholz et al. 2019, "Volume path guiding based on zero-variance random walk theory", guide distances by the same products of
//! transmittance and learned light, collision by collision; pieces that keep free flights within are turbid's own.

use super::flight::{Flight, choose, collision, uncollided};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::math::{Interval, Ray, exp_m1, ln_1p, wrap};
use crate::rng::Stream;
use crate::scene::{Scene, SceneHit, Segment, Segments, Target, decay};
use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// Cells along an edge of a grid.
const SIDE: usize = 8;
/// Cells of a grid.
pub const CELLS: usize = SIDE * SIDE * SIDE;
/// Pieces of one stretch of medium, the last beyond [`FAR`] where it is longer.
const PIECES: usize = 4;
/// Stretches of medium on a ray that flies this way, at most.
const STRETCHES: usize = 4;
/// Mean free paths that are cut into pieces of the same length.
const FAR: f64 = 6.0;
/// Part of the largest brightness on its way below whose mean a flight keeps its own end: where light is bright only where no flight comes.
const FAINT: f64 = 1e-30;

/// How bright it is about every place of a box; outside as at its border.
#[derive(Debug, Clone, PartialEq)]
pub struct BrightnessGrid {
    low: DVec3,
    /// Cells per length along each axis [1/L].
    scale: DVec3,
    /// By cell, x fastest.
    values: Box<[f64]>,
}

impl BrightnessGrid {
    /// A dark grid over a box.
    pub fn new(low: DVec3, high: DVec3) -> Self {
        // A flat box, and a point, have some thickness still.
        let largest = (high - low).abs().max(low.abs()).max(high.abs()).max_element();
        let extent = (high - low).max(DVec3::splat(if largest > 0.0 { 1e-6 * largest } else { 1.0 }));
        BrightnessGrid { low, scale: SIDE as f64 / extent, values: vec![0.0; CELLS].into() }
    }

    /// Cells per length along each axis [1/L].
    pub fn scale(&self) -> DVec3 {
        self.scale
    }

    /// Makes the cell of a place brighter.
    pub fn add(&mut self, p: DVec3, brightness: f64) {
        self.values[self.cell(p)] += brightness;
    }

    fn cell(&self, p: DVec3) -> usize {
        const LAST: i32 = SIDE as i32 - 1;
        // Casts take what is too large or small for them to their ends.
        let [x, y, z] =
            ((p - self.low) * self.scale).to_array().map(|at| (at as i32).clamp(0, LAST) as usize);
        (z * SIDE + y) * SIDE + x
    }

    /// How bright it is about a place.
    pub fn at(&self, p: DVec3) -> f64 {
        self.values[self.cell(p)]
    }
}

/// How bright places are, for flights to end there: radiance scattered by a medium of albedo 1, or reflected by a surface of
/// reflectance 1, but for a factor that all share.
#[derive(Debug, Clone, PartialEq)]
pub struct Brightness {
    /// The share of flights that end by it.
    pub share: f64,
    /// In media.
    pub media: BrightnessGrid,
    /// On surfaces.
    pub surfaces: BrightnessGrid,
    /// Sides of the cell that the scene repeats, if it does \[L\].
    pub period: Option<DVec2>,
}

/// The ways in which a flight may end: in each of the pieces of media, nearest first, and beyond them all.
#[derive(Debug, Clone)]
pub struct Ends {
    /// The probability of a flight's own, and how bright it is there.
    ways: [(f64, f64); PIECES * STRETCHES + 1],
    count: usize,
    /// Mean brightness by these probabilities.
    mean: f64,
}

impl Ends {
    /// The probability of a flight's own for each way, and how bright it is there.
    pub fn ways(&self) -> &[(f64, f64)] {
        &self.ways[..self.count]
    }

    /// Mean brightness by these probabilities.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// By how much more often a share of the flights makes all of them end where it is so bright.
    pub fn more_often(&self, brightness: f64, share: f64) -> f64 {
        share * brightness / self.mean + (1.0 - share)
    }

    fn add(&mut self, own: f64, brightness: f64) {
        self.ways[self.count] = (own, brightness);
        self.count += 1;
        self.mean += own * brightness;
    }

    /// The number of a way, and where in it \[0, 1).
    fn choose(&self, share: f64, u: f64) -> (usize, f64) {
        let (mut u, scale) = (u, share / self.mean);
        for (number, (own, brightness)) in self.ways().iter().enumerate() {
            let chance = own * (brightness * scale + (1.0 - share));
            if u < chance {
                return (number, u / chance);
            }
            u -= chance;
        }
        // Rounding leaves next to nothing over: the last one that a flight can end by.
        let last = self.ways().iter().rposition(|(own, _)| *own > 0.0);
        (last.unwrap_or(0), 0.5)
    }
}

/// A stretch of medium cut into pieces.
#[derive(Debug, Clone, Copy)]
struct Pieces {
    /// Where the first begins on the ray \[L\].
    start: f64,
    /// The length of each but the last, and of that \[L\].
    lengths: [f64; 2],
}

impl Pieces {
    fn of(stretch: Interval, sigma_t: Spectrum) -> Self {
        let (start, length, far) = (stretch.start, stretch.length(), FAR / sigma_t.mean());
        if length <= far {
            return Pieces { start, lengths: [length / PIECES as f64; 2] };
        }
        Pieces { start, lengths: [far / (PIECES - 1) as f64, length - far] }
    }

    /// Where a piece begins on the ray \[L\].
    fn start_of(&self, number: usize) -> f64 {
        self.start + number as f64 * self.lengths[0]
    }
}

impl Brightness {
    /// The ends of a flight of this weight; none where it keeps its own: where media vary, or are none, or nothing is bright.
    ///
    /// # Arguments
    /// `segments` of medium on the ray up to the body ahead, `hit`
    #[inline(always)]
    pub fn ends(
        &self,
        scene: &Scene,
        ray: &Ray,
        (hit, segments): (Option<&SceneHit>, &Segments),
        weight: Spectrum,
    ) -> Option<Ends> {
        if !is_cut(scene, segments) {
            return None;
        }
        let mut ends = Ends { ways: [(0.0, 0.0); PIECES * STRETCHES + 1], count: 0, mean: 0.0 };
        let is_grey = scene.plan().has_grey_extinction;
        // Where extinction is grey one channel stands for all.
        let (mut left, mut grey) = (weight / weight.sum(), 1.0);
        let (mut all, mut brightest) = (0.0, 0.0f64);
        for segment in colliding(scene, segments) {
            let matter = scene.medium(segment.medium).matter();
            let albedo = matter.albedo().mean();
            let pieces = Pieces::of(segment.interval, matter.sigma_t());
            let depths = pieces.lengths.map(|length| matter.depth(length));
            let [near, last] = depths.map(|depth| (decay(depth), collided(depth)));
            let middle = ray.at(pieces.start + 0.5 * pieces.lengths[0]);
            let along = ray.dir * pieces.lengths[0];
            for number in 0..PIECES {
                let (passes, collides) = if number + 1 == PIECES { last } else { near };
                let own = if is_grey {
                    let come = grey;
                    grey *= passes[0];
                    come * collides[0]
                } else {
                    let come = left;
                    left *= passes;
                    (come * collides).sum()
                };
                // The last piece may have no end, and what collides in it does so soon.
                let brightness = albedo * self.media.at(self.place(middle + along * number as f64));
                ends.add(own, brightness);
                all += own;
                brightest = brightest.max(brightness);
            }
        }
        let own = if is_grey { grey } else { left.sum() };
        let brightness = match hit.map(|found| self.of_body(scene, ray, found)) {
            None => 0.0,
            Some(Some(brightness)) => brightness,
            // As bright as all others, so that it keeps its probability.
            Some(None) => ends.mean / all,
        };
        ends.add(own, brightness);
        // Dark, or bright only where no flight comes.
        if !(ends.mean > FAINT * brightest.max(brightness) && ends.mean < f64::INFINITY) {
            return None;
        }
        Some(ends)
    }

    /// How bright the body ahead is, if photons tell of it.
    fn of_body(&self, scene: &Scene, ray: &Ray, found: &SceneHit) -> Option<f64> {
        // What a light itself shines was seen already.
        let Target::Object(index) = found.target else { return Some(0.0) };
        let position = ray.at(found.hit.t);
        match &scene.objects()[index].surface {
            Surface::Lambertian(surface) => {
                let reflectance = surface.reflectance(position, found.hit.uv).mean();
                Some(reflectance * self.surfaces.at(self.place(position)))
            }
            Surface::Black(_) => Some(0.0),
            Surface::Mirror(_) | Surface::Dielectric(_) | Surface::Filter(_) => None,
        }
    }

    fn place(&self, p: DVec3) -> DVec3 {
        self.period.map_or(p, |side| wrap(p, side))
    }

    /// A flight, and what was made of its weight by where it ends; none where it keeps its own.
    pub fn fly(
        &self,
        scene: &Scene,
        ray: &Ray,
        (hit, end, interior): (Option<&SceneHit>, f64, usize),
        weight: Spectrum,
        stream: &mut Stream,
    ) -> Option<(Flight, f64)> {
        let segments = scene.segments(ray, end, interior);
        let ends = self.ends(scene, ray, (hit, &segments), weight)?;
        let (number, u) = ends.choose(self.share, stream.unit());
        let more_often = ends.more_often(ends.ways[number].1, self.share);
        let factor = if planted(Fault::LedFlightsForgotten) { 1.0 } else { 1.0 / more_often };
        let led = weight * factor;
        if number + 1 == ends.count {
            return Some((uncollided(scene, ray, end, interior, led), factor));
        }
        let segment = colliding(scene, &segments).nth(number / PIECES)?;
        let matter = scene.medium(segment.medium).matter();
        let pieces = Pieces::of(segment.interval, matter.sigma_t());
        let (number, start) = (number % PIECES, pieces.start_of(number % PIECES));
        let collides = collided(matter.depth(pieces.lengths[usize::from(number + 1 == PIECES)]));
        let channel = if scene.plan().has_grey_extinction {
            0
        } else {
            let come = weight * decay(scene.optical_depth(ray, start, interior));
            choose(come * collides, stream.unit())
        };
        let flown = -ln_1p(-u * collides[channel]) / matter.sigma_t()[channel];
        Some((collision(scene, ray, start + flown, interior, segment.medium, led), factor))
    }
}

/// What collides in a depth, by channel.
fn collided(depth: Spectrum) -> Spectrum {
    if depth.is_grey() { Spectrum::grey(-exp_m1(-depth[0])) } else { depth.map(|depth| -exp_m1(-depth)) }
}

/// The stretches in which light can collide.
fn colliding<'a>(scene: &Scene, segments: &'a Segments) -> impl Iterator<Item = &'a Segment> {
    segments.iter().filter(|segment| !scene.medium(segment.medium).matter().sigma_t().is_black())
}

/// Whether flights along these stretches are cut into pieces.
fn is_cut(scene: &Scene, segments: &Segments) -> bool {
    let is_even = |segment: &Segment| scene.medium(segment.medium).is_homogeneous();
    segments.iter().all(is_even) && (1..=STRETCHES).contains(&colliding(scene, segments).count())
}
