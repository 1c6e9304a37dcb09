//! Where photons pass: those of lights from outside, and those that collide.

use crate::error::{Error, Result};
use crate::light::{Faces, Light, Section};
use crate::math::evenly_in_cube;
use crate::scene::{Binned, Crossing, Scene, Sensor, Space};
use glam::DVec3;

/// Whether photons pass wherever light that goes straight is in the bins of a sensor: those of an unbounded beam and of a slab lit from
/// outside start on the slab's face, those of a sun cover what is in the scene.
pub(super) fn check_reach(scene: &Scene, sensor: &Sensor) -> Result<()> {
    let (normal, corners) = match sensor.binned() {
        _ if !sensor.orders.contains(0) => return Ok(()),
        Some(Binned::Flux { bins, crossing }) => {
            let normal = bins.rectangle().normal();
            let normal = match crossing {
                Crossing::Net => None,
                Crossing::Along => Some(normal),
                Crossing::Against => Some(-normal),
            };
            (normal, bins.rectangle().corners().to_vec())
        }
        Some(Binned::Fluence { space: Space::Voxels(voxels), .. }) => {
            let (min, max) = (voxels.cuboid().min(), voxels.cuboid().max());
            let corner = |i: usize| {
                DVec3::from_array([0, 1, 2].map(|a| if i >> a & 1 == 0 { min[a] } else { max[a] }))
            };
            (None, (0..8).map(corner).collect())
        }
        _ => return Ok(()),
    };
    let counts = |dir: DVec3| normal.is_none_or(|normal| normal.dot(dir) > 0.0);
    let slab = scene.periodic_cell().map(|periodic_cell| periodic_cell.slab);
    let before = |dir: DVec3, p: &DVec3| {
        slab.is_some_and(|slab| {
            let close = 1e-9 * slab.thickness();
            if dir.z > 0.0 { p.z < slab.top() - close } else { p.z > slab.top() + slab.thickness() + close }
        })
    };
    let is_missed = |light: &Light, p: &DVec3| match light {
        Light::Beam(beam) => {
            beam.section() == Section::Unbounded && counts(beam.dir()) && before(beam.dir(), p)
        }
        Light::Isotropic(light) => [DVec3::Z, DVec3::NEG_Z]
            .iter()
            .any(|dir| (light.faces() == Faces::Both || dir.z > 0.0) && counts(*dir) && before(*dir, p)),
        Light::Sun(sun) => scene.bounds().is_some_and(|bounds| {
            counts(sun.dir()) && (*p - bounds.center()).length() > bounds.radius() * (1.0 + 1e-9)
        }),
        _ => false,
    };
    let missed = |p: &DVec3| scene.lights().iter().any(|light| is_missed(light, p));
    match corners.iter().find(|p| missed(p)) {
        Some(p) => Err(Error::Unreachable(format!(
            "sensor {}: its bins reach ({}, {}, {}), where photons have not been that come from outside: give it `min_order = 1`, keep it \
             within the scene's media and bodies, or use paths",
            sensor.name, p.x, p.y, p.z
        ))),
        None => Ok(()),
    }
}

/// Whether light of every channel collides at a place.
pub(super) fn has_extinction(scene: &Scene, p: DVec3) -> bool {
    scene.medium_at(p).is_some_and(|medium| medium.sigma_t(p).min() > 0.0)
}

/// Points of a bin where extinction is looked for, of all bins together, and the fewest of one of them.
const LOOKED_AT: (usize, usize) = (4096, 1 << 20);
const FEWEST: usize = 4;

/// A place in the bins where light of some channel does not collide, if there is one among evenly spread points, the same for every seed:
/// an empty part that is smaller than they lie apart may be missed.
pub(super) fn empty_place(scene: &Scene, binned: &Binned) -> Option<DVec3> {
    let (bins, cell) = (binned.bins(), scene.periodic_cell());
    let points = (LOOKED_AT.1 / bins).clamp(FEWEST, LOOKED_AT.0);
    (0..bins).find_map(|bin| {
        (1..=points as u32)
            .map(|i| binned.point(bin, cell, evenly_in_cube(i)))
            .find(|&p| !has_extinction(scene, p))
    })
}
