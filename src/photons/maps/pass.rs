//! A pass of histories, and the photons that it stores.

use super::{Ends, Indirect, Part, PassReport, is_caustic, is_diffuse, is_global, is_volume};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::photons::importance::{Branching, Importance};
use crate::photons::{Emitter, Ledger, Photon, fold};
use crate::rng::{Purpose, Stream};
use crate::scene::{Scene, Target};
use crate::transport::{Progress, Roulette, Step, Visitor, Walker, run_blocks, walk};
use glam::DVec3;
use std::time::Instant;

/// Which photons a pass stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    /// Those of the global and the volume map.
    Main(Indirect),
    /// Those of the caustic map.
    Caustic,
}

/// A pass to be run.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    pub scene: &'a Scene,
    pub emitter: &'a Emitter,
    pub importance: Option<&'a Importance>,
    pub purpose: Purpose,
    pub seed: u64,
    pub replicate: u64,
    pub class: Class,
    /// Histories that store surface photons.
    pub global: u64,
    /// Histories that store volume photons.
    pub volume: u64,
    /// Which of all histories are run.
    pub part: Part,
    /// Whether photons are counted and not kept.
    pub is_pilot: bool,
}

/// What a pass brought: photons in the order of their histories, a vector a block.
#[derive(Default)]
pub(super) struct Stored {
    pub surfaces: Vec<Vec<Photon>>,
    pub media: Vec<Vec<Photon>>,
    /// Photons that met surfaces and media, kept or not.
    pub met: [u64; 2],
    pub report: PassReport,
    non_finite: u64,
}

impl Stored {
    fn merged(mut self, other: Stored) -> Stored {
        self.surfaces.extend(other.surfaces);
        self.media.extend(other.media);
        self.met = [0, 1].map(|i| self.met[i] + other.met[i]);
        self.report += other.report;
        self.non_finite += other.non_finite;
        self
    }
}

impl Run<'_> {
    /// Runs its part of so many histories.
    pub fn pass(&self, histories: u64, progress: &dyn Progress) -> Result<Stored> {
        let start = Instant::now();
        let part = self.part.histories(histories);
        let histories = part.end - part.start;
        progress.stage("emission", histories);
        // A caustic photon has not been scattered: its history ends with its first scattering.
        let limit = (self.class == Class::Caustic).then_some(1);
        let block = |range: std::ops::Range<u64>| {
            let mut store = Store {
                run: self,
                history: 0,
                surface: Vec::new(),
                medium: Vec::new(),
                stored: Stored::default(),
            };
            for history in part.start + range.start..part.start + range.end {
                let mut stream = Stream::new(self.seed, self.purpose, self.replicate, history);
                store.history = history;
                store.stored.report.emitted += 1;
                let Some(first) = self.emitter.emit(self.scene, &mut stream) else {
                    store.stored.report.ends.refused += 1;
                    continue;
                };
                store.stored.report.ledger.emitted += first.weight.sum();
                match self.importance {
                    None => walk(self.scene, first, Roulette::Analog, limit, &mut stream, &mut store),
                    Some(importance) => importance.walk(self.scene, first, limit, &mut stream, &mut store),
                }
                store.stored.report.work += stream.work;
            }
            let Store { mut surface, mut medium, mut stored, .. } = store;
            surface.shrink_to_fit();
            medium.shrink_to_fit();
            stored.surfaces.push(surface);
            stored.media.push(medium);
            stored
        };
        let mut stored = run_blocks(histories, progress, block, Stored::merged)?.unwrap_or_default();
        // What a caustic map leaves out is not lost but stands in the other maps; what meets nothing escapes.
        if matches!(self.class, Class::Main(_)) {
            let elsewhere = self.emitter.left_out() * histories as f64;
            stored.report.ledger.emitted += elsewhere;
            stored.report.ledger.escaped += elsewhere;
        }
        stored.report.time = start.elapsed();
        match stored.non_finite {
            0 => Ok(stored),
            count => Err(Error::NonFinite { count, place: "photon histories" }),
        }
    }
}

/// Stores the photons of one block.
struct Store<'a> {
    run: &'a Run<'a>,
    history: u64,
    surface: Vec<Photon>,
    medium: Vec<Photon>,
    stored: Stored,
}

impl Store<'_> {
    /// A photon at a collision, or with the outward normal of the surface that it met.
    fn photon(&mut self, walker: &Walker, position: DVec3, outward: DVec3) -> Photon {
        self.stored.non_finite += u64::from(!(walker.weight.is_finite() && position.is_finite()));
        let side = if walker.ray.dir.dot(outward) < 0.0 { outward } else { -outward };
        Photon {
            position: self.run.scene.stage().map_or(position, |s| fold::into_cell(position, s.side)),
            dir: walker.ray.dir.as_vec3(),
            normal: side.as_vec3(),
            power: (walker.weight * self.run.part.of as f64).0.as_vec3(),
            order: u16::try_from(walker.order).unwrap_or(u16::MAX),
            flags: walker.flags,
        }
    }

    fn ended(&mut self, weight: Spectrum, how: fn(&mut Ends, &mut Ledger, f64)) {
        let report = &mut self.stored.report;
        how(&mut report.ends, &mut report.ledger, weight.sum());
    }
}

impl Branching for Store<'_> {}

impl Visitor for Store<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, _walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Collision(arrival, _) => {
                self.stored.report.collisions += 1;
                if matches!(self.run.class, Class::Main(_))
                    && self.history < self.run.volume
                    && is_volume(arrival.walker.flags)
                {
                    let photon = self.photon(arrival.walker, arrival.position, DVec3::ZERO);
                    self.stored.met[1] += 1;
                    if !self.run.is_pilot {
                        self.medium.push(photon);
                    }
                }
            }
            Step::Surface(arrival, found) => {
                let Target::Object(index) = found.target else { return };
                if !is_diffuse(&self.run.scene.objects()[index].surface) {
                    return;
                }
                self.stored.report.hits += 1;
                let flags = arrival.walker.flags;
                let is_stored = match self.run.class {
                    Class::Main(indirect) => is_global(flags, indirect),
                    Class::Caustic => is_caustic(flags),
                };
                if self.history < self.run.global && is_stored {
                    let photon = self.photon(arrival.walker, arrival.position, found.hit.normal);
                    self.stored.met[0] += 1;
                    if !self.run.is_pilot {
                        self.surface.push(photon);
                    }
                }
            }
            Step::Absorbed(weight, _) => self.ended(weight, |ends, ledger, power| {
                ends.absorbed += 1;
                ledger.absorbed += power;
            }),
            Step::Escaped(weight) => self.ended(weight, |ends, ledger, power| {
                ends.escaped += 1;
                ledger.escaped += power;
            }),
            Step::Abandoned(weight) => self.ended(weight, |ends, ledger, power| {
                ends.abandoned += 1;
                ledger.abandoned += power;
            }),
            Step::Ahead(_) | Step::Passed(..) => {}
        }
    }
}
