//! Measuring one map.

use super::cases::Case;
use super::fields::{FIELDS, Field};
use super::{section, sheet, spread};
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::stats::Moments;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for field in FIELDS {
        for (photons, maps) in field.sizes(settings) {
            let cost = photons as f64 * field.stored_per_photon();
            let measure =
                move |settings: &Settings, cell: &CellId| measure_map(settings, cell, field, photons);
            groups.push(Group::new(Case::group(field, photons), maps, cost, measure).holding(photons));
        }
    }
    groups.extend([section::group(settings), sheet::group(settings), spread::group(settings)]);
    groups
}

fn measure_map(
    settings: &Settings,
    cell: &CellId,
    field: &'static Field,
    photons: u64,
) -> anyhow::Result<CellOutput> {
    let map = field.map(settings, cell, photons)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", photons);
    output.count("photons stored", map.stored() as u64);
    let medium = field.setup.body.shape()?;
    let boundary = Boundary::of(&medium)?;
    for case in Case::all(settings, field, photons) {
        let estimator = case.estimator()?;
        let mut values = Moments::new();
        for probe in case.probes() {
            let estimate = estimator.fluence(&map, probe, Spectrum::ONE, &boundary);
            values.push(estimate.value[0]);
            output.count("under-full estimates", u64::from(estimate.underfull));
        }
        output.count("estimates", values.n());
        output.push(case.name(), "fluence", values.mean());
    }
    Ok(output)
}
