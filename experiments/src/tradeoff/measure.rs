//! Measuring one map, or one batch of paths.

use super::cases::{FIELDS, Field, LAYERS, Rival, Setting, Treatment};
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::Spectrum;
use turbid::estimators::Estimate;
use turbid::estimators::boundary::Boundary;
use turbid::integrators::Guides;
use turbid::photons::{Guide, GuideSettings, Histories, PhotonMap, is_in, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity};
use turbid::sensor::sample_guided;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// Maps of each size, and batches of paths.
pub const MAPS: u64 = 64;

/// The quantity of a layer of probes: mean over its probes of the estimate, or of its square.
pub fn layer_quantity(what: &str, field: &Field, layer: usize) -> String {
    format!("{what} t={}", field.depth(layer))
}

/// Paths of one batch in one layer.
fn paths(settings: &Settings) -> u64 {
    settings.photons(256, 4096).max(16)
}

/// Histories that one batch learns from.
fn learned(settings: &Settings) -> u64 {
    settings.photons(4096, 32_768).max(100)
}

/// All cells: maps by field and number of photons, and batches of paths.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for field in FIELDS {
        for photons in field.photons(settings) {
            let asked = Setting::all(field, photons);
            let gathers = asked.iter().map(|s| s.lateral() * LAYERS).sum::<usize>() as f64;
            let cost = photons as f64 * (4.0 + 2.0 * field.setup.body.deepest()) + 20.0 * gathers;
            let measure =
                move |settings: &Settings, cell: &CellId| measure_map(settings, cell, field, photons);
            groups.push(Group::new(Setting::group(field, photons), MAPS, cost, measure).holding(photons));
        }
        for rival in Rival::ALL {
            let learning = if rival == Rival::Guided { learned(settings) as f64 } else { 0.0 };
            let cost = 20.0 * (paths(settings) as f64 * LAYERS as f64 + learning);
            let measure =
                move |settings: &Settings, cell: &CellId| measure_paths(settings, cell, field, rival);
            groups.push(Group::new(rival.group(field), MAPS, cost, measure));
        }
    }
    groups
}

fn measure_map(
    settings: &Settings,
    cell: &CellId,
    field: &'static Field,
    photons: u64,
) -> anyhow::Result<CellOutput> {
    let (scene, replicate) = (field.setup.scene()?, cell.stream("tradeoff"));
    let mut output = CellOutput::new();
    let asked = Setting::all(field, photons);
    let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: None };
    let pass = output.time("shooting", |_| shoot(&scene, histories, &[], is_in(Orders::ALL), &NoProgress))?;
    let stored = pass.photons().count();
    // Every history is absorbed at a collision or escapes by one flight more.
    let escaped = pass.report.ledger.escaped / pass.report.ledger.emitted * photons as f64;
    let collisions = pass.report.collisions;
    let rays = collisions as f64 + escaped.round();
    output.count("photons emitted", pass.emitted());
    output.count("collisions", collisions);
    output.count("photons stored", stored as u64);
    let reach = asked.iter().map(Setting::overhang).fold(0.0, f64::max);
    let map = output.time("building", |_| pass.into_map(reach))?;
    // Records of the cell itself among those of its surroundings.
    let share = stored as f64 / map.stored() as f64;
    let case = Setting::group(field, photons);
    output.push(&case, "collisions", collisions as f64);
    output.push(&case, "rays", rays);
    output.push(&case, "stored", stored as f64);
    output.push(&case, "share of the tree", share);
    output.push(&case, "bytes", share * map.tree().bytes() as f64);
    for setting in asked {
        gather(&mut output, &map, &setting)?;
    }
    Ok(output)
}

/// Sums over the probes of one layer. One gather serves both treatments: clipping is the plain estimate over the part of
/// the ball in the fog, in closed form, as the library's has it by quadrature at fifty times the cost.
#[derive(Default)]
struct Layer {
    plain: [f64; 2],
    clipped: [f64; 2],
}

