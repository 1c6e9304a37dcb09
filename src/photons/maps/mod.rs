//! The three maps of Jensen and Christensen (1998): global, caustic, volume.
//!
//! With L a light, S a specular surface, D a diffuse one and M a collision, a photon stored at an event belongs to the class
//! of what it met before. Each class of light is read exactly once:
//!
//! | map | holds | read |
//! |---|---|---|
//! | caustic | L S+ D | where the eye looks at a diffuse surface |
//! | volume | L (S, D, M)+ M: every collision that is not direct, or the flight to it, or planes of flights | along rays through media |
//! | global, seen | L ... D with a D or M on the way | where the eye looks at a diffuse surface |
//! | global, gathered | every L ... D | where a ray that left that surface meets the next one |
//!
//! Direct light comes by shadow rays where the eye looks, so neither it nor the caustic class is in a global map that is
//! seen itself. One diffuse bounce away both are indirect light of the surface that the eye looks at: a map that is
//! gathered holds them, as that of 1998 does, and the gathering rays send no shadow rays from the surfaces they meet. The
//! rays of a final gathering bring the medium's radiance with them, so that light scattered by the medium towards the
//! surface that the eye looks at, L ... M D, comes with them; a map that is seen holds that class.

mod classes;
mod counts;
mod settings;

pub use classes::{is_caustic, is_global, is_volume};
pub use counts::{Forecast, MOST_A_STORED, counts, counts_by_importance, forecast};
pub use settings::{Amount, Emitted, Indirect, MapSettings, MediumSamples, PILOT};

use super::beams::BeamMap;
use super::importance::Importance;
use super::planes::PlaneMap;
use super::{Part, Pass, PassReport, PhotonMap, Photons, Run};
use crate::error::Result;
use crate::rng::Purpose;
use crate::scene::Scene;
use crate::transport::Progress;
use classes::{Class, Classes, Emitters};
use std::time::{Duration, Instant};

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
    /// Power of the lights that could meet anything, over all: what the photons of the main pass stand for; 1 where none was
    /// left out.
    pub aimed: f64,
    /// Cells of the lights' numbers that were tested against bodies.
    pub projection_cells: u64,
    /// Power that could meet a specular body, over that of all lights: what the photons of the caustic map stand for.
    pub projected: f64,
    /// Memory that the maps occupy \[bytes\].
    pub bytes: usize,
}

impl MapReport {
    /// Counts another part of the same run.
    pub fn add_part(&mut self, other: &MapReport) {
        self.main += other.main;
        self.caustic += other.caustic;
        self.pilot += other.pilot;
        self.build += other.build;
        self.bytes = self.bytes.max(other.bytes);
        // What all parts have alike.
        (self.aimed, self.projected) = (other.aimed, other.projected);
        self.projection_cells = other.projection_cells;
    }
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
    /// Their flights, in place of them; beside planes those that begin on a body.
    pub beams: Option<BeamMap>,
    /// Planes of flights, in place of them.
    pub planes: Option<PlaneMap>,
    /// Where the global map is to be read: this decided what it holds.
    pub indirect: Indirect,
    /// What the volume map holds.
    pub media: MediumSamples,
    /// What filling them took.
    pub report: MapReport,
}

impl Maps {
    /// No map at all.
    pub fn none(indirect: Indirect) -> Self {
        Maps {
            global: None,
            caustic: None,
            volume: None,
            beams: None,
            planes: None,
            indirect,
            media: MediumSamples::Points,
            report: MapReport::default(),
        }
    }

    /// What the global, the caustic and the volume map hold: photons, and in place of those in media beams and planes.
    pub fn stored(&self) -> [usize; 3] {
        let held = |map: &Option<PhotonMap>| map.as_ref().map_or(0, PhotonMap::stored);
        let of_beams = self.beams.as_ref().map_or(0, BeamMap::stored);
        let of_planes = self.planes.as_ref().map_or(0, PlaneMap::stored);
        [held(&self.global), held(&self.caustic), held(&self.volume) + of_beams + of_planes]
    }
}

/// Fills the maps that the scene needs.
///
/// # Errors
/// those of [`counts`] and [`fill_counted`]
pub fn fill(scene: &Scene, settings: &MapSettings, progress: &dyn Progress) -> Result<Maps> {
    fill_by_importance(scene, settings, None, progress)
}

/// The same with the photons of the global and the volume map by importance; [`Importance::of`] must know where
/// the global map will be read.
///
/// # Errors
/// those of [`fill`]
pub fn fill_by_importance(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
    progress: &dyn Progress,
) -> Result<Maps> {
    let start = Instant::now();
    let emitted = counts_by_importance(scene, settings, importance)?;
    let pilot = start.elapsed();
    let mut maps = fill_counted_by_importance(scene, settings, emitted, importance, progress)?;
    maps.report.pilot = pilot;
    Ok(maps)
}

