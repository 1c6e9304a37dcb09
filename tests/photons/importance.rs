//! Importance: photons go where the picture needs them, and every estimate keeps its expectation.

use crate::checks::weights;
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::path::Path;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{
    Amount, Emitted, Indirect, MapSettings, Maps, MediumSamples, fill_counted, fill_counted_by_importance,
};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Scene, SceneFile};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

fn hall() -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/scenes");
    let text = std::fs::read_to_string(folder.join("importance.toml")).unwrap();
    SceneFile::from_toml(&text).unwrap().scene(&folder).unwrap()
}

fn maps(
    scene: &Scene,
    indirect: Indirect,
    importance: Option<&Importance>,
    emitted: u64,
    replicate: u64,
) -> Maps {
    let amount = Amount::Emitted(emitted);
    let settings = MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect,
        seed: 5,
        replicate,
    };
    let emitted = Emitted { global: emitted, volume: emitted, caustic: 0 };
    match importance {
        None => fill_counted(scene, &settings, emitted, &NoProgress).unwrap(),
        some => fill_counted_by_importance(scene, &settings, emitted, some, &NoProgress).unwrap(),
    }
}

/// Where powers are compared: the corner that the camera sees, the middle of the hall, and its far end.
const PLACES: [(&str, [f64; 3], [f64; 3]); 3] = [
    ("corner", [-0.1, -0.1, -0.1], [3.0, 3.0, 3.0]),
    ("middle", [7.0, 3.0, -0.1], [13.0, 9.0, 3.0]),
    ("far end", [14.0, -0.1, -0.1], [20.1, 12.1, 6.1]),
];

/// Power stored in a place per photon sent out \[W\], on surfaces and in the medium, and how many photons.
fn stored(maps: &Maps, (low, high): ([f64; 3], [f64; 3])) -> [(f64, usize); 2] {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    [&maps.global, &maps.volume].map(|map| {
        let map = map.as_ref().unwrap();
        let mut sum = (0.0, 0);
        for photon in map.tree().photons() {
            if photon.position.cmpge(low).all() && photon.position.cmplt(high).all() {
                sum = (sum.0 + f64::from(photon.power.element_sum()), sum.1 + 1);
            }
        }
        (sum.0 / map.emitted() as f64, sum.1)
    })
}

/// Stored powers in three places, and the ledger, with and without; and what it is for: more photons where they are
/// read, of less variance, for the same number of events.
#[test]
fn importance_moves_photons_and_changes_no_mean() {
    const MAPS: u64 = 64;
    let scene = hall();
    for indirect in [Indirect::Seen, Indirect::Gathered] {
        let settings = ImportanceSettings { pilot: 1 << 13, ..Default::default() };
        let importance =
            Importance::of(&scene, scene.camera().unwrap(), indirect, &settings, &NoProgress).unwrap();
        let mut powers = [[[Moments::new(); 2]; 3]; 2];
        let mut counts = [[[0usize; 2]; 3]; 2];
        let mut ledgers = [[Moments::new(); 2]; 2];
        let mut events = [0u64; 2];
        for (way, by_importance) in [None, Some(&importance)].into_iter().enumerate() {
            for replicate in 0..MAPS {
                let maps = maps(&scene, indirect, by_importance, 800, replicate + 1000 * way as u64);
                for (place, (_, low, high)) in PLACES.iter().enumerate() {
                    for (kind, (power, count)) in stored(&maps, (*low, *high)).into_iter().enumerate() {
                        powers[way][place][kind].push(power);
                        counts[way][place][kind] += count;
                    }
                }
                let main = maps.report.main;
                let emitted = main.emitted as f64;
                ledgers[way][0].push(main.ledger.emitted / emitted);
                ledgers[way][1].push((main.ledger.absorbed + main.ledger.escaped) / emitted);
                events[way] += main.collisions + main.hits;
            }
        }
        let power = scene.power().sum();
        for [emitted, ended] in &ledgers {
            verdict::agrees("ledger, emitted", emitted, (power, 1e-9 * power), 0.1 * power, 5);
            verdict::agrees("ledger, ended", ended, (power, 1e-9 * power), 0.2 * power, 5);
        }
        verdict::println_line(&format!("{indirect:?}: events {events:?}"));
        for (place, (name, ..)) in PLACES.iter().enumerate() {
            for (kind, what) in ["surfaces", "medium"].into_iter().enumerate() {
                let [a, b] = [0, 1].map(|way: usize| powers[way][place][kind]);
                verdict::agree(&format!("{name}, {what}"), &a, &b, 1.0 * a.mean(), 5);
                let relative = |m: &Moments| m.variance() / (m.mean() * m.mean());
                verdict::println_line(&format!(
                    "{name}, {what}: photons {} and {}; variance at equal events {:.2} times smaller",
                    counts[0][place][kind],
                    counts[1][place][kind],
                    relative(&a) * events[0] as f64 / (relative(&b) * events[1] as f64),
                ));
            }
        }
        // At an equal number of events too the corner gets more than twice the photons.
        for (by_importance, plain) in counts[1][0].iter().zip(&counts[0][0]) {
            let gain = *by_importance as f64 / *plain as f64;
            assert!(
                gain > 2.0 * events[1] as f64 / events[0] as f64,
                "{indirect:?}: {gain} times the photons"
            );
        }
    }
}

