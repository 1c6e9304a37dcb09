//! The three maps of Jensen and Christensen (1998): global, caustic, volume.
//!
//! With L a light, S a specular surface, D a matt one and M a collision, a photon stored at an event belongs to the class
//! of what it met before. Each class of light is read exactly once:
//!
//! | map | holds | read |
//! |---|---|---|
//! | caustic | L S+ D | where the eye looks at a matt surface |
//! | volume | L (S, D, M)+ M: every collision that is not direct | along rays through media |
//! | global, seen | L ... D with a D or M on the way | where the eye looks at a matt surface |
//! | global, gathered | every L ... D | where a ray that left that surface meets the next one |
//!
//! Direct light comes by shadow rays where the eye looks, so neither it nor the caustic class is in a global map that is
//! seen itself. One diffuse bounce away both are indirect light of the surface that the eye looks at: a map that is
//! gathered holds them, as that of 1998 does, and the gathering rays send no shadow rays from the surfaces they meet. The
//! rays of a final gathering bring the medium's radiance with them, so that light scattered by the medium towards the
//! surface that the eye looks at, L ... M D, comes with them; a map that is seen holds that class.

use super::importance::{Branching, Importance};
use super::{Emitter, Flags, Ledger, Photon, PhotonMap, fold};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use crate::rng::{Purpose, Stream, Work};
use crate::scene::{Scene, Target};
use crate::surface::Surface;
use crate::transport::{NoProgress, Progress, Roulette, Step, Visitor, Walker, run_blocks, walk};
use std::time::{Duration, Instant};

/// Histories of the pilot that says how many photons to emit where a number of stored ones is asked for.
pub const PILOT: u64 = 10_000;

/// How many photons a map gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amount {
    /// So many are sent out.
    Emitted(u64),
    /// So many are to be stored, about: a pilot of [`PILOT`] histories sets the number sent out, which does not depend
    /// on what is then stored.
    Stored(u64),
}

/// Where the global map is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Indirect {
    /// Where rays of a final gathering meet surfaces: the map holds every class.
    Gathered,
    /// Where the eye looks: the map holds what is neither direct nor a caustic.
    Seen,
}

/// What the maps are filled with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapSettings {
    /// Photons of the global map.
    pub global: Amount,
    /// Photons of the caustic map, used where the scene has specular surfaces.
    pub caustic: Amount,
    /// Photons of the volume map, used where the scene has media.
    pub volume: Amount,
    /// Where the global map will be read.
    pub indirect: Indirect,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Which independent repetition.
    pub replicate: u64,
}

/// Histories to run for each map; 0 where the scene needs none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Emitted {
    /// For the global map.
    pub global: u64,
    /// For the volume map: the same histories, as far as they go.
    pub volume: u64,
    /// For the caustic map: histories of their own.
    pub caustic: u64,
}

impl Emitted {
    /// Histories of both passes: the first stages that [`fill_counted`] tells its progress.
    pub fn histories(&self) -> u64 {
        self.global.max(self.volume) + self.caustic
    }
}

/// How histories ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ends {
    /// In a medium or on a body.
    pub absorbed: u64,
    /// Out of the scene.
    pub escaped: u64,
    /// Where nobody asked for more.
    pub abandoned: u64,
}

/// What one pass of histories did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PassReport {
    /// Histories run.
    pub emitted: u64,
    /// How they ended.
    pub ends: Ends,
    /// Where the power went.
    pub ledger: Ledger,
    /// Collisions in media, stored or not.
    pub collisions: u64,
    /// Arrivals at matt surfaces, stored or not.
    pub hits: u64,
    /// Work that the scene may not require.
    pub work: Work,
    /// Time.
    pub time: Duration,
}

/// What filling the maps took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapReport {
    /// The pass of the global and the volume map.
    pub main: PassReport,
    /// The pass of the caustic map.
    pub caustic: PassReport,
    /// Time of the pilots.
    pub pilot: Duration,
    /// Time of building the trees.
    pub build: Duration,
    /// Cells of the lights' numbers that were tested against specular bodies.
    pub projection_cells: u64,
    /// Power that could meet a specular body, over that of all lights: what the photons of the caustic map stand for.
    pub projected: f64,
    /// Memory that the maps occupy \[bytes\].
    pub bytes: usize,
}

