//! Everything that was measured, case by case.

use super::cases::{FIELDS, Field, LAYERS, Rival, Setting, Treatment};
use super::measure::layer_quantity;
use super::predict::layers;
use super::split::MapError;
use super::theory::{Expected, Rms};
use crate::cost_model::{LOOKED_AT, STORED};
use crate::harness::{Cells, Settings};
use crate::prediction::Predictions;

/// One setting and treatment: what was predicted and what each map said.
pub struct Measured {
    /// The setting.
    pub setting: Setting,
    /// What is done at the faces.
    pub treatment: Treatment,
    /// What was predicted, by layer.
    pub expected: Vec<Expected>,
    /// What each map said.
    pub maps: Vec<MapError>,
    /// Operations of each map before its first query: rays, and records put into the tree.
    pub prepare: Vec<f64>,
    /// Records that each map gathers for a query.
    pub found: Vec<f64>,
    /// What each map takes before its first query, counted in rays.
    pub prepare_rays: Vec<f64>,
    /// A query of each map, counted in rays.
    pub query_rays: Vec<f64>,
    /// CPU seconds of each map before its first query, on this machine.
    pub prepare_seconds: Vec<f64>,
    /// CPU seconds of a query of each map; those of a clipped one include the volume of the part inside.
    pub query_seconds: Vec<f64>,
}

impl Measured {
    /// The name in tables.
    pub fn case(&self) -> String {
        self.setting.case(self.treatment)
    }

    /// What was predicted, over all layers.
    pub fn predicted(&self) -> Rms {
        Rms::of(&self.expected)
    }

    /// Operations for so many queries, by the mean over maps.
    pub fn cost(&self, queries: f64) -> f64 {
        mean(&self.prepare) + queries * mean(&self.found)
    }

    /// CPU seconds for so many queries on this machine, by the mean over maps.
    pub fn seconds(&self, queries: f64) -> f64 {
        mean(&self.prepare_seconds) + queries * mean(&self.query_seconds)
    }

    /// Rays, and what takes as long, for so many queries, by the mean over maps.
    pub fn rays(&self, queries: f64) -> f64 {
        mean(&self.prepare_rays) + queries * mean(&self.query_rays)
    }

    /// The largest part of the predicted error.
    pub fn limit(&self) -> &'static str {
        let square =
            |part: fn(&Expected) -> f64| self.expected.iter().map(|e| part(e) * part(e)).sum::<f64>();
        let parts = [
            ("noise", square(|e| e.noise)),
            ("blur", square(|e| e.blur)),
            ("faces", square(|e| e.edge)),
            ("clusters", square(|e| e.clusters)),
        ];
        let largest = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        largest.map_or("", |(name, _)| name)
    }
}

/// Paths in one field.
pub struct Paths {
    /// The field.
    pub field: &'static Field,
    /// Relative error of each batch, averaged over layers.
    pub error: Vec<f64>,
    /// Relative variance of one sample by batch, averaged over layers.
    pub variance: Vec<f64>,
    /// Rays of one sample by batch, averaged over layers.
    pub rays: Vec<f64>,
    /// CPU seconds of one sample on this machine, by batch.
    pub seconds: Vec<f64>,
}

/// Guided paths in one field.
pub struct Guided {
    /// The paths.
    pub paths: Paths,
    /// Share of the cells whose directions are used, by batch.
    pub led: Vec<f64>,
    /// Share of the flights that are led to bright places, by batch.
    pub flights: Vec<f64>,
    /// CPU seconds of learning on this machine, by batch.
    pub learning: Vec<f64>,
}

impl Paths {
    /// Operations a query to reach a root mean square error: as many samples as its variance asks for, at least one.
    pub fn cost(&self, rms: f64) -> f64 {
        mean(&self.rays) * (mean(&self.variance) / (rms * rms)).max(1.0)
    }
}

