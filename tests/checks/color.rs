//! Channels: each has the light that it would have alone, whatever the others have.

use crate::support::run::{histories, paths, sensor, tallies};
use crate::support::scenes::{
    CELL, Incidence, around, bounded, cuboid, dielectric, filled, homogeneous, incidence, lambertian, layer,
    outflow, point_light, rectangle, sphere, volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Face, Shape};
use turbid::light::{Area, Light};
use turbid::math::{FOUR_PI, Interval, Ray, exp, exp_m1};
use turbid::medium::{Density, Grid, Heterogeneous, Homogeneous, Medium};
use turbid::phase::{Isotropic, Phase};
use turbid::photons::Emitter;
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Orders, Quantity, Region, SURROUNDINGS, Scene, SceneParts};
use turbid::sensor::{Measurement, PathSettings, PhotonSettings, by_paths, by_photons};
use turbid::stats::Moments;
use turbid::transport::{Flight, NoProgress, free_flight};

const MAPS: u64 = 64;

/// Two point lights of different colours, whose largest channels are not in the ratio of their powers, and where they are.
const LIGHTS: [(DVec3, Spectrum); 2] = [
    (DVec3::new(-1.6, 0.1, 0.0), Spectrum::rgb(8.0, 0.4, 1.0)),
    (DVec3::new(0.3, 1.7, 0.2), Spectrum::rgb(1.8, 2.2, 2.0)),
];

/// A grey ball of fog beside lights, with a fluence, and powers that leave and end.
fn lit(lights: Vec<Light>) -> Scene {
    let ball = sphere(DVec3::ZERO, 1.0);
    let sensors =
        [Quantity::Fluence(DVec3::new(0.2, 0.3, 0.0)), outflow(ball.clone()), Quantity::Absorbed(0)];
    Scene::new(SceneParts {
        regions: vec![Region { shape: ball, medium: homogeneous(Spectrum::ONE, Spectrum::grey(0.8), 0.3) }],
        lights,
        sensors: sensors.map(|quantity| sensor(quantity, Orders::ALL)).to_vec(),
        ..SceneParts::default()
    })
    .unwrap()
}

/// What one map, or 2,048 paths, read of each sensor and channel.
fn read(scene: &Scene, by: &str, replicate: u64) -> Vec<Measurement> {
    if by == "paths" {
        let settings = PathSettings { samples: 1 << 10, seed: 61, replicate, orders: Orders::ALL };
        return by_paths(scene, &settings, &NoProgress).unwrap();
    }
    let settings = PhotonSettings {
        photons: 1 << 12,
        maps: 1,
        seed: 1000 + replicate,
        orders: Orders::ALL,
        estimator: Estimator::new(Kernel::Uniform, Gather::radius(0.6).unwrap()),
    };
    by_photons(scene, &settings, &NoProgress).unwrap().measurements
}

/// Light is linear: in grey fog two coloured lights give each channel what the lights alone, of power 1, give times their
/// powers in it. By the measurements that a user is shown, all three channels of each sensor.
pub fn two_lights_keep_their_colors() {
    let all = lit(LIGHTS.map(|(at, power)| point_light(at, power)).to_vec());
    let alone = LIGHTS.map(|(at, _)| lit(vec![point_light(at, Spectrum::ONE)]));
    let powers = all.power();
    for by in ["photons", "paths"] {
        let (mut both, mut summed) = (vec![Moments::new(); 9], vec![Moments::new(); 9]);
        for replicate in 0..MAPS {
            let together = read(&all, by, replicate);
            assert_eq!(together.len(), 9, "a coloured scene is reported by channel, {by}");
            both.iter_mut().zip(&together).for_each(|(m, measurement)| m.push(measurement.mean));
            // Random numbers of their own.
            let parts = [0, 1].map(|i: usize| read(&alone[i], by, (i as u64 + 1) * MAPS + replicate));
            assert_eq!(parts[0].len(), 3, "a grey scene is reported in one channel");
            for (i, m) in summed.iter_mut().enumerate() {
                let (sensor, c) = (i / 3, i % 3);
                let sum: f64 = (0..2).map(|light| LIGHTS[light].1[c] * parts[light][sensor].mean).sum();
                // Tallies are told over the power of all lights.
                m.push(if sensor == 0 { sum } else { sum / powers[c] });
            }
        }
        for (i, (both, summed)) in both.iter().zip(&summed).enumerate() {
            let what = format!("sensor {}, channel {}, by {by}", i / 3, i % 3);
            verdict::agree(&what, both, summed, 0.2 * summed.mean(), 61);
        }
    }
}

