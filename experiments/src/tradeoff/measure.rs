//! Measuring one map, or one batch of paths.

use super::cases::{CELL, LAYERS, SLABS, Setting, Slab, Treatment, paths_case, paths_group, probes};
use crate::harness::{CellId, CellOutput, Settings};
use anyhow::Context;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::{Kernel, fluence};
use turbid::photons::{Histories, PhotonMap, fold, is_in, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::sensor::sample_counted;
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::volumes::ball_slab_volume;

/// Maps of each size, and batches of paths.
pub const MAPS: u64 = 64;

/// The quantity of a layer of probes: mean over its probes of the estimate, or of its square.
pub fn layer_quantity(what: &str, slab: &Slab, layer: usize) -> String {
    format!("{what} t={}", slab.depth(layer))
}

/// Paths of one batch in one layer.
fn paths(settings: &Settings) -> u64 {
    settings.photons(256, 4096).max(16)
}

/// All cells: maps by slab and number of photons, and batches of paths.
pub fn cells(settings: &Settings) -> Vec<CellId> {
    let mut cells = Vec::new();
    for slab in &SLABS {
        for photons in slab.photons(settings) {
            let asked = Setting::all(slab, photons);
            let gathers = asked.iter().map(|s| s.lateral() * LAYERS).sum::<usize>() as f64;
            let cost = photons as f64 * (4.0 + 2.0 * slab.tau) + 20.0 * gathers;
            cells.extend(CellId::replicates(&Setting::group(slab, photons), MAPS, cost));
        }
        let cost = 20.0 * paths(settings) as f64 * LAYERS as f64;
        cells.extend(CellId::replicates(&paths_group(slab), MAPS, cost));
    }
    cells
}

/// Measures one cell.
pub fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let (name, what) = cell.group.rsplit_once('-').with_context(|| format!("group {}", cell.group))?;
    let slab = Slab::named(name)?;
    let scene = slab.scene()?;
    let replicate = cell.stream("tradeoff");
    if what == "paths" {
        return Ok(measure_paths(settings, slab, &scene, replicate));
    }
    let photons = what.trim_start_matches('n').parse().with_context(|| format!("group {}", cell.group))?;
    measure_map(settings, slab, &scene, photons, replicate)
}

fn measure_map(
    settings: &Settings,
    slab: &'static Slab,
    scene: &Scene,
    photons: u64,
    replicate: u64,
) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    let asked = Setting::all(slab, photons);
    let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: None };
    let mut pass =
        output.time("shooting", |_| shoot(scene, histories, &[], is_in(Orders::ALL), &NoProgress))?;
    let stored = pass.photons.len();
    // Every history is absorbed at a collision or escapes by one flight more.
    let escaped = pass.ledger.escaped / pass.ledger.emitted * photons as f64;
    let rays = pass.collisions as f64 + escaped.round();
    output.count("photons emitted", pass.emitted);
    output.count("collisions", pass.collisions);
    output.count("photons stored", stored as u64);
    let margin = asked.iter().map(Setting::cap).fold(0.0, f64::max);
    fold::surround(&mut pass.photons, CELL, margin);
    let map = output.time("building", |_| PhotonMap::new(pass.photons, pass.emitted))?;
    // Records of the cell itself among those of its surroundings.
    let share = stored as f64 / map.stored() as f64;
    let case = Setting::group(slab, photons);
    output.push(&case, "collisions", pass.collisions as f64);
    output.push(&case, "rays", rays);
    output.push(&case, "stored", stored as f64);
    output.push(&case, "share of the tree", share);
    output.push(&case, "bytes", share * map.tree().bytes() as f64);
    for setting in asked {
        gather(&mut output, &map, &setting)?;
    }
    Ok(output)
}

/// Sums over the probes of one layer.
#[derive(Default)]
struct Layer {
    plain: [f64; 2],
    clipped: [f64; 2],
}

fn gather(output: &mut CellOutput, map: &PhotonMap, setting: &Setting) -> anyhow::Result<()> {
    let (slab, how) = (setting.slab, setting.gather()?);
    let (mut found, mut underfull) = (0u64, 0u64);
    let phase = format!("gathering {}", setting.size.name());
    let estimates: Vec<Vec<_>> = output.time(&phase, |_| {
        let ask = |probe| fluence(map, probe, Spectrum::ONE, Kernel::Uniform, how);
        slab.depths().into_iter().map(|depth| probes(setting.side(), depth).map(ask).collect()).collect()
    });
    let phase = format!("clipping {}", setting.size.name());
    let layers = output.time(&phase, |_| -> anyhow::Result<Vec<Layer>> {
        let mut layers = Vec::with_capacity(LAYERS);
        for (depth, estimates) in slab.depths().into_iter().zip(&estimates) {
            let room = depth.min(slab.tau - depth);
            let mut layer = Layer::default();
            for estimate in estimates {
                found += estimate.found as u64;
                underfull += u64::from(estimate.underfull);
                let value = estimate.value[0];
                let inside =
                    if estimate.radius <= room { 1.0 } else { inside(slab, depth, estimate.radius)? };
                for (sums, value) in [(&mut layer.plain, value), (&mut layer.clipped, value / inside)] {
                    sums[0] += value;
                    sums[1] += value * value;
                }
            }
            layers.push(layer);
        }
        Ok(layers)
    })?;
    let asked = setting.lateral() * LAYERS;
    output.count("estimates", asked as u64);
    output.count("under-full estimates", underfull);
    output.count("photons gathered", found);
    output.push(setting.name(), "found", found as f64 / asked as f64);
    let probes = setting.lateral() as f64;
    for (index, layer) in layers.iter().enumerate() {
        for (treatment, sums) in Treatment::ALL.iter().zip([layer.plain, layer.clipped]) {
            let case = setting.case(*treatment);
            output.push(&case, layer_quantity("fluence", slab, index), sums[0] / probes);
            output.push(&case, layer_quantity("square", slab, index), sums[1] / probes);
        }
    }
    Ok(())
}

/// The part of a ball that lies in the slab.
pub fn inside(slab: &Slab, depth: f64, radius: f64) -> anyhow::Result<f64> {
    let ball = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
    Ok(ball_slab_volume(radius, depth, slab.tau)?.value / ball)
}

fn measure_paths(settings: &Settings, slab: &Slab, scene: &Scene, replicate: u64) -> CellOutput {
    let mut output = CellOutput::new();
    let paths = paths(settings);
    for layer in 0..LAYERS {
        let quantity = Quantity::Fluence(DVec3::new(0.5 * CELL, 0.5 * CELL, slab.depth(layer)));
        let (mut values, mut squares, mut total) = (Moments::new(), Moments::new(), 0u64);
        output.time("path tracing", |output| {
            for path in 0..paths {
                let history = (layer as u64) << 40 | path;
                let mut stream = Stream::new(settings.seed, Purpose::Paths, replicate, history);
                let (value, rays) = sample_counted(scene, &quantity, Orders::ALL, &mut stream);
                output.non_finite += u64::from(!value.is_finite());
                values.push(value[0]);
                squares.push(value[0] * value[0]);
                total += rays.total();
            }
        });
        output.count("paths", paths);
        output.count("rays of paths", total);
        let case = paths_case(slab, layer);
        output.push(&case, "fluence", values.mean());
        output.push(&case, "square", squares.mean());
        output.push(&case, "samples", paths as f64);
        output.push(&case, "rays", total as f64 / paths as f64);
    }
    output
}
