//! "Maps are decoupled from geometry": the same photons and queries amid walls of 36 and of a million triangles.
//!
//! An estimate of 1998 is not handed the walls, and no measurement could show that it asks them. The default estimate of
//! the renderer does: it rejects photons that bodies hide, and divides by the part of the ball that is seen. Rays are
//! followed to the walls between gathers, as a renderer does, so that a large mesh may push photons out of the processor's
//! memory. Times are of this machine: they are in words and tables, not in results and claims.

use super::part::{Part, STREAM};
use super::times::Times;
use crate::harness::{CellId, CellOutput, Cells, Claim, Estimate, Group, Section, Settings, Unit};
use glam::DVec3;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Mesh, Shape};
use turbid::math::{Ray, warp};
use turbid::phase::{Isotropic, Phase};
use turbid::photons::{Flags, Photon, PhotonMap, Photons};
use turbid::rng::{Purpose, Stream};

/// The group of all cells.
pub const GROUP: &str = "walls";
/// Pairs of timings.
pub const PAIRS: usize = 40;
/// Photons an estimate.
const K: usize = 50;
/// Queries of one timing.
const QUERIES: usize = 1_000;
/// The case of the estimates, which are the same amid any mesh of the same walls.
const CASE: &str = "walls";
/// How far estimates amid meshes of the same walls may differ, relative: their corners are rounded to 1e-7 of the box, and
/// directions that meet a wall meet it in another triangle.
const SAME: f64 = 1e-6;

/// Squares along the sides of each face of the box: 12 triangles for each square of a face.
const FEW: [u32; 2] = [3, 1];
const MANY: [u32; 2] = [289, 289];

/// Triangles of both meshes.
pub const TRIANGLES: [u32; 2] = [12 * FEW[0] * FEW[1], 12 * MANY[0] * MANY[1]];

/// Photons of the map.
fn photons(settings: &Settings) -> u64 {
    settings.photons(65_000, 65_000)
}

/// One cell: every pair shares the meshes.
pub fn group(settings: &Settings) -> Group {
    Group::new(GROUP, 1, 1e6 + photons(settings) as f64, measure)
}

/// The name of a timing.
pub fn phase(what: &str, triangles: u32, pair: usize) -> String {
    format!("{what}, {triangles} triangles, pair {pair:02}")
}

