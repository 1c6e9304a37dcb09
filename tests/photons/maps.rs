//! The three maps: who is in which, how many are emitted and stored, the same bits on any number of threads.

use crate::support::scenes::{area_light, bounded, cuboid, lambertian, rectangle, region};
use glam::DVec3;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::photons::maps::{
    Amount, Indirect, MOST_A_STORED, MapSettings, Maps, MediumSamples, PILOT, counts, fill, forecast,
};
use turbid::photons::{Flags, Photon, PhotonMap};
use turbid::scene::Scene;
use turbid::surface::{Mirror, Surface};
use turbid::transport::NoProgress;

/// A box of diffuse walls with a light under its ceiling, and a block in it; fog where asked for.
fn room(block: Surface, sigma_t: f64) -> Scene {
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    let light = rectangle(DVec3::new(0.6, 0.6, 1.9), DVec3::Y * 0.8, DVec3::X * 0.8);
    let grey = || lambertian(Spectrum::grey(0.6));
    let wall = |corner, u, v| (Shape::Rectangle(rectangle(corner, u, v)), grey());
    let objects = vec![
        wall(DVec3::ZERO, x, y),
        wall(z, x, y),
        wall(DVec3::ZERO, x, z),
        wall(y, x, z),
        wall(DVec3::ZERO, y, z),
        wall(x, y, z),
        (cuboid(DVec3::new(0.3, 0.4, 0.0), DVec3::new(0.9, 1.1, 0.7)), block),
    ];
    let fog = (sigma_t > 0.0).then(|| region(cuboid(DVec3::ZERO, DVec3::splat(2.0)), sigma_t, 0.8, 0.0));
    bounded(fog.into_iter().collect(), objects, vec![area_light(light, Spectrum::ONE)])
}

fn mirror() -> Surface {
    Surface::Mirror(Mirror::new(Spectrum::grey(0.9)).unwrap())
}

fn settings(indirect: Indirect) -> MapSettings {
    let amount = Amount::Emitted(20_000);
    MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect,
        seed: 1,
        replicate: 0,
    }
}

fn photons(map: &Option<PhotonMap>) -> Vec<Photon> {
    map.as_ref().unwrap().tree().photons().collect()
}

fn filled(scene: &Scene, settings: MapSettings) -> Maps {
    fill(scene, &settings, &NoProgress).unwrap()
}

#[test]
fn each_map_holds_its_classes() {
    let scene = room(mirror(), 0.5);
    let seen = filled(&scene, settings(Indirect::Seen));
    let gathered = filled(&scene, settings(Indirect::Gathered));
    let is_scattered = |p: &Photon| p.flags.has(Flags::DIFFUSE) || p.flags.has(Flags::MEDIUM);
    assert!(photons(&seen.global).iter().all(is_scattered));
    assert!(photons(&seen.caustic).iter().all(|p| p.flags == Flags::SPECULAR && p.order == 0));
    assert!(photons(&seen.volume).iter().all(|p| p.flags != Flags::NONE));
    assert!(photons(&seen.volume).iter().any(|p| p.flags == Flags::SPECULAR));
    let all = photons(&gathered.global);
    let rest = all.iter().filter(|p| !is_scattered(p)).count();
    assert_eq!(all.len() - rest, photons(&seen.global).len());
    assert!(all.iter().any(|p| p.flags == Flags::NONE) && all.iter().any(|p| p.flags == Flags::SPECULAR));
    assert_eq!(photons(&gathered.volume).len(), photons(&seen.volume).len());
    // Every hit of a diffuse surface is stored when gathered, and every collision is counted.
    assert_eq!(gathered.report.main.hits, all.len() as u64);
    assert!(gathered.report.main.collisions > photons(&seen.volume).len() as u64);
}

#[test]
fn what_a_scene_does_not_need_is_absent() {
    let diffuse = lambertian(Spectrum::grey(0.5));
    let clear = filled(&room(diffuse.clone(), 0.0), settings(Indirect::Seen));
    assert!(clear.volume.is_none() && clear.caustic.is_none() && clear.global.is_some());
    assert_eq!((clear.report.caustic.emitted, clear.report.main.collisions), (0, 0));
    let foggy = filled(&room(diffuse, 0.5), settings(Indirect::Seen));
    assert!(foggy.volume.is_some() && foggy.caustic.is_none());
    let mirrored = filled(&room(mirror(), 0.0), settings(Indirect::Seen));
    assert!(mirrored.volume.is_none() && mirrored.caustic.is_some());
    assert_eq!(mirrored.report.caustic.emitted, 20_000);
}

/// In a closed room nothing escapes; photons keep their power, and what ends holds all of it.
#[test]
fn power_is_accounted_for() {
    let report = filled(&room(mirror(), 0.5), settings(Indirect::Seen)).report;
    for pass in [report.main, report.caustic] {
        let (ends, ledger) = (pass.ends, pass.ledger);
        assert_eq!(ends.absorbed + ends.escaped + ends.truncated, pass.emitted);
        let ended = ledger.absorbed + ledger.escaped + ledger.truncated;
        // Sums of 20,000 equal numbers.
        assert!((ended / ledger.emitted - 1.0).abs() < 1e-10, "{ledger:?}");
        assert_eq!(ends.escaped, 0);
    }
    assert!(report.caustic.ends.truncated > 0 && report.main.ends.truncated == 0);
    assert!(report.bytes > 40 * 20_000);
}