/// What photons carry away from each of two lights is its power, channel by channel.
pub fn photons_carry_each_lights_power() {
    let scene = bounded(Vec::new(), Vec::new(), LIGHTS.map(|(at, power)| point_light(at, power)).to_vec());
    let emitter = Emitter::by_power(&scene);
    for (at, power) in LIGHTS {
        let sent = histories(1 << 16, 62, |stream| {
            let walker = emitter.emit(&scene, stream).unwrap();
            if walker.ray.origin == at { walker.weight } else { Spectrum::ZERO }
        });
        for c in 0..3 {
            let what = format!("power of the light at {at}, channel {c}");
            verdict::agrees(&what, &sent[c], (power[c], 0.0), 0.06 * power[c], 62);
        }
    }
}

/// Every photon carries the power of all lights together, summed over channels, in the colour of its own.
pub fn photons_carry_the_power_of_all_lights() {
    for count in [1, 2] {
        let lights = LIGHTS[..count].iter().map(|(at, power)| point_light(*at, *power)).collect();
        let scene = bounded(Vec::new(), Vec::new(), lights);
        let (emitter, all) = (Emitter::by_power(&scene), scene.power().sum());
        for history in 0..256 {
            let walker = emitter.emit(&scene, &mut Stream::new(69, Purpose::Photons, 0, history)).unwrap();
            let own = LIGHTS.iter().find(|(at, _)| *at == walker.ray.origin).unwrap().1;
            for c in 0..3 {
                let expected = all * own[c] / own.sum();
                assert!(
                    (walker.weight[c] / expected - 1.0).abs() < 1e-14,
                    "{:?} of {count} lights",
                    walker.weight
                );
            }
        }
    }
}

/// Light through a glass plate filled with an absorber of three colours, at normal incidence: with R of Fresnel and
/// t = e^-tau of each channel, T = (1-R)^2 t/(1 - R^2 t^2) passes, and R (1 + t T) comes back.
pub fn a_colored_filling_passes_each_channel() {
    let (index, tau) = (1.5, Spectrum::rgb(0.2, 1.0, 2.5));
    let scene = |how| {
        let medium = homogeneous(tau, Spectrum::ZERO, 0.0);
        Scene::new(SceneParts {
            interiors: vec![Interior::surroundings(), filled("plate", index, medium)],
            objects: vec![Object { shape: layer(1.0), surface: dielectric(1, 0) }],
            lights: vec![incidence(around(1.0), how)],
            cell: Some(glam::DVec2::splat(CELL)),
            ..SceneParts::default()
        })
        .unwrap()
    };
    let passes = |c: usize| {
        let r = ((index - 1.0) / (index + 1.0)) * ((index - 1.0) / (index + 1.0));
        let t = exp(-tau[c]);
        let through = (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t);
        (r + r * t * through, through)
    };
    let beam = scene(Incidence::Beam(1.0));
    let faces = [Face::Top, Face::Bottom].map(|face| Quantity::Outflow { shape: around(1.0), face });
    let by_photons = tallies(&beam, &faces.map(|face| (face, Orders::ALL)), 1 << 16, 63);
    // Radiance 1/pi from both sides: what is seen is what passes and what comes back.
    let through = Ray::new(DVec3::new(1.0, 1.0, -0.2), DVec3::Z);
    let by_paths = paths(&scene(Incidence::Both), Quantity::Radiance(through), Orders::ALL, 1 << 16, 63);
    for c in 0..3 {
        let (back, transmitted) = passes(c);
        for (name, tally, expected) in [("back", 0, back), ("transmitted", 1, transmitted)] {
            let what = format!("{name} by photons, channel {c}");
            verdict::agrees(&what, &by_photons[tally][c], (expected, 1e-12), 0.03, 63);
        }
        let seen = (back + transmitted) / PI;
        verdict::agrees(&format!("seen by paths, channel {c}"), &by_paths[c], (seen, 1e-12), 0.05 * seen, 63);
    }
}

/// A density of layers along z in the cuboid of unit ground between two heights.
fn layers((low, high): (f64, f64), count: usize, f: impl Fn(f64) -> f64) -> Density {
    let corners = (DVec3::new(0.0, 0.0, low), DVec3::new(1.0, 1.0, high));
    Density::grid(Grid::sampled(corners, [1, 1, count], |p| f(p.z)).unwrap()).unwrap()
}

fn box_between(low: f64, high: f64) -> Shape {
    cuboid(DVec3::new(0.0, 0.0, low), DVec3::new(1.0, 1.0, high))
}