/// A size of map in one field.
pub struct MapSize {
    /// The field.
    pub field: &'static Field,
    /// Photons emitted.
    pub photons: u64,
    /// Rays of each map.
    pub rays: Vec<f64>,
    /// Collisions of each map.
    pub collisions: Vec<f64>,
    /// Photons stored by each map.
    pub stored: Vec<f64>,
    /// Memory of each map [bytes].
    pub bytes: Vec<f64>,
    /// CPU seconds of shooting each map, and of building its tree, on this machine.
    pub seconds: [Vec<f64>; 2],
}

/// All of it.
pub struct Data {
    /// By setting and treatment.
    pub measured: Vec<Measured>,
    /// By field.
    pub paths: Vec<Paths>,
    /// By field.
    pub guided: Vec<Guided>,
    /// By field and number of photons.
    pub sizes: Vec<MapSize>,
}

/// The mean of a list.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl Data {
    /// Reads the cells.
    pub fn read(settings: &Settings, known: &Predictions, cells: &Cells) -> anyhow::Result<Self> {
        let mut data =
            Data { measured: Vec::new(), paths: Vec::new(), guided: Vec::new(), sizes: Vec::new() };
        for field in FIELDS {
            let exact: Vec<f64> = field
                .depths()
                .iter()
                .map(|t| known.get(field.name, &format!("fluence t={t}")).map(|v| v.0))
                .collect::<anyhow::Result<_>>()?;
            for photons in field.photons(settings) {
                let size = size(field, photons, cells)?;
                let records = |(rays, stored): (&f64, &f64)| rays + stored;
                let [shooting, building] = &size.seconds;
                let prepare_seconds: Vec<f64> = shooting.iter().zip(building).map(|(a, b)| a + b).collect();
                let prepare: Vec<f64> = size.rays.iter().zip(&size.stored).map(records).collect();
                let parts = |(rays, stored): (&f64, &f64)| rays + STORED * stored;
                let prepare_rays: Vec<f64> = size.rays.iter().zip(&size.stored).map(parts).collect();
                for setting in Setting::all(field, photons) {
                    let asked = (setting.lateral() * LAYERS) as f64;
                    let timed = |what: &str| {
                        let phase = format!("{what} {}", setting.size.name());
                        cells.seconds(&Setting::group(field, photons), &phase)
                    };
                    let plain: Vec<f64> = timed("gathering").iter().map(|s| s / asked).collect();
                    let clipped: Vec<f64> =
                        plain.iter().zip(timed("clipping")).map(|(p, s)| p + s / asked).collect();
                    for treatment in Treatment::ALL {
                        let found = cells.values(&setting.name(), "found")?;
                        data.measured.push(Measured {
                            setting,
                            treatment,
                            expected: layers(known, &setting, treatment)?,
                            maps: map_errors(&setting, treatment, &exact, cells)?,
                            prepare: prepare.clone(),
                            prepare_rays: prepare_rays.clone(),
                            query_rays: found.iter().map(|found| LOOKED_AT * found).collect(),
                            found,
                            prepare_seconds: prepare_seconds.clone(),
                            query_seconds: match treatment {
                                Treatment::Plain => plain.clone(),
                                Treatment::Clipped => clipped.clone(),
                            },
                        });
                    }
                }
                data.sizes.push(size);
            }
            data.paths.push(paths(Rival::Paths, field, &exact, cells)?);
            let group = Rival::Guided.group(field);
            data.guided.push(Guided {
                paths: paths(Rival::Guided, field, &exact, cells)?,
                led: cells.values(&group, "cells led")?,
                flights: cells.values(&group, "flights led")?,
                learning: cells.seconds(&group, "learning"),
            });
        }
        Ok(data)
    }

    /// The cases of one field, treatment and, if given, number of photons.
    pub fn of(&self, field: &Field, treatment: Treatment, photons: Option<u64>) -> Vec<&Measured> {
        let fits = |m: &&Measured| {
            m.setting.field == field
                && m.treatment == treatment
                && photons.is_none_or(|n| m.setting.photons == n)
        };
        self.measured.iter().filter(fits).collect()
    }

    /// Paths that nothing leads, in one field.
    pub fn paths(&self, field: &Field) -> Option<&Paths> {
        self.paths_of(Rival::Paths, field)
    }

    /// Those of a rival in a field.
    pub fn paths_of(&self, rival: Rival, field: &Field) -> Option<&Paths> {
        match rival {
            Rival::Paths => self.paths.iter().find(|paths| paths.field == field),
            Rival::Guided => {
                self.guided.iter().map(|guided| &guided.paths).find(|paths| paths.field == field)
            }
        }
    }

    /// The largest maps of a field.
    pub fn largest(&self, field: &Field) -> u64 {
        self.sizes.iter().filter(|s| s.field == field).map(|s| s.photons).max().unwrap_or(0)
    }
}