/// The maps of one run; none where the scene needs none.
#[derive(Debug)]
pub struct Maps {
    /// Surface photons.
    pub global: Option<PhotonMap>,
    /// Photons focused by specular surfaces.
    pub caustic: Option<PhotonMap>,
    /// Photons in media that do not come straight from a light.
    pub volume: Option<PhotonMap>,
    /// Where the global map is to be read: this decided what it holds.
    pub indirect: Indirect,
    /// What filling them took.
    pub report: MapReport,
}

/// Whether the global map holds a photon of this class.
pub fn is_global(flags: Flags, indirect: Indirect) -> bool {
    indirect == Indirect::Gathered
        || flags.has(Flags::DIFFUSE)
        || flags.has(Flags::MEDIUM)
        || (planted(Fault::CausticTwice) && is_caustic(flags))
}

/// Whether the caustic map holds a photon of this class.
pub fn is_caustic(flags: Flags) -> bool {
    flags == Flags::SPECULAR
}

/// Whether the volume map holds a photon of this class.
pub fn is_volume(flags: Flags) -> bool {
    !flags.is_direct() || planted(Fault::DirectInVolumeMap)
}

/// Fills the maps that the scene needs.
///
/// # Errors
/// those of [`counts`] and [`fill_counted`]
pub fn fill(scene: &Scene, settings: &MapSettings, progress: &dyn Progress) -> Result<Maps> {
    fill_steered(scene, settings, None, progress)
}

/// The same with the photons of the global and the volume map steered by importance; [`Importance::of`] must know where
/// the global map will be read.
///
/// # Errors
/// those of [`fill`]
pub fn fill_steered(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
    progress: &dyn Progress,
) -> Result<Maps> {
    let start = Instant::now();
    let emitted = counts_steered(scene, settings, importance)?;
    let pilot = start.elapsed();
    let mut maps = fill_counted_steered(scene, settings, emitted, importance, progress)?;
    maps.report.pilot = pilot;
    Ok(maps)
}

/// Histories that each map needs, by a pilot where a number of stored photons is asked for.
///
/// # Errors
/// [`Error::OutOfRange`] for a number of 0; [`Error::Scene`] if a map would stay empty: none of the pilot's photons was
/// stored.
pub fn counts(scene: &Scene, settings: &MapSettings) -> Result<Emitted> {
    counts_steered(scene, settings, None)
}

/// The same with photons steered by importance.
///
/// # Errors
/// those of [`counts`]
pub fn counts_steered(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
) -> Result<Emitted> {
    let emitters = Emitters::of(scene, importance);
    let needs = Needs::of(scene, &emitters);
    let asked = [
        ("global", needs.global, settings.global),
        ("volume", needs.volume, settings.volume),
        ("caustic", needs.caustic, settings.caustic),
    ];
    let is_stored = |amount| matches!(amount, Amount::Stored(_));
    let pilot = |class: Class| {
        let run = Run {
            scene,
            emitter: emitters.of_class(class),
            importance: importance.filter(|_| class != Class::Caustic),
            purpose: Purpose::Pilot,
            seed: settings.seed,
            replicate: settings.replicate,
            class,
            global: PILOT,
            volume: PILOT,
        };
        run.pass(PILOT, &NoProgress)
    };
    let is_piloted = |map: usize| asked[map].1 && is_stored(asked[map].2);
    let mut stored = [0; 3];
    if is_piloted(0) || is_piloted(1) {
        let pass = pilot(Class::Main(settings.indirect))?;
        (stored[0], stored[1]) = (pass.surface(), pass.medium());
    }
    if is_piloted(2) {
        stored[2] = pilot(Class::Caustic)?.surface();
    }
    let number = |map: usize| -> Result<u64> {
        let (name, is_needed, amount) = asked[map];
        match amount {
            _ if !is_needed => Ok(0),
            Amount::Emitted(0) | Amount::Stored(0) => Err(Error::out_of_range(
                format!("the number of photons of the {name} map"),
                0.0,
                "at least 1",
            )),
            Amount::Emitted(number) => Ok(number),
            Amount::Stored(number) if stored[map] == 0 && scene.plan().is_full => Ok(number),
            Amount::Stored(_) if stored[map] == 0 => Err(Error::Scene(format!(
                "the {name} map would stay empty: none of {PILOT} photons was stored in it; say how many to emit instead"
            ))),
            Amount::Stored(number) => Ok((number as f64 * PILOT as f64 / stored[map] as f64).ceil() as u64),
        }
    };
    Ok(Emitted { global: number(0)?, volume: number(1)?, caustic: number(2)? })
}

