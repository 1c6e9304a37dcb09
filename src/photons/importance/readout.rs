//! Where a picture reads photons: particles from the camera.

use super::grid::{Aim, Grid};
use super::settings::{ImportanceSettings, Stage};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::photons::Emitter;
use crate::photons::maps::Indirect;
use crate::photons::pass::is_diffuse;
use crate::rng::Stream;
use crate::scene::{Camera, Scene, Target};
use crate::transport::{Progress, Roulette, Step, Visitor, Walker, run_blocks, walk};
use glam::{DVec2, DVec3};

/// What is read in each box, 0 to 1, on surfaces and in media.
#[derive(Debug, Clone)]
pub(super) struct Readout {
    grid: Grid,
    counts: Counts,
}

#[derive(Debug, Clone, Default)]
struct Counts {
    surface: Vec<f64>,
    medium: Vec<f64>,
}

impl Readout {
    /// A ball about most of what is read: about the mean place, wide by the standard deviation of places and half a
    /// cube's diagonal.
    pub fn aim(&self) -> Aim {
        let (mut sum, mut mean, mut square) = (0.0, DVec3::ZERO, 0.0);
        for (index, (s, m)) in self.counts.surface.iter().zip(&self.counts.medium).enumerate() {
            let at = self.grid.middle(index);
            sum += s + m;
            mean += at * (s + m);
            square += at.length_squared() * (s + m);
        }
        let center = mean / sum;
        let variance = (square / sum - center.length_squared()).max(0.0);
        let half = self.grid.middle(0).distance(self.grid.corner());
        Aim { center, radius: variance.sqrt() + half }
    }

    /// What is read of the photons that a surface keeps.
    pub fn surface(&self, p: DVec3) -> f64 {
        self.counts.surface[self.grid.index(p)]
    }

    /// What is read of the photons that a medium keeps.
    pub fn medium(&self, p: DVec3) -> f64 {
        self.counts.medium[self.grid.index(p)]
    }
}

/// Particles, and photons, that say how far events reach. In rooms that keep light long they are most of the cost.
const EXTENT: u64 = 1024;

/// A box about the events of some particles from the camera and some photons.
pub(super) fn extent(
    scene: &Scene,
    camera: &Camera,
    settings: &ImportanceSettings,
    progress: &dyn Progress,
) -> Result<(DVec3, DVec3)> {
    struct Extent(DVec3, DVec3);
    impl Visitor for Extent {
        const LOOKS_AHEAD: bool = false;
        fn visit(&mut self, _walker: &Walker, step: Step, _stream: &mut Stream) {
            if let Step::Collision(arrival, _) | Step::Surface(arrival, _) = step {
                (self.0, self.1) = (self.0.min(arrival.position), self.1.max(arrival.position));
            }
        }
    }
    let emitter = Emitter::towards_scene(scene);
    let block = |range: std::ops::Range<u64>| {
        let mut found = Extent(DVec3::INFINITY, DVec3::NEG_INFINITY);
        for history in range {
            let mut stream = settings.stream(Stage::Extent, history);
            let photon = emitter.emit(scene, &mut stream);
            for start in photon.into_iter().chain([particle(scene, camera, &mut stream)]) {
                walk(scene, start, Roulette::Analog, None, &mut stream, &mut found);
            }
        }
        found
    };
    let merge = |a: Extent, b: Extent| Extent(a.0.min(b.0), a.1.max(b.1));
    match run_blocks(EXTENT, progress, block, merge)? {
        Some(Extent(low, high)) if low.is_finite() && high.is_finite() => Ok((low, high)),
        _ => Err(Error::Scene("the camera sees nothing, and light meets nothing".into())),
    }
}

/// A particle that leaves the camera anywhere in the picture.
fn particle(scene: &Scene, camera: &Camera, stream: &mut Stream) -> Walker {
    let size = DVec2::new(f64::from(camera.width()), f64::from(camera.height()));
    let ray = camera.ray(size * DVec2::from(stream.pair()));
    Walker { interior: scene.interior_at(camera.position()), ..Walker::new(ray, Spectrum::ONE) }
}

/// Counts particles of one block.
struct Counter<'a> {
    scene: &'a Scene,
    grid: &'a Grid,
    indirect: Indirect,
    found: Counts,
}

impl Visitor for Counter<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, _walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            // A march reads the volume map along every ray, a collision stands for it.
            Step::Collision(arrival, _) => {
                self.found.medium[self.grid.index(arrival.position)] += arrival.walker.weight.mean();
            }
            Step::Surface(arrival, found) => {
                let order = if self.indirect == Indirect::Gathered { 1 } else { 0 };
                if arrival.walker.order == order
                    && let Target::Object(index) = found.target
                    && is_diffuse(&self.scene.objects()[index].surface)
                {
                    self.found.surface[self.grid.index(arrival.position)] += arrival.walker.weight.mean();
                }
            }
            _ => {}
        }
    }
}

/// Runs the particles.
///
/// What n of them leave in a box counts as n/(n + m), m the mean of boxes that are read at all: where much is read,
/// more does not need more photons, and boxes near the camera, which it reads most, do not take all.
pub(super) fn read(
    scene: &Scene,
    camera: &Camera,
    indirect: Indirect,
    grid: Grid,
    settings: &ImportanceSettings,
    progress: &dyn Progress,
) -> Result<Readout> {
    let limit = if indirect == Indirect::Gathered { 2 } else { 1 };
    let block = |range: std::ops::Range<u64>| {
        let found = Counts { surface: vec![0.0; grid.len()], medium: vec![0.0; grid.len()] };
        let mut counter = Counter { scene, grid: &grid, indirect, found };
        for history in range {
            let mut stream = settings.stream(Stage::Readout, history);
            let start = particle(scene, camera, &mut stream);
            walk(scene, start, Roulette::Analog, Some(limit), &mut stream, &mut counter);
        }
        counter.found
    };
    let add = |mut a: Vec<f64>, b: Vec<f64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    let merge =
        |a: Counts, b: Counts| Counts { surface: add(a.surface, b.surface), medium: add(a.medium, b.medium) };
    let found = run_blocks(settings.particles, progress, block, merge)?.unwrap_or_default();
    let counts = Counts { surface: bounded(found.surface), medium: bounded(found.medium) };
    if counts.surface.iter().chain(&counts.medium).all(|share| *share == 0.0) {
        return Err(Error::Scene("the camera sees no surface or medium where photons are read".into()));
    }
    Ok(Readout { grid, counts })
}

fn bounded(counts: Vec<f64>) -> Vec<f64> {
    let filled = counts.iter().filter(|n| **n > 0.0).count();
    let mean = counts.iter().sum::<f64>() / filled.max(1) as f64;
    counts.into_iter().map(|n| if n > 0.0 { n / (n + mean) } else { 0.0 }).collect()
}