fn size(field: &'static Field, photons: u64, cells: &Cells) -> anyhow::Result<MapSize> {
    let group = Setting::group(field, photons);
    let shares = cells.values(&group, "share of the tree")?;
    // The tree holds copies of photons across the cell's edges: building is charged for the cell's own share.
    let building = cells.seconds(&group, "building");
    let own: Vec<f64> = building.iter().zip(&shares).map(|(seconds, share)| seconds * share).collect();
    Ok(MapSize {
        field,
        photons,
        rays: cells.values(&group, "rays")?,
        collisions: cells.values(&group, "collisions")?,
        stored: cells.values(&group, "stored")?,
        bytes: cells.values(&group, "bytes")?,
        seconds: [cells.seconds(&group, "shooting"), own],
    })
}

fn map_errors(
    setting: &Setting,
    treatment: Treatment,
    exact: &[f64],
    cells: &Cells,
) -> anyhow::Result<Vec<MapError>> {
    let (case, field) = (setting.case(treatment), setting.field);
    let mut maps: Vec<MapError> = Vec::new();
    for (layer, exact) in exact.iter().enumerate() {
        let means = cells.values(&case, &layer_quantity("fluence", field, layer))?;
        let squares = cells.values(&case, &layer_quantity("square", field, layer))?;
        maps.resize(means.len(), MapError { error: [0.0; LAYERS], square: 0.0 });
        for ((map, mean), square) in maps.iter_mut().zip(means).zip(squares) {
            let ratio = mean / exact;
            map.error[layer] = ratio - 1.0;
            map.square += (square / (exact * exact) - 2.0 * ratio + 1.0) / LAYERS as f64;
        }
    }
    Ok(maps)
}

fn paths(rival: Rival, field: &'static Field, exact: &[f64], cells: &Cells) -> anyhow::Result<Paths> {
    let (mut error, mut variance, mut rays) = (Vec::new(), Vec::new(), Vec::new());
    for (layer, exact) in exact.iter().enumerate() {
        let case = rival.case(field, layer);
        let means = cells.values(&case, "fluence")?;
        let squares = cells.values(&case, "square")?;
        let counts = cells.values(&case, "rays")?;
        for list in [&mut error, &mut variance, &mut rays] {
            list.resize(means.len(), 0.0);
        }
        for batch in 0..means.len() {
            error[batch] += (means[batch] / exact - 1.0) / LAYERS as f64;
            // About the exact mean, so that the variance of a batch is unbiased.
            let ratio = means[batch] / exact;
            variance[batch] += (squares[batch] / (exact * exact) - 2.0 * ratio + 1.0) / LAYERS as f64;
            rays[batch] += counts[batch] / LAYERS as f64;
        }
    }
    let total = cells.seconds(&rival.group(field), "path tracing");
    let samples = cells.values(&rival.case(field, 0), "samples")?;
    let seconds =
        total.iter().zip(samples).map(|(total, samples)| total / (samples * LAYERS as f64)).collect();
    Ok(Paths { field, error, variance, rays, seconds })
}