/// Fills the maps with the photons of so many histories.
///
/// The same bits on any number of threads. Memory: 56 bytes a photon until its map's tree is built, which holds 40.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::NonFinite`] if a photon was not finite.
pub fn fill_counted(
    scene: &Scene,
    settings: &MapSettings,
    emitted: Emitted,
    progress: &dyn Progress,
) -> Result<Maps> {
    fill_counted_steered(scene, settings, emitted, None, progress)
}

/// The same with photons steered by importance.
///
/// # Errors
/// those of [`fill_counted`]
pub fn fill_counted_steered(
    scene: &Scene,
    settings: &MapSettings,
    emitted: Emitted,
    importance: Option<&Importance>,
    progress: &dyn Progress,
) -> Result<Maps> {
    let emitters = Emitters::of(scene, importance);
    let run = |class, global, volume| Run {
        scene,
        emitter: emitters.of_class(class),
        importance: importance.filter(|_| class != Class::Caustic),
        purpose: Purpose::Photons,
        seed: settings.seed,
        replicate: settings.replicate,
        class,
        global,
        volume,
    };
    let (Emitted { global, volume, caustic }, mut report) = (emitted, MapReport::default());
    let mut build = |parts: Vec<Vec<Photon>>, emitted: u64| {
        if emitted == 0 {
            return Ok(None);
        }
        let start = Instant::now();
        let photons = joined(parts);
        progress.stage("build", photons.len() as u64);
        let map = PhotonMap::new_watched(photons, emitted, progress).map(Some);
        report.build += start.elapsed();
        map
    };
    let mut pass = run(Class::Main(settings.indirect), global, volume).pass(global.max(volume), progress)?;
    let main = pass.report;
    let surfaces = build(std::mem::take(&mut pass.surfaces), global)?;
    let media = build(std::mem::take(&mut pass.media), volume)?;
    // Caustic photons of histories that the first pass has run too would be the same photons.
    let own = Run { purpose: Purpose::Caustics, ..run(Class::Caustic, caustic, 0) };
    let pass = own.pass(caustic, progress)?;
    let focused = build(pass.surfaces, caustic)?;
    (report.main, report.caustic) = (main, pass.report);
    if let Some(emitter) = &emitters.caustic {
        (report.projection_cells, report.projected) = (emitter.projection_cells(), emitter.kept());
    }
    report.bytes = [&surfaces, &media, &focused].into_iter().flatten().map(|map| map.tree().bytes()).sum();
    Ok(Maps { global: surfaces, caustic: focused, volume: media, indirect: settings.indirect, report })
}

/// Which maps a scene needs.
struct Needs {
    global: bool,
    caustic: bool,
    volume: bool,
}

/// How photons of each pass leave the lights.
struct Emitters {
    main: Emitter,
    /// Those that can meet a specular body; none if none can.
    caustic: Option<Emitter>,
}

impl Emitters {
    fn of(scene: &Scene, importance: Option<&Importance>) -> Self {
        let main = importance.map_or_else(|| Emitter::by_power(scene), |i| i.emitter().clone());
        Emitters { main, caustic: Emitter::towards_specular(scene) }
    }

