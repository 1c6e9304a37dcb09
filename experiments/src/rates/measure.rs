//! Measuring one batch of maps.

use super::cases::{self, DEPTHS, SETUP, name, probes, radii, sizes};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::Maps;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::photons::{Histories, is_in, shoot};
use turbid::scene::Orders;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let group = |size: Maps| {
        let cost = 1.5 * (size.photons * size.batch) as f64;
        let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, size);
        Group::new(size.group(), cases::cells(settings), cost, measure).holding(size.photons)
    };
    sizes(settings).into_iter().map(group).collect()
}

/// Measures one cell: error and squared error, relative to e^-t, over the probes of all maps of the batch.
fn measure(settings: &Settings, cell: &CellId, size: Maps) -> anyhow::Result<CellOutput> {
    let scene = SETUP.scene()?;
    let radii = radii();
    let mut output = CellOutput::new();
    let mut errors = vec![Moments::new(); DEPTHS.len() * radii.len()];
    let mut squares = errors.clone();
    for map in 0..size.batch {
        // Batches are below 256: no two maps of the group share a number.
        let replicate = cell.stream("rates") ^ map << 16;
        let histories = Histories { count: size.photons, seed: settings.seed, replicate, max_order: Some(0) };
        let pass = shoot(&scene, histories, &[], is_in(Orders::only(0)), &NoProgress)?;
        output.count("photons emitted", pass.emitted());
        let map = pass.into_map(0.0)?;
        for (d, &depth) in DEPTHS.iter().enumerate() {
            let exact = libm::exp(-depth);
            for (r, &radius) in radii.iter().enumerate() {
                let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
                for probe in probes(depth) {
                    let estimate = estimator.fluence(&map, probe, Spectrum::ONE, &Boundary::UNKNOWN);
                    let error = estimate.value[0] / exact - 1.0;
                    errors[d * radii.len() + r].push(error);
                    squares[d * radii.len() + r].push(error * error);
                    output.count("estimates", 1);
                }
            }
        }
    }
    for (d, &depth) in DEPTHS.iter().enumerate() {
        for (r, &radius) in radii.iter().enumerate() {
            let case = name(size.photons, depth, radius);
            output.push(&case, "error", errors[d * radii.len() + r].mean());
            output.push(&case, "squared error", squares[d * radii.len() + r].mean());
        }
    }
    Ok(output)
}
