//! Measuring one map.

use super::cases::Case;
use super::fields::{FIELDS, Field};
use super::{section, sheet, spread};
use crate::harness::{CellId, CellOutput, Settings};
use anyhow::Context;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::stats::Moments;

/// All cells.
pub fn cells(settings: &Settings) -> Vec<CellId> {
    let mut cells: Vec<CellId> = Vec::new();
    for field in &FIELDS {
        for (photons, maps) in field.sizes(settings) {
            let cost = photons as f64 * field.stored_per_photon();
            cells.extend(
                CellId::replicates(&Case::group(field, photons), maps, cost).map(|c| c.holding(photons)),
            );
        }
    }
    cells.extend(section::cells(settings));
    cells.extend(sheet::cells(settings));
    cells.extend(spread::cells(settings));
    cells
}

/// Measures one cell.
pub fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    match cell.group.as_str() {
        section::GROUP => section::measure(settings, cell),
        sheet::GROUP => sheet::measure(settings, cell),
        spread::GROUP => spread::measure(settings, cell),
        group => {
            let (name, photons) = group.rsplit_once("-n").with_context(|| format!("group {group}"))?;
            let photons = photons.parse().with_context(|| format!("group {group}"))?;
            measure_map(settings, cell, Field::named(name)?, photons)
        }
    }
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