/// A homogeneous medium of three colours, a grey one that varies, and another of three colours, one behind the other:
/// flights collide in each, and pass all, as the channels' own depths have it.
pub fn colored_media_beside_a_varying_one() {
    let grey = super::media::varying(Spectrum::ONE, 0.0, layers((1.0, 2.0), 8, |z| 2.0 * (z - 1.0)));
    let media = [
        homogeneous(Spectrum::rgb(0.3, 1.0, 2.5), Spectrum::ZERO, 0.0),
        grey,
        homogeneous(Spectrum::rgb(2.0, 0.5, 0.1), Spectrum::ZERO, 0.0),
    ];
    let regions: Vec<Region> = (0..3)
        .map(|i| Region { shape: box_between(i as f64, i as f64 + 1.0), medium: media[i].clone() })
        .collect();
    let scene = bounded(regions, Vec::new(), vec![volume_source(box_between(0.0, 3.0))]);
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z);
    let weight = Spectrum::rgb(1.0, 0.5, 2.0);
    for end in 0..4 {
        let found = histories(1 << 16, 64, |stream| {
            match free_flight(&scene, &ray, f64::INFINITY, SURROUNDINGS, weight, false, stream) {
                Flight::Collision { medium, weight, .. } if medium == end => weight,
                Flight::Uncollided(weight) if end == 3 => weight,
                _ => Spectrum::ZERO,
            }
        });
        for c in 0..3 {
            let depth = |z: f64| scene.optical_depth(&ray, 1.0 + z, SURROUNDINGS)[c];
            let left = |z: f64| weight[c] * exp(-depth(z));
            let expected = if end == 3 { left(3.0) } else { left(end as f64) - left(end as f64 + 1.0) };
            verdict::agrees(&format!("end {end}, channel {c}"), &found[c], (expected, 1e-12), 0.1, 64);
        }
    }
}

fn emitter(sigma_t: f64, emission: Spectrum) -> Homogeneous {
    let plain =
        Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::ZERO, Phase::Isotropic(Isotropic)).unwrap();
    plain.with_emission(emission).unwrap()
}

/// A grey absorber that emits in three colours is reported in three: e (1 - e^-s)/s along a ray of depth s, exactly, and
/// photons that end in it in the ratio of its colours, exactly.
pub fn emission_is_reported_by_channel() {
    let (sigma_t, emission) = (0.8, Spectrum::rgb(1.0, 0.25, 3.0));
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z);
    let scene = Scene::new(SceneParts {
        regions: vec![Region { shape: box_between(0.0, 2.0), medium: emitter(sigma_t, emission).into() }],
        sensors: [Quantity::Radiance(ray), Quantity::Absorbed(0)]
            .map(|quantity| sensor(quantity, Orders::ALL))
            .to_vec(),
        ..SceneParts::default()
    })
    .unwrap();
    let (seen, ended) = (read(&scene, "paths", 0), read(&scene, "photons", 0));
    assert_eq!((seen.len(), ended.len()), (6, 6), "a coloured scene is reported by channel");
    for c in 0..3 {
        let expected = emission[c] * -exp_m1(-2.0 * sigma_t) / sigma_t;
        assert!((seen[c].mean / expected - 1.0).abs() < 1e-12, "{} for {expected}", seen[c].mean);
        // Told over the power of each channel: the same share of all.
        assert!((ended[3 + c].mean / ended[3].mean - 1.0).abs() < 1e-9, "{}", ended[3 + c].mean);
    }
}

/// Photons of a medium that emits one colour everywhere and another where it is dense leave each part of it with the
/// colour that this part sends: 4 pi (e + e' density), integrated.
pub fn medium_emission_has_the_color_of_its_place() {
    let (even, dense) = (Spectrum::rgb(0.5, 0.1, 0.0), Spectrum::rgb(0.0, 0.3, 2.0));
    let density = layers((0.0, 2.0), 8, |z| 0.5 * z);
    let medium: Medium = Heterogeneous::new(emitter(0.4, even), density.clone())
        .with_emission_by_density(dense)
        .unwrap()
        .into();
    let scene = bounded(vec![Region { shape: box_between(0.0, 2.0), medium }], Vec::new(), Vec::new());
    let from = Emitter::by_power(&scene);
    let up = Ray::new(DVec3::ZERO, DVec3::Z);
    for (low, high) in [(0.0, 0.5), (0.5, 1.25), (1.25, 2.0)] {
        let sent = histories(1 << 16, 65, |stream| match from.emit(&scene, stream) {
            Some(walker) if (low..high).contains(&walker.ray.origin.z) => walker.weight,
            _ => Spectrum::ZERO,
        });
        let mass = density.integral(&up, Interval { start: low, end: high });
        for c in 0..3 {
            let expected = FOUR_PI * (even[c] * (high - low) + dense[c] * mass);
            let whole = FOUR_PI * (2.0 * even[c] + dense[c]);
            let what = format!("sent between {low} and {high}, channel {c}");
            verdict::agrees(&what, &sent[c], (expected, 1e-9), 0.05 * whole, 65);
        }
    }
}

