//! Measuring one map, or one batch of paths.

use super::cases::Case;
use super::fields::{FIELDS, Field};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::Size;
use turbid::Spectrum;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::Boundary;
use turbid::photons::{Histories, is_in, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Quantity;
use turbid::sensor::sample;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Name of the groups of path batches.
const BY_PATHS: &str = "paths";

/// The name of a path tracer's case.
pub fn path_case(field: &Field, depth: f64) -> String {
    format!("{} t={depth} {BY_PATHS}", field.name)
}

/// The name of the case of whole maps.
pub fn map_case(field: &Field, photons: u64) -> String {
    format!("{} n={photons}", field.name)
}

/// All cells: maps by field and number of photons, and batches of paths for the fields that need them.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for field in FIELDS {
        for (photons, maps) in field.sizes(settings) {
            // A history of all orders has a few collisions, and each photon is stored, sorted and gathered.
            let cost = photons as f64 * if field.has_clusters() { 4.0 } else { 1.0 };
            let measure = move |settings: &Settings, cell: &CellId| {
                measure_map(settings, field, photons, cell.replicate)
            };
            groups.push(Group::new(Case::group(field, photons), maps, cost, measure).holding(photons));
        }
        if field.has_clusters() {
            let (batches, paths) = field.paths;
            let cost = paths as f64 * settings.photon_scale * field.depths.len() as f64;
            let name = format!("{}-{BY_PATHS}", field.name);
            groups.push(Group::new(name, batches, cost, |settings, cell| {
                measure_paths(settings, field, cell.replicate)
            }));
        }
    }
    groups
}

fn measure_map(
    settings: &Settings,
    field: &'static Field,
    photons: u64,
    replicate: u64,
) -> anyhow::Result<CellOutput> {
    let replicate = field.replicate(settings, photons, replicate);
    let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: field.orders.max };
    let pass = shoot(&field.setup.scene()?, histories, &[], is_in(field.orders), &NoProgress)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", pass.emitted());
    output.count("collisions", pass.report.collisions);
    output.count("photons stored", pass.photons().count() as u64);
    output.push(
        map_case(field, photons),
        "stored per emitted",
        pass.photons().count() as f64 / pass.emitted() as f64,
    );
    let map = pass.into_map(0.0)?;
    for case in Case::all(field, photons) {
        let estimator = case.estimator()?;
        let (mut values, mut counts, mut gathered) = (Moments::new(), Moments::new(), 0u64);
        for probe in case.probes() {
            let estimate = estimator.fluence(&map, probe, Spectrum::ONE, &Boundary::UNKNOWN);
            values.push(estimate.value[0]);
            gathered += estimate.found as u64;
            output.count("estimates", 1);
            output.count("under-full estimates", u64::from(estimate.underfull));
            counts.push(estimate.found as f64);
        }
        output.count("photons gathered", gathered);
        output.push(case.name(), "fluence", values.mean());
        if is_fano_case(&case) && counts.n() > 1 {
            output.push(case.name(), "count", counts.mean());
            output.push(case.name(), "count variance", counts.variance());
        }
    }
    Ok(output)
}

/// Fewest probes whose counts have a variance: four mean free paths hold 25 balls of radius 0.4.
const FEWEST: usize = 25;

/// Whether photon counts of a case are compared with Poisson's law: whole balls, uniform kernel, enough probes.
pub fn is_fano_case(case: &Case) -> bool {
    let Size::Radius(r) = case.size else { return false };
    let is_whole = case.field.setup.body.room(case.depth) >= r;
    is_whole && case.kernel == Kernel::Uniform && case.probes().len() >= FEWEST
}

fn measure_paths(settings: &Settings, field: &Field, replicate: u64) -> anyhow::Result<CellOutput> {
    let scene = field.setup.scene()?;
    let replicate = field.replicate(settings, 0, replicate);
    let mut output = CellOutput::new();
    let paths = ((field.paths.1 as f64 * settings.photon_scale) as u64).max(2);
    for (index, &depth) in field.depths.iter().enumerate() {
        let quantity = Quantity::Fluence(field.setup.body.middle(depth));
        let mut values = Moments::new();
        for path in 0..paths {
            let history = (index as u64) << 40 | path;
            let mut stream = Stream::new(settings.seed, Purpose::Paths, replicate, history);
            let value = sample(&scene, &quantity, field.orders, &mut stream);
            output.non_finite += u64::from(!value.is_finite());
            values.push(value[0]);
        }
        output.count("paths", paths);
        output.push(path_case(field, depth), "fluence", values.mean());
    }
    Ok(output)
}
