//! Measuring one map.

use super::cases::Case;
use super::{shaft, waves};
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::photons::{Histories, shoot};
use turbid::transport::NoProgress;

/// All cells: maps of the shaft by number of photons, and maps of a sinusoid.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for (photons, maps) in shaft::sizes(settings) {
        // Whatever the photons, a map is asked a few thousand times.
        let cost = photons as f64 + 10_000.0;
        let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, photons);
        groups.push(Group::new(Case::group(photons), maps, cost, measure).holding(photons));
    }
    groups.push(waves::group(settings));
    groups
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

/// Measures one map.
fn measure(settings: &Settings, cell: &CellId, photons: u64) -> anyhow::Result<CellOutput> {
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
