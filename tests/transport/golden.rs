//! First values of each sampler and a digest of one small run.
//!
//! **A value that changes here changes every result of the same seed: note it in CHANGELOG.md.** These are the
//! program's own past output: they say that nothing moved, not that it is right; the other tests do that.

use crate::support::scenes::{
    self, Incidence, area_light, emitting_sphere, isotropic, point_light, rectangle, slab, sphere,
};
use glam::DVec3;
use turbid::Spectrum;
use turbid::light::{Faces, Light};
use turbid::math::Asymmetry;
use turbid::phase::{Phase, PhaseFunction};
use turbid::photons::Photon;
use turbid::rng::{Purpose, Stream};

#[test]
fn streams() {
    let first = |purpose: Purpose, history: u64| Stream::new(1, purpose, 0, history).bits();
    let purposes =
        [Purpose::Photons, Purpose::Paths, Purpose::LightTracing, Purpose::Synthetic, Purpose::Resampling];
    let words: Vec<String> = purposes.iter().map(|p| format!("{:016x}", first(*p, 0))).collect();
    assert_eq!(words, STREAMS);
    assert_eq!(format!("{:016x}", first(Purpose::Photons, 1)), NEXT_HISTORY);
    let mut stream = Stream::new(42, Purpose::Photons, 3, 7);
    let units = [stream.unit(), stream.unit(), stream.open_unit()];
    assert_eq!(units.map(f64::to_bits), UNITS.map(f64::to_bits), "{units:?}");
}

#[test]
fn phase_functions() {
    for (g, expected) in PHASES {
        let phase = Phase::with_asymmetry(Asymmetry::try_from(g).unwrap());
        let (m, p) = phase.sample(0.3);
        assert_eq!(
            [m, p, phase.eval(m, p)].map(f64::to_bits),
            expected.map(f64::to_bits),
            "g = {g}: [{m:?}, {p:?}, {:?}]",
            phase.eval(m, p)
        );
    }
}

/// Origin and direction of the first photon of each light.
#[test]
fn emission() {
    let ball = sphere(DVec3::ZERO, 1.0);
    let scene = slab(2.0, 0.9, 0.0, Incidence::Beam(0.5));
    let lights: Vec<Light> = vec![
        scene.lights()[0].clone(),
        point_light(DVec3::ZERO, Spectrum::ONE),
        area_light(rectangle(DVec3::ZERO, DVec3::X, DVec3::Y), Spectrum::ONE),
        emitting_sphere(DVec3::ZERO, 0.5),
        isotropic(ball.clone(), Faces::Both),
        isotropic(scenes::layer(2.0), Faces::Both),
        scenes::volume_source(ball),
    ];
    let found: Vec<String> = lights
        .iter()
        .map(|light| {
            let ray = light.emit(scene.periodic_cell(), &mut Stream::new(1, Purpose::Photons, 0, 0)).ray;
            format!(
                "{:016x}",
                digest(
                    ray.origin.to_array().into_iter().chain(ray.dir.to_array()).flat_map(f64::to_le_bytes)
                )
            )
        })
        .collect();
    assert_eq!(found, EMISSION);
}

/// FNV-1a, 64 bits.
fn digest(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn bytes(photon: &Photon) -> Vec<u8> {
    let mut bytes: Vec<u8> = photon.position.to_array().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(photon.dir.to_array().iter().chain(&photon.power.to_array()).flat_map(|x| x.to_le_bytes()));
    bytes.extend(photon.order.to_le_bytes());
    bytes
}

/// Every bit of the photons of a small slab: position, direction, power, order.
#[test]
fn photons_of_a_small_run() {
    let scene = slab(2.0, 0.9, 0.75, Incidence::Beam(0.5));
    let photons = crate::support::run::pass(&scene, &[], 10_000, 1, |_| true).photons().collect::<Vec<_>>();
    let found = (photons.len(), format!("{:016x}", digest(photons.iter().flat_map(bytes))));
    assert_eq!((found.0, found.1.as_str()), RUN);
}

const STREAMS: [&str; 5] =
    ["1f6c0a44a35a64c6", "7c92b1ce2e972cb4", "dfa5263efca896ed", "1e4b34bb41d88b6e", "562e6ff7274955fb"];
const NEXT_HISTORY: &str = "7632e23ca2396d6b";
const UNITS: [f64; 3] = [0.9460051853013405, 0.1577592264397043, 0.5277236329718701];
const PHASES: [(f64, [f64; 3]); 3] = [
    (0.0, [1.4, 0.6, 0.07957747154594767]),
    (0.75, [0.21875000000000003, 1.78125, 0.14260282901033822]),
    (-0.9, [1.994712370242215, 0.005287629757785464, 5.544975852218378]),
];
const EMISSION: [&str; 7] = [
    "40443e2e1e40ff0a",
    "8de11460380dfa9e",
    "c69b8cb9b0988163",
    "0750a6e457672d00",
    "040fa1c66816d7f8",
    "3f3c5accc1aa6fe3",
    "4e8193256bf260d9",
];
const RUN: (usize, &str) = (34_933, "08902f009cfe8c7d");
