//! Measuring one batch of maps.

use super::cases::{
    self, DEPTH, FILLING, MU0, Query, SPAN, Size, middles, name, places, radii, rays, reading, scene,
};
use crate::harness::{CellId, CellOutput, Group, Settings};
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{FOUR_PI, Positive};
use turbid::photons::{Histories, PhotonMap, is_in, shoot};
use turbid::scene::{Orders, Scene};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// All cells.
pub fn groups(settings: &Settings) -> Vec<Group> {
    let group = |size: Size| {
        let cost = 3.0 * (size.photons * size.batch) as f64;
        let measure = move |settings: &Settings, cell: &CellId| measure(settings, cell, size);
        Group::new(size.group(), cases::cells(settings), cost, measure).holding(size.photons)
    };
    Size::all(settings).into_iter().map(group).collect()
}

/// Measures one cell: error and squared error, relative to the exact value, over the questions to all maps of the batch.
fn measure(settings: &Settings, cell: &CellId, size: Size) -> anyhow::Result<CellOutput> {
    let scene = scene()?;
    let radii = radii();
    let mut output = CellOutput::new();
    let mut errors = vec![Moments::new(); Query::ALL.len() * radii.len()];
    let mut squares = errors.clone();
    for map in 0..size.batch {
        // Batches are below 256: no two maps of the group share a number.
        let replicate = cell.stream("dimension") ^ map << 16;
        let histories = Histories { count: size.photons, seed: settings.seed, replicate, max_order: Some(0) };
        let map = output.time(FILLING, |output| -> anyhow::Result<PhotonMap> {
            let pass = shoot(&scene, histories, &[], is_in(Orders::only(0)), &NoProgress)?;
            output.count("photons emitted", pass.emitted());
            Ok(pass.into_map(radii[radii.len() - 1])?)
        })?;
        for (q, query) in Query::ALL.into_iter().enumerate() {
            for (r, &radius) in radii.iter().enumerate() {
                let index = q * radii.len() + r;
                let values = output.time(&reading(query, radius), |_| asked(query, &scene, &map, radius))?;
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

/// The relative errors of all questions of a kind to a map: of the fluence at places, or of its integral along rays.
fn asked(query: Query, scene: &Scene, map: &PhotonMap, radius: f64) -> anyhow::Result<Vec<f64>> {
    let exact = libm::exp(-DEPTH / MU0);
    let balls = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
    let fluence = |place| balls.fluence(map, place, Spectrum::ONE, &Boundary::UNKNOWN).value[0];
    let medium = &scene.regions()[0].medium;
    Ok(match query {
        Query::Places => places().into_iter().map(|place| fluence(place) / exact - 1.0).collect(),
        Query::Marched => rays()
            .map(|ray| {
                let along: Moments = middles().map(|t| fluence(ray.at(t))).collect();
                along.mean() / exact - 1.0
            })
            .collect(),
        Query::Rays => {
            let of_rays = balls.along_rays(Positive::new("the radius", radius)?).of_rays();
            // All of it passes, so that a ray is the same all along.
            let radiance = |ray| {
                let read = of_rays.map(|of_rays| {
                    of_rays.radiance(map, (&ray, SPAN), medium, &Boundary::UNKNOWN, |_| Spectrum::ONE)
                });
                read.map_or(f64::NAN, |read| read.value[0])
            };
            let albedo = medium.albedo(rays().next().map_or(glam::DVec3::ZERO, |ray| ray.origin))[0];
            let whole = exact * albedo * SPAN.length() / FOUR_PI;
            rays().map(|ray| radiance(ray) / whole - 1.0).collect()
        }
    })
}
