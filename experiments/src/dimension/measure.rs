//! Measuring one batch of maps.

use super::cases::{
    ALBEDO, BEAMS, CELLS, DEPTH, MU0, POINTS, Query, SHOOTING, SPAN, middles, name, places, radii, rays,
    reading, scene, sizes,
};
use crate::harness::{CellId, CellOutput, Group, Settings};
use crate::setups::Maps;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{BeamEstimator, Estimator, Gather, Kernel, RayEstimator};
use turbid::math::{FOUR_PI, Positive, Ray};
use turbid::photons::beams::BeamMap;
use turbid::photons::{Emitter, Histories, Photon, PhotonMap, Run, Storage};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::{Flags, NoProgress};

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
        let mut pass = output.time(SHOOTING, |_| run.pass(&Uncollided, &NoProgress))?;
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

/// Photons on their way to the first event: where they collide, and how they get there.
struct Uncollided;

impl Storage for Uncollided {
    fn in_medium(&self, _: u64, photon: &Photon) -> bool {
        photon.order == 0
    }

    fn has_beams(&self) -> bool {
        true
    }

    fn on_flight(&self, _: u64, order: u32, _: Flags) -> bool {
        order == 0
    }
}

/// One pass as points and as beams.
struct Stored {
    points: PhotonMap,
    beams: BeamMap,
}

/// The relative errors of all questions of a kind to a map: of the fluence at places, or of its integral along rays.
fn asked(query: Query, scene: &Scene, stored: &Stored, radius: f64) -> anyhow::Result<Vec<f64>> {
    let exact = libm::exp(-DEPTH / MU0);
    let kernel = Kernel::Uniform;
    let length = Positive::new("the radius", radius)?;
    let balls = Estimator::new(kernel, Gather::radius(radius)?);
    let fluence = |place| balls.fluence(&stored.points, place, Spectrum::ONE, &Boundary::UNKNOWN).value[0];
    let medium = &scene.regions()[0].medium;
    // All of it passes, so that a ray is the same all along.
    let passed = |_: f64| Spectrum::ONE;
    let whole = exact * ALBEDO * SPAN.length() / FOUR_PI;
    Ok(match query {
        Query::Places => places().into_iter().map(|place| fluence(place) / exact - 1.0).collect(),
        Query::Marched => {
            let along = |ray: Ray| middles().map(|t| fluence(ray.at(t))).collect::<Moments>();
            rays().map(|ray| along(ray).mean() / exact - 1.0).collect()
        }
        Query::Rays => {
            let points = RayEstimator { kernel, radius: length, is_clipped: false };
            let read = |ray: Ray| {
                points.radiance(&stored.points, (&ray, SPAN), medium, &Boundary::UNKNOWN, passed).value[0]
            };
            rays().map(|ray| read(ray) / whole - 1.0).collect()
        }
        Query::Beams => {
            let beams = BeamEstimator { kernel, radius: length, is_clipped: false };
            let read = |ray: Ray| {
                beams.radiance(&stored.beams, (&ray, SPAN), (0, medium), &Boundary::UNKNOWN, passed).value[0]
            };
            rays().map(|ray| read(ray) / whole - 1.0).collect()
        }
    })
}
