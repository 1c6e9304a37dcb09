//! Measuring one batch of maps.

use super::cases::{CELLS, LARGEST, MAPS, PILOT, Selector, TARGETS, advised, is_asked, is_put, name, sizes};
use super::fields::{Field, Source, scene, wave, with_sensor};
use super::predict::Expected;
use super::select::Question;
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::uncollided::{Uncollided, along_beams, along_points};
use std::collections::BTreeMap;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::photons::beams::BeamMap;
use turbid::photons::synthetic::Number;
use turbid::photons::{Emitter, Histories, PhotonMap, Run};
use turbid::scene::Scene;
use turbid::sensor::{Pilot, PilotSettings};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let mut groups = Vec::new();
    for source in Source::ALL {
        for (photons, batch) in sizes(settings) {
            let measure =
                move |settings: &Settings, cell: &CellId| measure(settings, cell, source, (photons, batch));
            let cost = 3.0 * (photons * batch) as f64;
            let group = format!("{}-n{photons}", source.name());
            groups.push(Group::new(group, CELLS, cost, measure).holding(photons));
        }
    }
    for field in [Field::Places, Field::Light] {
        let measure = move |settings: &Settings, cell: &CellId| advice(settings, cell, field);
        let cost = (2 * PILOT * MAPS) as f64;
        groups.push(Group::new(format!("advice-{}", field.name()), CELLS, cost, measure));
    }
    groups
}

/// One map.
struct Stored {
    scene: Scene,
    points: PhotonMap,
    beams: Option<BeamMap>,
}

impl Stored {
    /// The map of a source; beams only where they are asked.
    fn new(
        source: Source,
        photons: u64,
        (seed, replicate): (u64, u64),
        is_beams: bool,
    ) -> anyhow::Result<Self> {
        let scene = scene(source)?;
        if source == Source::Wave {
            let points = wave()?.map(Number::Exact(photons), seed, replicate)?;
            return Ok(Stored { scene, points, beams: None });
        }
        let emitter = Emitter::by_power(&scene);
        let histories = Histories { count: photons, seed, replicate, max_order: Some(0) };
        let store = Uncollided { points: true, beams: is_beams };
        let mut pass = Run::new(&scene, &emitter, histories).pass(&store, &NoProgress)?;
        let side = scene.periodic_cell().map(|cell| cell.side);
        let beams = std::mem::take(&mut pass.beams);
        let beams = is_beams.then(|| BeamMap::new(beams, photons, side)).transpose()?;
        let reach = if side.is_some() { LARGEST } else { 0.0 };
        let points = pass.into_map(reach)?;
        Ok(Stored { scene, points, beams })
    }

    /// The estimate of a question, by its number, with a radius, over the exact value.
    fn read(&self, field: Field, question: usize, radius: f64) -> anyhow::Result<f64> {
        match (field, &self.beams) {
            (Field::Rays, _) => {
                Ok(1.0 + along_points(&self.points, &self.scene, &field.rays()[question], radius)?)
            }
            (Field::Beams, Some(beams)) => {
                Ok(1.0 + along_beams(beams, &self.scene, &field.rays()[question], radius)?)
            }
            _ => self.gathered(field, question, Gather::radius(radius)?),
        }
    }

    /// The estimate at a place by a gather, over the exact value.
    fn gathered(&self, field: Field, question: usize, gather: Gather) -> anyhow::Result<f64> {
        let estimator = Estimator::new(Kernel::Uniform, gather);
        let place = field.places()[question];
        let estimate = estimator.fluence(&self.points, place, Spectrum::ONE, &Boundary::UNKNOWN);
        Ok(estimate.value[0] / field.exact())
    }
}

/// Measures one cell: error, squared error and, where it is one, the chosen radius over the best.
fn measure(
    settings: &Settings,
    cell: &CellId,
    source: Source,
    (photons, batch): (u64, u64),
) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    let of_source = |field: &Field| field.source() == source && is_asked(settings, *field, photons);
    let fields: Vec<Field> = Field::ALL.into_iter().filter(of_source).collect();
    let laws = fields.iter().map(|&field| {
        let weight = field.ball(LARGEST)?.weight / photons as f64;
        Ok((field, Expected::best(field, photons)?.radius, weight))
    });
    let laws = laws.collect::<anyhow::Result<Vec<_>>>()?;
    let mut means: BTreeMap<String, [Moments; 3]> = BTreeMap::new();
    for map in 0..batch {
        // Cells are below 256, and maps below 2^16: no two of the group share a number.
        let replicate = cell.stream("selection") ^ map << 8;
        let is_beams = fields.contains(&Field::Beams);
        let stored = Stored::new(source, photons, (settings.seed, replicate), is_beams)?;
        output.count("photons emitted", photons);
        for &(field, best, weight) in &laws {
            let questions = if field.is_place() { field.places().len() } else { field.rays().len() };
            for number in 0..questions {
                let read = |radius: f64| stored.read(field, number, radius);
                let question = Question::new(field.codimension(), best, weight, &read);
                for selector in Selector::ALL.into_iter().filter(|s| is_put(*s, field)) {
                    let radius = question.radius(selector)?;
                    let value = match (selector, radius) {
                        (_, Some(radius)) => question.read(radius)?,
                        (Selector::Nearest(k), None) => {
                            stored.gathered(field, number, Gather::nearest(k, LARGEST)?)?
                        }
                        (_, None) => continue,
                    };
                    let [errors, squares, radii] = means.entry(name(field, photons, selector)).or_default();
                    errors.push(value - 1.0);
                    squares.push((value - 1.0) * (value - 1.0));
                    if let Some(radius) = radius {
                        radii.push(libm::log2(radius / best));
                    }
                }
            }
        }
    }
    for (name, [errors, squares, radii]) in means {
        output.push(&name, "error", errors.mean());
        output.push(&name, "squared error", squares.mean());
        if radii.n() > 0 {
            output.push(&name, "octaves from the best radius", radii.mean());
        }
    }
    Ok(output)
}

/// Measures one pilot: what its advice for some errors would cost, over the best radius with as many photons as it advises.
fn advice(settings: &Settings, cell: &CellId, field: Field) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    let scene = with_sensor(field)?;
    // A seed of its own: a pilot numbers its maps itself.
    let seed = settings.seed ^ cell.stream("selection");
    let pilot = Pilot::run(&scene, &PilotSettings { photons: PILOT, maps: MAPS, seed }, &NoProgress)?;
    output.count("photons emitted", PILOT * MAPS);
    for target in TARGETS {
        let advice = pilot.advise(target)?;
        let best = Expected::best(field, advice.photons)?;
        let own = Expected::new(field, advice.photons, advice.radius)?;
        let name = advised(field, target);
        output.push(&name, "squared regret", own.squared / best.squared);
        output.push(&name, "error over target", own.squared.sqrt() / target);
        output.push(&name, "photons", advice.photons as f64);
    }
    Ok(output)
}
