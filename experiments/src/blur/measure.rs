//! Measuring one map.

use super::cases::Case;
use super::{shaft, waves};
use crate::harness::{CellId, CellOutput, Settings};
use anyhow::Context;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::photons::{Histories, shoot};
use turbid::transport::NoProgress;

/// All cells: maps of the shaft by number of photons, and maps of a sinusoid.
pub fn cells(settings: &Settings) -> Vec<CellId> {
    let mut cells = Vec::new();
    for (photons, maps) in shaft::sizes(settings) {
        // Whatever the photons, a map is asked a few thousand times.
        let maps = CellId::replicates(&Case::group(photons), maps, photons as f64 + 10_000.0);
        cells.extend(maps.map(|cell| cell.holding(photons)));
    }
    cells.extend(waves::cells(settings));
    cells
}

/// The cases of maps of one number of photons.
pub fn cases(settings: &Settings, photons: u64) -> Vec<Case> {
    let largest = shaft::sizes(settings).iter().map(|s| s.0).max();
    Case::all(photons, Some(photons) == largest)
}

/// Every case of a study.
pub fn all_cases(settings: &Settings) -> Vec<Case> {
    shaft::sizes(settings).into_iter().flat_map(|(photons, _)| cases(settings, photons)).collect()
}

/// Measures one cell.
pub fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    if cell.group == waves::GROUP {
        return waves::measure(settings, cell);
    }
    let photons = cell.group.strip_prefix("shaft-n").and_then(|n| n.parse().ok());
    let photons: u64 = photons.with_context(|| format!("group {}", cell.group))?;
    let scene = shaft::scene()?;
    let histories =
        Histories { count: photons, seed: settings.seed, replicate: cell.stream("blur"), max_order: Some(0) };
    let pass = shoot(&scene, histories, &[], |_| true, &NoProgress)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", pass.emitted());
    output.count("photons stored", pass.photons().count() as u64);
    let map = pass.into_map(0.0)?;
    for case in cases(settings, photons) {
        let estimator = case.estimator()?;
        for place in case.places() {
            let (mut sum, mut probes) = (0.0, 0u64);
            for probe in case.probes(place) {
                let estimate = estimator.fluence(&map, probe, Spectrum::ONE, &Boundary::UNKNOWN);
                sum += estimate.value[0];
                probes += 1;
                output.count("under-full estimates", u64::from(estimate.underfull));
            }
            output.count("estimates", probes);
            output.push(case.name(), Case::quantity(place), sum / (probes as f64 * shaft::fluence()));
        }
    }
    Ok(output)
}