/// The picture: relative error of its pixels from map to map, at about the same number of events.
#[test]
fn importance_makes_the_picture_better() {
    let scene = hall();
    let indirect = Indirect::Seen;
    let settings = ImportanceSettings { pilot: 1 << 13, ..Default::default() };
    let importance =
        Importance::of(&scene, scene.camera().unwrap(), indirect, &settings, &NoProgress).unwrap();
    let readout = Settings {
        global: (Kernel::Uniform, Gather::radius(0.5).unwrap()),
        volume: Estimator::new(Kernel::Uniform, Gather::radius(0.5).unwrap()).treated(Treatment::Clipped),
        ..Settings::for_size(10.0, 50).unwrap()
    };
    let camera = scene.camera().unwrap();
    let mut errors = [0.0; 2];
    let mut cost = [0.0; 2];
    let mut means = [0.0; 2];
    for (way, by_importance) in [None, Some(&importance)].into_iter().enumerate() {
        const MAPS: u64 = 12;
        let (mut pixels, mut events) = (vec![Moments::new(); 48], 0);
        for replicate in 0..MAPS {
            // Histories by importance have more events.
            let emitted = if way == 0 { 40_000 } else { 16_000 };
            let maps = maps(&scene, indirect, by_importance, emitted, replicate + 500);
            events += maps.report.main.collisions + maps.report.main.hits;
            let mapper = Mapper::new(&scene, &maps, &readout);
            for (i, pixel) in pixels.iter_mut().enumerate() {
                // The same rays for every map: what differs is the maps.
                let mut stream = Stream::new(1, Purpose::Paths, 0, i as u64);
                let at = DVec2::new((i % 8) as f64 * 20.0 + 10.0, (i / 8) as f64 * 20.0 + 10.0);
                let layers = mapper.radiance(camera.ray(at), None, 0, &mut stream).0;
                pixel.push((layers.indirect + layers.multiple).sum());
            }
        }
        let relative = |m: &Moments| m.variance() / (m.mean() * m.mean());
        errors[way] = (pixels.iter().map(relative).sum::<f64>() / pixels.len() as f64).sqrt();
        cost[way] = errors[way] * errors[way] * events as f64;
        means[way] = pixels.iter().map(Moments::mean).sum::<f64>() / pixels.len() as f64;
        verdict::println_line(&format!(
            "{}: relative error of a pixel {:.3}, mean {:.5}, events a map {}",
            if way == 0 { "by power" } else { "by importance" },
            errors[way],
            means[way],
            events / MAPS
        ));
    }
    assert!(cost[1] < cost[0], "variance times events: {cost:?}");
}

#[test]
fn a_window_keeps_the_weight() {
    weights::a_window_keeps_the_weight();
}