/// Fills the maps with the photons of so many histories.
///
/// The same bits on any number of threads. Memory: [`PeakBytes`](super::PeakBytes) at most; what stays is
/// [`PhotonTree::bytes`](crate::photons::PhotonTree::bytes).
///
/// # Errors
/// those of [`Run::pass`]; where there are planes, those of [`PlaneMap::new`]
pub fn fill_counted(
    scene: &Scene,
    settings: &MapSettings,
    emitted: Emitted,
    progress: &dyn Progress,
) -> Result<Maps> {
    fill_counted_by_importance(scene, settings, emitted, None, progress)
}

/// The same with photons by importance.
///
/// # Errors
/// those of [`fill_counted`]
pub fn fill_counted_by_importance(
    scene: &Scene,
    settings: &MapSettings,
    emitted: Emitted,
    importance: Option<&Importance>,
    progress: &dyn Progress,
) -> Result<Maps> {
    fill_part(scene, settings, emitted, importance, Part::WHOLE, progress)
}

/// The same with the photons of a part of the histories, which stand for all.
///
/// # Errors
/// those of [`fill_counted`]
pub fn fill_part(
    scene: &Scene,
    settings: &MapSettings,
    emitted: Emitted,
    importance: Option<&Importance>,
    part: Part,
    progress: &dyn Progress,
) -> Result<Maps> {
    scene.check_emission()?;
    settings.media.check(scene)?;
    let emitters = Emitters::of(scene, importance);
    let (Emitted { global, volume, caustic }, mut report) = (emitted, MapReport::default());
    let mut build = |parts: Vec<Photons>, emitted: u64| {
        if emitted == 0 {
            return Ok(None);
        }
        let start = Instant::now();
        progress.stage("build", parts.iter().map(|part| part.len() as u64).sum());
        let map = PhotonMap::of_parts(parts, emitted, progress);
        let map = map.map(|map| Some(map.of_run(settings.seed, settings.replicate)));
        report.build += start.elapsed();
        map
    };
    let shot = |purpose: Purpose, class: Class, [global, volume]: [u64; 2]| -> Result<Pass> {
        let count = global.max(volume);
        let store = Classes { class, global, volume, media: settings.media };
        let histories = part.histories(count);
        progress.stage("emission", histories.end - histories.start);
        let run = Run { purpose, part, ..class.run(scene, &emitters, importance, settings, count) };
        let mut pass = run.pass(&store, progress)?;
        // What a caustic map leaves out is not lost but stands in the other maps; what meets nothing escapes.
        if class != Class::Caustic {
            let elsewhere = run.emitter.left_out() * (histories.end - histories.start) as f64;
            pass.report.ledger.emitted += elsewhere;
            pass.report.ledger.escaped += elsewhere;
        }
        Ok(pass)
    };
    let main = shot(Purpose::Photons, Class::Main(settings.indirect), [global, volume])?;
    let surfaces = build(main.surfaces, global)?;
    let is_of_points = settings.media == MediumSamples::Points;
    let points = if is_of_points { build(main.media, volume)? } else { None };
    // Caustic photons of histories that the first pass has run too would be the same photons.
    let pass = shot(Purpose::Caustics, Class::Caustic, [caustic, 0])?;
    let focused = build(pass.surfaces, caustic)?;
    (report.main, report.caustic) = (main.report, pass.report);
    report.aimed = emitters.main.kept();
    report.projection_cells = emitters.main.projection_cells();
    if let Some(emitter) = &emitters.caustic {
        report.projection_cells += emitter.projection_cells();
        report.projected = emitter.kept();
    }
    let start = Instant::now();
    let side = scene.periodic_cell().map(|cell| cell.side);
    let has_beams = settings.media.beams().is_some() && volume > 0;
    let beams = has_beams.then(|| BeamMap::new(main.beams, volume, side)).transpose()?;
    let has_planes = settings.media.has_planes() && volume > 0;
    let planes = has_planes.then(|| PlaneMap::new(main.planes, volume, side)).transpose()?;
    report.build += start.elapsed();
    report.bytes = [&surfaces, &points, &focused].into_iter().flatten().map(|map| map.tree().bytes()).sum();
    report.bytes += beams.as_ref().map_or(0, |map| map.tree().bytes());
    report.bytes += planes.as_ref().map_or(0, |map| map.tree().bytes());
    let MapSettings { indirect, media, .. } = *settings;
    Ok(Maps { global: surfaces, caustic: focused, volume: points, beams, planes, indirect, media, report })
}