/// The pilot's rate has a relative error of 1/sqrt(10,000 q) with q the photons a history stores, about; twice that at
/// most for clusters of some photons a history, and five standard errors.
#[test]
fn a_pilot_sets_what_is_emitted() {
    let scene = room(mirror(), 0.5);
    let asked = MapSettings {
        global: Amount::Stored(30_000),
        caustic: Amount::Stored(3_000),
        volume: Amount::Stored(10_000),
        ..settings(Indirect::Seen)
    };
    let number = counts(&scene, &asked).unwrap();
    let maps = filled(&scene, asked);
    for (map, emitted, wanted) in [
        (&maps.global, number.global, 30_000.0),
        (&maps.caustic, number.caustic, 3_000.0),
        (&maps.volume, number.volume, 10_000.0),
    ] {
        let map = map.as_ref().unwrap();
        assert_eq!(map.emitted(), emitted);
        let (stored, a_history) = (map.stored() as f64, wanted / emitted as f64);
        let error = 2.0 * (1.0 / (PILOT as f64 * a_history) + 1.0 / stored).sqrt();
        assert!((stored / wanted - 1.0).abs() < 5.0 * error, "{stored} of {wanted}, error {error}");
    }
    assert_eq!(maps.report.main.emitted, number.global.max(number.volume));
    assert_eq!(number.histories(), maps.report.main.emitted + number.caustic);
}

/// A ball in empty space that a lamp seldom meets: photons are aimed at it, and no hundred are sent out for each that is
/// stored. Fog that hardly ever scatters twice: what is sent out is bounded.
#[test]
fn emission_is_bounded() {
    let lamp = crate::support::scenes::point_light(DVec3::new(3.0, -3.0, 6.0), Spectrum::ONE);
    let ball = (crate::support::scenes::sphere(DVec3::ZERO, 0.3), lambertian(Spectrum::grey(0.7)));
    let stored = Amount::Stored(20_000);
    let asked = MapSettings { global: stored, volume: stored, ..settings(Indirect::Gathered) };
    let vase = bounded(Vec::new(), vec![ball], vec![lamp.clone()]);
    // A light at random would send out 4 x 10^7.
    let number = counts(&vase, &asked).unwrap().global;
    assert!(number < 60_000, "{number}");
    let map = filled(&vase, asked).global.unwrap();
    assert!((map.stored() as f64 / 20_000.0 - 1.0).abs() < 0.1, "{}", map.stored());
    let thin = region(crate::support::scenes::sphere(DVec3::new(3.0, -3.0, 6.0), 1.0), 0.001, 1.0, 0.0);
    let number = counts(&bounded(vec![thin], Vec::new(), vec![lamp]), &asked).unwrap().volume;
    assert_eq!(number, 20_000 * MOST_A_STORED);
}

/// A forecast says what is then stored, where numbers to emit are asked for too.
#[test]
fn forecasts_come_true() {
    let scene = room(mirror(), 0.5);
    let asked = MapSettings {
        global: Amount::Emitted(100_000),
        caustic: Amount::Stored(10_000),
        volume: Amount::Emitted(60_000),
        ..settings(Indirect::Gathered)
    };
    let ahead = forecast(&scene, &asked, None).unwrap();
    let maps = filled(&scene, asked);
    assert_eq!(ahead.emitted, counts(&scene, &asked).unwrap());
    for (map, expected) in [&maps.global, &maps.volume, &maps.caustic].into_iter().zip(ahead.stored) {
        let map = map.as_ref().unwrap();
        let (stored, a_history) = (map.stored() as f64, expected / map.emitted() as f64);
        // As above, of the shortest pilot: a sixteenth of 60,000.
        let error = 2.0 * (1.0 / (3750.0 * a_history) + 1.0 / stored).sqrt();
        assert!((stored / expected - 1.0).abs() < 5.0 * error, "{stored} of {expected}, error {error}");
    }
    let each = [1, 2].map(|runs| ahead.bytes(runs) / ahead.stored.iter().sum::<f64>());
    assert!(ahead.seconds > 0.0 && (66.0..133.0).contains(&each[0]) && (133.0..135.0).contains(&each[1]));
}

#[test]
fn maps_may_stay_empty_and_say_so() {
    // Fog that nothing scatters: all collisions are direct.
    let black = bounded(
        vec![region(cuboid(DVec3::ZERO, DVec3::ONE), 1.0, 0.0, 0.0)],
        Vec::new(),
        vec![crate::support::scenes::point_light(DVec3::splat(0.5), Spectrum::ONE)],
    );
    let asked = MapSettings { volume: Amount::Stored(1000), ..settings(Indirect::Seen) };
    let maps = fill(&black, &asked, &NoProgress).unwrap();
    let volume = maps.volume.unwrap();
    assert_eq!((volume.stored(), volume.emitted()), (0, 1000));
    let none = MapSettings { volume: Amount::Emitted(0), ..asked };
    let error = fill(&black, &none, &NoProgress).unwrap_err().to_string();
    assert!(error.contains("the number of photons of the volume map is 0"), "{error}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let scene = room(mirror(), 0.5);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| filled(&scene, settings(Indirect::Gathered)))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(photons(&one.global), photons(&three.global));
    assert_eq!(photons(&one.caustic), photons(&three.caustic));
    assert_eq!(photons(&one.volume), photons(&three.volume));
}