fn gather(output: &mut CellOutput, map: &PhotonMap, setting: &Setting) -> anyhow::Result<()> {
    let (field, estimator) = (setting.field, setting.estimator()?);
    let (mut found, mut underfull) = (0u64, 0u64);
    let phase = format!("gathering {}", setting.size.name());
    let estimates: Vec<Vec<Estimate>> = output.time(&phase, |_| {
        let ask = |probe| estimator.fluence(map, probe, Spectrum::ONE, &Boundary::UNKNOWN);
        let layer = |depth| field.setup.body.places(setting.side(), depth).into_iter().map(ask).collect();
        field.depths().into_iter().map(layer).collect()
    });
    let phase = format!("clipping {}", setting.size.name());
    let layers = output.time(&phase, |_| -> anyhow::Result<Vec<Layer>> {
        let mut layers = Vec::with_capacity(LAYERS);
        for (depth, estimates) in field.depths().into_iter().zip(&estimates) {
            let room = field.setup.body.room(depth);
            let mut layer = Layer::default();
            for estimate in estimates {
                found += estimate.found as u64;
                underfull += u64::from(estimate.underfull);
                let value = estimate.value[0];
                let inside = if estimate.radius <= room {
                    1.0
                } else {
                    field.setup.body.inside(estimate.radius, depth)?
                };
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
            output.push(&case, layer_quantity("fluence", field, index), sums[0] / probes);
            output.push(&case, layer_quantity("square", field, index), sums[1] / probes);
        }
    }
    Ok(())
}

fn measure_paths(
    settings: &Settings,
    cell: &CellId,
    field: &Field,
    rival: Rival,
) -> anyhow::Result<CellOutput> {
    let (scene, replicate) = (field.setup.scene()?, cell.stream("tradeoff"));
    let mut output = CellOutput::new();
    let paths = paths(settings);
    let guide = match rival {
        Rival::Paths => None,
        Rival::Guided => {
            let asked =
                GuideSettings { histories: learned(settings), seed: settings.seed, replicate, share: None };
            let guide = output.time("learning", |_| Guide::learn(&scene, &asked, &NoProgress))?;
            let [cells, led] = guide.counts()[0];
            output.push(rival.group(field), "cells led", led as f64 / cells.max(1) as f64);
            let flights = guide.brightness().map_or(0.0, |brightness| brightness.share);
            output.push(rival.group(field), "flights led", flights);
            Some(guide)
        }
    };
    let guides = Guides { learned: guide.as_ref(), ..Guides::default() };
    for layer in 0..LAYERS {
        let depth = field.depth(layer);
        let quantity = Quantity::Fluence(field.setup.body.middle(depth));
        let (mut values, mut squares, mut total) = (Moments::new(), Moments::new(), 0u64);
        output.time("path tracing", |output| {
            for path in 0..paths {
                let history = (layer as u64) << 40 | path;
                let mut stream = Stream::new(settings.seed, Purpose::Paths, replicate, history);
                let (value, rays) = sample_guided(&scene, &quantity, Orders::ALL, guides, &mut stream);
                output.non_finite += u64::from(!value.is_finite());
                values.push(value[0]);
                squares.push(value[0] * value[0]);
                total += rays.total();
            }
        });
        output.count("paths", paths);
        output.count("rays of paths", total);
        let case = rival.case(field, layer);
        output.push(&case, "fluence", values.mean());
        output.push(&case, "square", squares.mean());
        output.push(&case, "samples", paths as f64);
        output.push(&case, "rays", total as f64 / paths as f64);
    }
    Ok(output)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setups::Size;
    use turbid::estimators::Estimator;
    use turbid::estimators::boundary::Treatment as Remedy;

    /// Clipping here is the library's, in a slab and in a sphere, near the surface and deep.
    #[test]
    fn clipping_is_that_of_the_library() {
        for name in ["thin", "sphere"] {
            let field = FIELDS.into_iter().find(|field| field.name == name).unwrap();
            let histories = Histories { count: 2000, seed: 3, replicate: 0, max_order: None };
            let pass = shoot(&field.setup.scene().unwrap(), histories, &[], is_in(Orders::ALL), &NoProgress)
                .unwrap();
            let map = pass.into_map(0.0).unwrap();
            let medium = field.setup.body.shape().unwrap();
            let boundary = Boundary::of(&medium).unwrap();
            for size in [Size::Radius(0.4), Size::Nearest(50)] {
                let estimator = Setting { field, photons: 2000, size }.estimator().unwrap();
                for depth in [0, 1, 8, 15].map(|layer| field.depth(layer)) {
                    let probe = field.setup.body.places(4, depth)[5];
                    let ask = |estimator: Estimator| estimator.fluence(&map, probe, Spectrum::ONE, &boundary);
                    let (library, plain) = (ask(estimator.treated(Remedy::Clipped)).value[0], ask(estimator));
                    let here = plain.value[0] / field.setup.body.inside(plain.radius, depth).unwrap();
                    // The library's quadrature is good to 1e-13 of a whole ball; a third of one is left at least.
                    assert!((here / library - 1.0).abs() < 1e-12, "{name}, depth {depth}: {here} {library}");
                }
            }
        }
    }
}
