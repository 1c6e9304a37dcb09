//! Measuring one sequence of maps.

use super::cases::{CELLS, QUERIES, Schedule, best, maps, name, photons, radii, rays, schedules, stops};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::uncollided::{
    Query, Uncollided, along_beams, along_points, at_place, beams_at_place, places, scene,
};
use turbid::photons::beams::BeamMap;
use turbid::photons::{Emitter, Histories, PhotonMap, Run};
use turbid::scene::Scene;
use turbid::stats::{Moments, student_critical};
use turbid::transport::NoProgress;

/// The group of all cells.
pub const GROUP: &str = "sequences";

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let cost = 12.0 * (photons(settings) * maps(settings)) as f64;
    vec![Group::new(GROUP, CELLS, cost, measure).holding(photons(settings))]
}

/// One question by one schedule, over the maps so far.
struct Reading {
    query: Query,
    schedule: Schedule,
    radii: Vec<f64>,
    /// Relative errors, one a place or ray.
    errors: Vec<Moments>,
}

/// Measures one cell: error and squared error of the means over the first maps, and whether the spread between maps holds the exact
/// value.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let scene = scene()?;
    let emitter = Emitter::by_power(&scene);
    let (photons, maps, stops) = (photons(settings), maps(settings), stops(settings));
    let mut output = CellOutput::new();
    let mut all = Vec::new();
    for query in QUERIES {
        let (first, oracle) = best(settings, query)?;
        for schedule in schedules(query) {
            let radii = radii(query, schedule, maps, first, oracle);
            all.push(Reading { query, schedule, radii, errors: Vec::new() });
        }
    }
    let side = scene.periodic_cell().map(|cell| cell.side);
    let largest = all.iter().flat_map(|reading| &reading.radii).fold(0.0, |most: f64, r| most.max(*r));
    for map in 0..maps {
        // Cells are below 2^16: no two maps share a number.
        let replicate = cell.stream("progressive") ^ map << 16;
        let histories = Histories { count: photons, seed: settings.seed, replicate, max_order: Some(0) };
        let store = Uncollided { points: true, beams: true };
        let mut pass = Run::new(&scene, &emitter, histories).pass(&store, &NoProgress)?;
        output.count("photons emitted", photons);
        let beams = BeamMap::new(std::mem::take(&mut pass.beams), photons, side)?;
        let points = pass.into_map(largest)?;
        for reading in &mut all {
            let errors = read(reading.query, &scene, (&points, &beams), reading.radii[map as usize])?;
            reading.errors.resize(errors.len(), Moments::new());
            reading.errors.iter_mut().zip(errors).for_each(|(moments, error)| moments.push(error));
        }
        if stops.contains(&(map + 1)) {
            all.iter().for_each(|reading| push(&mut output, reading, map + 1));
        }
    }
    Ok(output)
}

/// The relative errors of all questions of a kind to a map.
fn read(
    query: Query,
    scene: &Scene,
    (points, beams): (&PhotonMap, &BeamMap),
    radius: f64,
) -> anyhow::Result<Vec<f64>> {
    match query {
        Query::BeamsAtPlaces => {
            places().into_iter().map(|place| beams_at_place(beams, scene, place, radius)).collect()
        }
        Query::Places | Query::Marched => {
            places().into_iter().map(|place| at_place(points, place, radius)).collect()
        }
        Query::Rays => rays().map(|ray| along_points(points, scene, &ray, radius)).collect(),
        Query::Beams => rays().map(|ray| along_beams(beams, scene, &ray, radius)).collect(),
    }
}

/// What the means over so many maps say.
fn push(output: &mut CellOutput, reading: &Reading, maps: u64) {
    let case = name(reading.query, reading.schedule, maps);
    let (mut errors, mut squares, mut holds) = (Moments::new(), Moments::new(), Moments::new());
    for moments in &reading.errors {
        errors.push(moments.mean());
        squares.push(moments.mean() * moments.mean());
        if maps >= 2 {
            let reach = student_critical(0.05, maps - 1) * moments.std_error();
            holds.push(f64::from(u8::from(moments.mean().abs() < reach)));
        }
    }
    output.push(&case, "error", errors.mean());
    output.push(&case, "squared error", squares.mean());
    if maps >= 2 {
        output.push(&case, "coverage", holds.mean());
    }
}
