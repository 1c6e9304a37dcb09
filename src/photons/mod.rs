//! Photons: the record, the pass that stores them, the periodic cell, the tree over their positions, maps, and files of them.

pub mod beams;
mod emit;
mod ends;
pub mod file;
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
pub use map::PhotonMap;
pub use pass::{Ends, Histories, Ledger, Part, Pass, PassReport, Run, Storage, is_in, is_indirect, shoot};
pub use record::{Photon, Photons};
pub use tallies::Scores;
pub(crate) use tallies::score_bytes;
pub use tree::PhotonTree;

/// Memory that a photon of a large map takes at most \[bytes\]: 52 or, on a surface, 64 as its pass stores it; then its columns and
/// its place in the order, 44 or 56, with the column of 12 that is just put in order.
const PHOTON_BYTES: f64 = 66.0;

/// What each of the first photons of a map takes beside: small pieces that the allocator keeps when others have taken their place, and
/// memory that the threads sort in.
const FIRST: (f64, f64) = (2e6, 52.0);

/// Most memory that so many stored photons take on their way into a map \[bytes\]. Measured: see `tests/cli/memory.rs`.
pub fn peak_bytes(photons: f64) -> f64 {
    PHOTON_BYTES * photons + FIRST.1 * photons.min(FIRST.0)
}

/// The part of so many photons that takes a part of their memory, both at most 1.
pub fn part_in(part: f64, photons: f64) -> f64 {
    let bytes = part * peak_bytes(photons);
    let each = PHOTON_BYTES + FIRST.1;
    let fits = if bytes < each * FIRST.0 { bytes / each } else { (bytes - FIRST.1 * FIRST.0) / PHOTON_BYTES };
    if photons > 0.0 { fits / photons } else { part }
}

/// Time that a stored photon takes on its way into the tree, of one processor \[s\]: measured with 2.8 x 10^6 of them. It is for
/// what users are told of a run beforehand, and no more.
pub(crate) const BUILD_SECONDS: f64 = 0.6e-6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_take_their_part_of_the_memory() {
        for photons in [1.0, 1e5, 2e6, 3e6, 1e9] {
            for part in [1e-3, 0.3, 0.9, 1.0] {
                let fits = part_in(part, photons);
                assert!(fits <= part * (1.0 + 1e-12), "{photons} {part}: {fits}");
                let error = peak_bytes(fits * photons) / (part * peak_bytes(photons)) - 1.0;
                assert!(error.abs() < 1e-12, "{photons} {part}: {error}");
            }
        }
        assert_eq!((part_in(0.5, 0.0), peak_bytes(0.0)), (0.5, 0.0));
    }
}
