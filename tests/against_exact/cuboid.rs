//! The cuboid of isotropic scattering: absorption and fluence under light of one face, of all faces, and of the volume.

use crate::checks::slab::exact;
use crate::support::run::{paths, tallies};
use crate::support::scenes::{area_light, bounded, cuboid, isotropic, rectangle, region, volume_source};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::light::{Faces, Light};
use turbid::scene::{Orders, Quantity};
use turbid_analytic::{Cuboid, CuboidSource};

const SIDES: [f64; 3] = [1.0, 1.5, 0.5];
const ALBEDO: f64 = 0.9;

fn light(source: CuboidSource) -> Light {
    let body = cuboid(DVec3::ZERO, DVec3::from(SIDES));
    match source {
        CuboidSource::Faces => isotropic(body, Faces::Both),
        CuboidSource::Uniform => volume_source(body),
        // A lamp flush with the face: it takes what leaves there.
        _ => {
            let lamp = rectangle(DVec3::ZERO, DVec3::Y * SIDES[1], DVec3::Z * SIDES[2]);
            area_light(lamp, Spectrum::grey(1.0 / PI))
        }
    }
}

#[test]
fn absorption_and_fluence_inside() {
    for source in [CuboidSource::Faces, CuboidSource::Uniform, CuboidSource::Face] {
        let referee = Cuboid::new(SIDES, ALBEDO, source).unwrap();
        let body = cuboid(DVec3::ZERO, DVec3::from(SIDES));
        let scene = bounded(vec![region(body, 1.0, ALBEDO, 0.0)], Vec::new(), vec![light(source)]);
        let absorbed = &tallies(&scene, &[(Quantity::Absorbed(0), Orders::ALL)], 1 << 17, 1)[0][0];
        let name = format!("photons: absorbed, {source:?}");
        verdict::agrees(&name, absorbed, exact(referee.absorptance()), 0.005, 1);
        if source == CuboidSource::Faces {
            let wrong = Cuboid::new(SIDES, 0.88, source).unwrap();
            verdict::rejects(&name, absorbed, wrong.absorptance().value, 1);
        }
        for place in [[0.5, 0.75, 0.25], [0.1, 0.3, 0.4], [0.95, 1.2, 0.1]] {
            let value = referee.fluence(place).unwrap();
            let moments = paths(&scene, Quantity::Fluence(DVec3::from(place)), Orders::ALL, 1 << 15, 2)[0];
            let name = format!("paths: fluence, {source:?}, at {place:?}");
            verdict::agrees(&name, &moments, exact(value), 0.1 * value.value, 2);
        }
    }
}
