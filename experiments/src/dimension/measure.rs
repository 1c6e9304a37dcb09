//! Measuring one batch of maps.

use super::cases::{BEAMS, CELLS, POINTS, SHOOTING, middles, name, radii, rays, reading, sizes};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::Maps;
use crate::setups::uncollided::{
    Query, Uncollided, along_beams, along_points, at_place, beams_at_place, places, scene,
};
use turbid::photons::beams::BeamMap;
use turbid::photons::{Emitter, Histories, PhotonMap, Run};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let group = |size: Maps| {
        let cost = 3.0 * (size.photons * size.batch) as f64;
        let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, size);
        Group::new(size.group(), CELLS, cost, measure).holding(size.photons)
    };
    sizes(settings).into_iter().map(group).collect()
}

/// Measures one cell: error and squared error, relative to the exact value, over the questions to all maps of the batch.
fn measure(settings: &Settings, cell: &CellId, size: Maps) -> anyhow::Result<CellOutput> {
    let scene = scene()?;
    let emitter = Emitter::by_power(&scene);
    let radii = radii();
    let mut output = CellOutput::new();
    let mut errors = vec![Moments::new(); Query::ALL.len() * radii.len()];
    let mut squares = errors.clone();
    for map in 0..size.batch {
        // Batches are below 256: no two maps of the group share a number.
        let replicate = cell.stream("dimension") ^ map << 16;
        let histories = Histories { count: size.photons, seed: settings.seed, replicate, max_order: Some(0) };
        let run = Run::new(&scene, &emitter, histories);
        let store = Uncollided { points: true, beams: true };
        let mut pass = output.time(SHOOTING, |_| run.pass(&store, &NoProgress))?;
        output.count("photons emitted", pass.emitted());
        let beams = std::mem::take(&mut pass.beams);
        let side = scene.periodic_cell().map(|cell| cell.side);
        let stored = Stored {
            beams: output.time(BEAMS, |_| BeamMap::new(beams, pass.emitted(), side))?,
            points: output.time(POINTS, |_| pass.into_map(radii[radii.len() - 1]))?,
        };
        for (q, query) in Query::ALL.into_iter().enumerate() {
            for (r, &radius) in radii.iter().enumerate() {
                let index = q * radii.len() + r;
                let values =
                    output.time(&reading(query, radius), |_| asked(query, &scene, &stored, radius))?;
                output.count("questions", values.len() as u64);
                for error in values {
                    errors[index].push(error);
                    squares[index].push(error * error);
                }
            }
        }
    }
    for (q, query) in Query::ALL.into_iter().enumerate() {
        for (r, &radius) in radii.iter().enumerate() {
            let case = name(query, size.photons, radius);
            output.push(&case, "error", errors[q * radii.len() + r].mean());
            output.push(&case, "squared error", squares[q * radii.len() + r].mean());
        }
    }
    Ok(output)
}

/// One pass as points and as beams.
struct Stored {
    points: PhotonMap,
    beams: BeamMap,
}

/// The relative errors of all questions of a kind to a map: of the fluence at places, or of its integral along rays.
fn asked(query: Query, scene: &Scene, stored: &Stored, radius: f64) -> anyhow::Result<Vec<f64>> {
    let Stored { points, beams } = stored;
    match query {
        Query::Places => places().into_iter().map(|place| at_place(points, place, radius)).collect(),
        Query::BeamsAtPlaces => {
            places().into_iter().map(|place| beams_at_place(beams, scene, place, radius)).collect()
        }
        Query::Marched => rays()
            .map(|ray| {
                let along = middles().map(|t| at_place(points, ray.at(t), radius));
                Ok(along.collect::<anyhow::Result<Vec<f64>>>()?.iter().collect::<Moments>().mean())
            })
            .collect(),
        Query::Rays => rays().map(|ray| along_points(points, scene, &ray, radius)).collect(),
        Query::Beams => rays().map(|ray| along_beams(beams, scene, &ray, radius)).collect(),
    }
}
