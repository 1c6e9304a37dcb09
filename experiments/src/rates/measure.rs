//! Measuring one batch of maps.

use super::cases::{self, CELL, DEPTHS, Size, TAU, name, probes, radii};
use crate::harness::{CellId, CellOutput, Settings};
use anyhow::Context;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Shape, Slab};
use turbid::light::{Beam, Light, Section};
use turbid::medium::Homogeneous;
use turbid::phase::{Isotropic, Phase};
use turbid::photons::{Histories, is_in, shoot};
use turbid::scene::{Orders, Parts, Region, Scene};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn cells(settings: &Settings) -> Vec<CellId> {
    let mut all = Vec::new();
    for size in Size::all(settings) {
        let cost = 1.5 * (size.photons * size.batch) as f64;
        all.extend(
            CellId::replicates(&size.group(), cases::cells(settings), cost).map(|c| c.holding(size.photons)),
        );
    }
    all
}

/// The slab under a normal beam of irradiance 1, without scattering; lengths are mean free paths.
fn scene() -> anyhow::Result<Scene> {
    let medium = Homogeneous::new(Spectrum::ONE, Spectrum::ZERO, Phase::Isotropic(Isotropic))?;
    let region = Region { shape: Shape::Slab(Slab::new(0.0, TAU)?), medium: medium.into() };
    let lights = vec![Light::Beam(Beam::new(DVec3::Z, Spectrum::ONE, Section::Unbounded)?)];
    Ok(Scene::new(Parts { regions: vec![region], lights, cell: Some(CELL), ..Parts::default() })?)
}

/// Measures one cell: error and squared error, relative to e^-t, over the probes of all maps of the batch.
pub fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let sizes = Size::all(settings);
    let own = sizes.iter().find(|size| size.group() == cell.group);
    let size = own.with_context(|| format!("group {}", cell.group))?;
    let scene = scene()?;
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
