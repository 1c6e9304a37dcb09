//! What the maps are filled with.

use crate::photons::beams::BeamLength;

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

/// What the maps are filled with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapSettings {
    /// Photons of the global map.
    pub global: Amount,
    /// Photons of the caustic map, used where the scene has specular surfaces.
    pub caustic: Amount,
    /// Photons of the volume map, used where the scene has media.
    pub volume: Amount,
    /// How far flights go that, as beams, take the place of photons in the volume map, and are counted there; none for photons.
    pub beams: Option<BeamLength>,
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