/// The box from -1 to 1, each face cut into m x n squares of two triangles.
fn tessellated([m, n]: [u32; 2]) -> anyhow::Result<Mesh> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for j in 0..=n {
                for i in 0..=m {
                    let (u, v) =
                        (2.0 * f64::from(i) / f64::from(m) - 1.0, 2.0 * f64::from(j) / f64::from(n) - 1.0);
                    let mut place = DVec3::ZERO;
                    (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (side, u, v);
                    positions.push(place);
                }
            }
            for j in 0..n {
                for i in 0..m {
                    let at = |i: u32, j: u32| first + j * (m + 1) + i;
                    triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                    triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    Ok(Mesh::new(&positions, &triangles, None)?)
}

/// The walls as a body.
fn body(sides: [u32; 2]) -> anyhow::Result<[Shape; 1]> {
    Ok([Shape::Mesh(Arc::new(tessellated(sides)?))])
}

/// Even light in the box: how it came there does not matter to a gather.
fn map(settings: &Settings, replicate: u64) -> anyhow::Result<PhotonMap> {
    let count = photons(settings);
    let mut stream = Stream::new(settings.seed, Purpose::Synthetic, replicate, 0);
    let photon = |_| {
        let position = 2.0 * DVec3::from(stream.triple()) - 1.0;
        let dir = warp::square_to_sphere(stream.pair());
        Photon {
            position,
            dir: dir.as_vec3(),
            normal: glam::Vec3::ZERO,
            power: Spectrum::ONE.0.as_vec3(),
            order: 1,
            flags: Flags::MEDIUM,
        }
    };
    Ok(PhotonMap::new((0..count).map(photon).collect::<Photons>(), count)?)
}

/// Measures the cell.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let mut output = CellOutput::new();
    let replicate = cell.stream(STREAM);
    let map = output.time("map", |_| map(settings, replicate))?;
    let meshes = output.time("meshes", |_| anyhow::Ok([body(FEW)?, body(MANY)?]))?;
    let phase_function = Phase::Isotropic(Isotropic);
    let estimator = Estimator::new(Kernel::Uniform, Gather::nearest(K, 1.0)?).treated(Treatment::Clipped);
    let mut stream = Stream::new(settings.seed, Purpose::Paths, replicate, 0);
    let mut largest: f64 = 0.0;
    for pair in 0..PAIRS {
        let rays: Vec<Ray> = (0..QUERIES)
            .map(|_| {
                let origin = 1.8 * DVec3::from(stream.triple()) - 0.9;
                Ray::new(origin, warp::square_to_sphere(stream.pair()))
            })
            .collect();
        let mut found: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        // Each goes first in every second pair.
        for turn in [pair % 2, 1 - pair % 2] {
            let (mesh, triangles) = (&meshes[turn], TRIANGLES[turn]);
            let met = output.time(&phase("rays", triangles, pair), |_| {
                rays.iter().filter(|ray| mesh[0].hit(ray, None).is_some()).count()
            });
            anyhow::ensure!(met == rays.len(), "{met} of {} rays met the walls of a closed box", rays.len());
            let boundary = Boundary::UNKNOWN.about(mesh);
            found[turn] = output.time(&phase("gathers", triangles, pair), |_| {
                let of = |ray: &Ray| {
                    let (at, wo, one) = (ray.origin, ray.dir, Spectrum::ONE);
                    estimator.in_scattered(&map, at, wo, &phase_function, one, &boundary).value[0]
                };
                rays.iter().map(of).collect()
            });
        }
        let [few, many] = &found;
        largest = few.iter().zip(many).map(|(a, b)| (b / a - 1.0).abs()).fold(largest, f64::max);
    }
    output.push(CASE, "largest difference", largest);
    Ok(output)
}

/// Time amid many triangles over time amid few.
fn ratio(cells: &Cells, what: &str) -> Option<Times> {
    let took = |triangles, pair| cells.seconds(GROUP, &phase(what, triangles, pair)).first().copied();
    Times::of((0..PAIRS).filter_map(|pair| Some([took(TRIANGLES[0], pair)?, took(TRIANGLES[1], pair)?])))
}

/// Concludes.
pub fn conclude(cells: &Cells) -> anyhow::Result<Part> {
    let text = format!(
        "\"maps are decoupled from geometry\": the default estimate, which asks what bodies hide, amid {} triangles and amid \
         {} of the same walls: largest relative difference",
        TRIANGLES[1], TRIANGLES[0]
    );
    let largest = cells.values(CASE, "largest difference")?.into_iter().fold(0.0, f64::max);
    let largest = Estimate::exact(largest, 0.0);
    let claims = vec![Claim::at_most("decoupled", &text, Unit::ONE, largest, SAME)];
    let mut said = Vec::new();
    if let (Some(gathers), Some(rays)) = (ratio(cells, "gathers"), ratio(cells, "rays")) {
        said.push([
            "maps are decoupled from geometry".to_string(),
            format!(
                "an estimate of 1998 is not handed the geometry. The default estimate asks it what bodies hide: amid {} \
                 triangles it takes {} of the time amid {} (95 %): {}. Rays to the walls take {}",
                TRIANGLES[1],
                gathers.words(),
                TRIANGLES[0],
                gathers.against(0.9, 1.1),
                rays.words()
            ),
        ]);
    }
    Ok(Part { section: Section { claims, ..Section::default() }, said })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_closed_and_has_its_triangles() {
        for sides in [FEW, [7, 7]] {
            let mesh = tessellated(sides).unwrap();
            assert_eq!(mesh.len() as u32, 12 * sides[0] * sides[1]);
            let hit = mesh.hit(&Ray::new(DVec3::new(0.1, 0.2, 0.3), DVec3::X), None).unwrap();
            assert!((hit.t - 0.9).abs() < 1e-12);
        }
        assert_eq!(TRIANGLES, [36, 1_002_252]);
    }
}
