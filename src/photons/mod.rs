//! Photons: the record, the pass that stores them, the periodic cell, the tree over their positions, maps, and files of them.

pub mod beams;
mod emit;
mod ends;
pub mod file;
mod guide;
pub mod importance;
mod map;
pub mod maps;
mod pass;
pub mod periodic;
pub mod planes;
mod record;
pub mod synthetic;
mod tallies;
pub mod tree;

pub use crate::transport::Flags;
pub use emit::Emitter;
pub(crate) use emit::from_light;
pub use ends::{MOST_EVENTS, check_end};
pub use guide::{Guide, GuideSettings, MOST_HISTORIES};
pub use map::PhotonMap;
pub use pass::{
    Ends, Everything, Histories, Ledger, Part, Pass, PassReport, Run, Storage, is_in, is_indirect, shoot,
};
pub use record::{Photon, Photons};
pub use tallies::Scores;
pub(crate) use tallies::score_bytes;
pub use tree::PhotonTree;

/// Most memory that stored photons take on their way into a map: bytes as a function of their number. Measured: see
/// `tests/cli/memory.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakBytes {
    /// Of each \[bytes\].
    each: f64,
    /// Of each of so many first ones, beside \[bytes\].
    first: (f64, f64),
}

impl PeakBytes {
    /// Of the first map of a process. A photon takes 52 or, on a surface, 64 as its pass stores it; then its columns and its place in
    /// the order, 44 or 56, with the column of 12 that is just put in order. Beside, the allocator keeps small pieces of the pass, and
    /// threads sort in memory of their own.
    pub const FIRST_MAP: PeakBytes = PeakBytes { each: 66.0, first: (5e5, 66.0) };

    /// Of maps one after the other: what the allocator keeps of the last one, the next one fits in for the smaller part; how much of it
    /// depends on the order in which threads end, 107 to 142 bytes in one scene.
    pub const MAPS: PeakBytes = PeakBytes { each: 134.0, first: (0.0, 0.0) };

    /// Of so many maps.
    pub fn of_maps(maps: u64) -> Self {
        if maps > 1 { Self::MAPS } else { Self::FIRST_MAP }
    }

    /// Of so many photons \[bytes\].
    pub fn of(self, photons: f64) -> f64 {
        self.each * photons + self.first.1 * photons.min(self.first.0)
    }

    /// The part of so many photons that takes a part of their memory, both at most 1.
    pub fn part_in(self, part: f64, photons: f64) -> f64 {
        let (bytes, (count, beside)) = (part * self.of(photons), self.first);
        let among_first = bytes / (self.each + beside);
        let fits = if among_first < count { among_first } else { (bytes - beside * count) / self.each };
        if photons > 0.0 { fits / photons } else { part }
    }
}

/// Time that a stored photon takes on its way into the tree, of one processor \[s\]: measured with 2.8 x 10^6 of them. It is for
/// what users are told of a run beforehand, and no more.
pub(crate) const BUILD_SECONDS: f64 = 0.6e-6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_take_their_part_of_the_memory() {
        for peak in [PeakBytes::FIRST_MAP, PeakBytes::MAPS] {
            for photons in [1.0, 1e5, 5e5, 3e6, 1e9] {
                for part in [1e-3, 0.3, 0.9, 1.0] {
                    let fits = peak.part_in(part, photons);
                    assert!(fits <= part * (1.0 + 1e-12), "{photons} {part}: {fits}");
                    let error = peak.of(fits * photons) / (part * peak.of(photons)) - 1.0;
                    assert!(error.abs() < 1e-12, "{photons} {part}: {error}");
                }
            }
            assert_eq!((peak.part_in(0.5, 0.0), peak.of(0.0)), (0.5, 0.0));
        }
    }
}
