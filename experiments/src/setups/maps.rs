//! Maps of one number of photons, in batches.

use crate::harness::Settings;

/// One number of photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maps {
    /// Photons emitted into a map.
    pub photons: u64,
    /// Maps of one cell: a batch, so that cells of all sizes cost alike.
    pub batch: u64,
}

impl Maps {
    /// The ladder, from few photons to many: so many in a cell, by preset.
    pub fn ladder(settings: &Settings, quick: u64, full: u64) -> Vec<Maps> {
        // Below a thousand, sizes would no longer differ.
        let total = settings.photons(quick, full).max(1000);
        let batches = settings.pick(&[32, 10, 3, 1][..], &[128, 40, 12, 4, 1]);
        batches.iter().map(|&batch| Maps { photons: (total / batch).max(1), batch }).collect()
    }

    /// The group of cells.
    pub fn group(&self) -> String {
        format!("n{}", self.photons)
    }
}