/// A room with everything that has a colour, its channels in this order: two lights, a homogeneous medium beside one that
/// varies and emits, glass with a filling, and a floor.
fn colorful(order: [usize; 3]) -> Scene {
    let rgb = |rgb: [f64; 3]| Spectrum::rgb(rgb[order[0]], rgb[order[1]], rgb[order[2]]);
    let up = |half: f64, z: f64| {
        rectangle(DVec3::new(-half, -half, z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half)
    };
    let lamp = |x: f64, radiance| {
        Light::Area(Area::new(sphere(DVec3::new(x, 0.4, 1.6), 0.2), rgb(radiance)).unwrap())
    };
    let corners = (DVec3::new(0.1, -0.8, 0.1), DVec3::new(0.9, -0.1, 0.9));
    let grid = Grid::sampled(corners, [3, 2, 4], |p| p.x + p.z).unwrap();
    let matter = Homogeneous::new(rgb([1.0, 2.0, 0.5]), rgb([0.9, 0.5, 0.7]), Phase::Isotropic(Isotropic));
    let matter = matter.unwrap().with_emission(rgb([0.05, 0.2, 0.0])).unwrap();
    let varying = Heterogeneous::new(matter, Density::grid(grid).unwrap());
    let varying = varying.with_emission_by_density(rgb([0.4, 0.0, 0.1])).unwrap();
    let even = homogeneous(rgb([0.5, 1.5, 3.0]), rgb([0.8, 0.9, 0.3]), 0.4);
    let filling = homogeneous(rgb([3.0, 0.4, 1.0]), rgb([0.5, 0.9, 0.2]), 0.0);
    let objects = vec![
        (Shape::Rectangle(up(2.0, -0.2)), lambertian(rgb([0.8, 0.3, 0.5]))),
        (sphere(DVec3::new(0.0, 0.7, 0.4), 0.4), dielectric(1, 0)),
    ];
    Scene::new(SceneParts {
        regions: vec![
            Region { shape: cuboid(DVec3::new(-0.9, -0.8, 0.1), DVec3::new(0.1, -0.1, 0.9)), medium: even },
            Region { shape: cuboid(corners.0, corners.1), medium: varying.into() },
        ],
        interiors: vec![Interior::surroundings(), filled("glass", 1.4, filling)],
        objects: objects.into_iter().map(|(shape, surface)| Object { shape, surface }).collect(),
        lights: vec![lamp(-1.0, [9.0, 1.0, 2.0]), lamp(1.0, [1.0, 3.0, 2.5])],
        ..SceneParts::default()
    })
    .unwrap()
}

/// The names of the channels mean nothing: with all colours of a scene in another order, so are its lights.
pub fn channels_in_another_order_change_nothing_else() {
    let rays =
        [(DVec3::new(-2.0, -0.5, 0.5), DVec3::X), (DVec3::new(0.0, -2.0, 0.6), DVec3::new(0.1, 1.0, -0.05))];
    let asked: Vec<Quantity> =
        rays.iter().map(|(from, dir)| Quantity::Radiance(Ray::new(*from, dir.normalize()))).collect();
    let tallied = [Quantity::Absorbed(0), Quantity::Absorbed(1)];
    let measured = |order: [usize; 3], seed: u64| {
        let scene = colorful(order);
        let mut found: Vec<[Moments; 3]> = asked
            .iter()
            .map(|quantity| paths(&scene, quantity.clone(), Orders::ALL, 1 << 16, seed))
            .collect();
        found.extend(tallies(&scene, &tallied.clone().map(|q| (q, Orders::ALL)), 1 << 16, seed));
        found
    };
    let plain = measured([0, 1, 2], 66);
    for (seed, order) in [(67, [1, 2, 0]), (68, [2, 1, 0])] {
        let turned = measured(order, seed);
        for (which, (a, b)) in plain.iter().zip(&turned).enumerate() {
            for c in 0..3 {
                let (a, b) = (&a[order[c]], &b[c]);
                let what = format!("quantity {which}, order {order:?}, channel {c}");
                // Radiances relative to themselves, what is absorbed relative to the power.
                let promise = if which < rays.len() { 0.3 * a.mean() } else { 0.02 };
                verdict::agree(&what, a, b, promise, seed);
            }
        }
    }
}