    fn of_class(&self, class: Class) -> &Emitter {
        self.caustic.as_ref().filter(|_| class == Class::Caustic).unwrap_or(&self.main)
    }
}

impl Needs {
    fn of(scene: &Scene, emitters: &Emitters) -> Self {
        let plan = scene.plan();
        let is_matt = plan.has_surfaces && scene.objects().iter().any(|o| is_matt(&o.surface));
        Needs {
            global: is_matt || plan.is_full,
            caustic: (is_matt || plan.is_full) && emitters.caustic.is_some(),
            volume: plan.has_media,
        }
    }
}

/// Whether photons are stored on a surface: some light leaves it in other than specular directions.
pub(super) fn is_matt(surface: &Surface) -> bool {
    matches!(surface, Surface::Lambertian(_))
}

/// Which photons a pass stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    /// Those of the global and the volume map.
    Main(Indirect),
    /// Those of the caustic map.
    Caustic,
}

/// A pass to be run.
#[derive(Clone, Copy)]
struct Run<'a> {
    scene: &'a Scene,
    emitter: &'a Emitter,
    importance: Option<&'a Importance>,
    purpose: Purpose,
    seed: u64,
    replicate: u64,
    class: Class,
    /// Histories that store surface photons.
    global: u64,
    /// Histories that store volume photons.
    volume: u64,
}

/// What a pass brought: photons in the order of their histories, a vector a block.
#[derive(Default)]
struct Stored {
    surfaces: Vec<Vec<Photon>>,
    media: Vec<Vec<Photon>>,
    report: PassReport,
    non_finite: u64,
}

impl Stored {
    fn surface(&self) -> usize {
        self.surfaces.iter().map(Vec::len).sum()
    }

    fn medium(&self) -> usize {
        self.media.iter().map(Vec::len).sum()
    }

    fn merged(mut self, other: Stored) -> Stored {
        self.surfaces.extend(other.surfaces);
        self.media.extend(other.media);
        let (mine, others) = (&mut self.report, &other.report);
        mine.emitted += others.emitted;
        mine.ends.absorbed += others.ends.absorbed;
        mine.ends.escaped += others.ends.escaped;
        mine.ends.abandoned += others.ends.abandoned;
        mine.ledger.add(&others.ledger);
        mine.collisions += others.collisions;
        mine.hits += others.hits;
        mine.work += others.work;
        self.non_finite += other.non_finite;
        self
    }
}

/// One vector of all; the parts are given back one by one.
fn joined(parts: Vec<Vec<Photon>>) -> Vec<Photon> {
    let mut all = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    for part in parts {
        all.extend_from_slice(&part);
    }
    all
}

impl Run<'_> {
    fn pass(&self, histories: u64, progress: &dyn Progress) -> Result<Stored> {
        let start = Instant::now();
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
            for history in range {
                let mut stream = Stream::new(self.seed, self.purpose, self.replicate, history);
                store.history = history;
                let first = self.emitter.emit(self.scene, &mut stream);
                store.stored.report.emitted += 1;
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
    fn photon(&mut self, walker: &Walker, position: glam::DVec3) -> Photon {
        self.stored.non_finite += u64::from(!(walker.weight.is_finite() && position.is_finite()));
        Photon {
            position: self.run.scene.stage().map_or(position, |s| fold::into_cell(position, s.side)),
            dir: walker.ray.dir.as_vec3(),
            power: walker.weight.0.as_vec3(),
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
                    let photon = self.photon(arrival.walker, arrival.position);
                    self.medium.push(photon);
                }
            }
            Step::Surface(arrival, found) => {
                let Target::Object(index) = found.target else { return };
                if !is_matt(&self.run.scene.objects()[index].surface) {
                    return;
                }
                self.stored.report.hits += 1;
                let flags = arrival.walker.flags;
                let is_stored = match self.run.class {
                    Class::Main(indirect) => is_global(flags, indirect),
                    Class::Caustic => is_caustic(flags),
                };
                if self.history < self.run.global && is_stored {
                    let photon = self.photon(arrival.walker, arrival.position);
                    self.surface.push(photon);
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
