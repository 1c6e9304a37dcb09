//! What the maps are filled with.

use crate::error::{Error, Result};
use crate::photons::beams::BeamLength;
use crate::photons::planes::check_planes;
use crate::scene::Scene;
use crate::surface::Surface;

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

impl std::fmt::Display for Amount {
    /// As the command takes it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Amount::Emitted(number) => write!(f, "emit:{number}"),
            Amount::Stored(number) => write!(f, "{number}"),
        }
    }
}

/// Where the global map is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Indirect {
    /// Where rays of a final gathering meet surfaces: the map holds every class.
    Gathered,
    /// Where the eye looks: the map holds what is neither direct nor a caustic.
    Seen,
}

/// What the volume map holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MediumSamples {
    /// Photons where they collide.
    #[default]
    Points,
    /// Their flights, as far as this, in place of them.
    Beams(BeamLength),
    /// Planes of all flights: what media scatter twice and more. Beside them flights that begin on a body, as beams of this length, if
    /// there are any.
    Planes(Option<BeamLength>),
}

impl MediumSamples {
    /// Beams of this length, and planes, if they are asked for; points otherwise.
    pub fn new(beams: Option<BeamLength>, has_planes: bool) -> Self {
        match (has_planes, beams) {
            (true, beside) => MediumSamples::Planes(beside),
            (false, Some(length)) => MediumSamples::Beams(length),
            (false, None) => MediumSamples::Points,
        }
    }

    /// How far flights go that are stored as beams, if some are.
    pub fn beams(self) -> Option<BeamLength> {
        match self {
            MediumSamples::Points => None,
            MediumSamples::Beams(length) => Some(length),
            MediumSamples::Planes(beside) => beside,
        }
    }

    /// Whether planes of flights are stored.
    pub fn has_planes(self) -> bool {
        matches!(self, MediumSamples::Planes(_))
    }

    /// Checks that they bring all light of a scene's media that is not direct there.
    ///
    /// # Errors
    /// where there are planes, those of [`check_planes`], and `Error::Scene` without beams beside bodies that light comes from, or through
    pub fn check(self, scene: &Scene) -> Result<()> {
        if self.has_planes() {
            check_planes(scene)?;
        }
        let is_dark = |surface: &Surface| matches!(surface, Surface::Black(_));
        let needs_beams = scene.plan().has_media && scene.objects().iter().any(|o| !is_dark(&o.surface));
        match self != MediumSamples::Planes(None) || !needs_beams {
            true => Ok(()),
            false => Err(Error::Scene(
                "planes hold nothing of the light that comes to media from bodies; allowed: beams beside them (a beam radius)".into(),
            )),
        }
    }
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
    /// What it holds, and what is counted there.
    pub media: MediumSamples,
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
    /// Histories of both passes: the first stages that [`fill_counted`](super::fill_counted) tells its progress.
    pub fn histories(&self) -> u64 {
        self.global.max(self.volume) + self.caustic
    }
}
