//! Progressive maps: each map is read within the radius that is due there.

use crate::support::scenes::{bounded, homogeneous, point_light, sphere};
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{Positive, Ray};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts, Sensor};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::transport::NoProgress;

const PHOTONS: u64 = 4000;

/// A ball of fog about a lamp, with a sensor of fluence and one of radiance.
fn scene() -> Scene {
    let medium = homogeneous(Spectrum::grey(1.5), Spectrum::grey(0.8), 0.3);
    let region = Region { shape: sphere(DVec3::ZERO, 2.0), medium };
    let light = point_light(DVec3::new(0.3, 0.0, 0.1), Spectrum::ONE);
    let plain = bounded(vec![region], Vec::new(), vec![light]);
    let ray = Ray::new(DVec3::new(-3.0, 0.2, 0.1), DVec3::X);
    let quantities = [Quantity::Fluence(DVec3::new(-0.6, 0.2, 0.1)), Quantity::Radiance(ray)];
    let sensors = quantities.into_iter().enumerate().map(|(number, quantity)| {
        let (name, label) = (format!("sensor {number}"), format!("sensor {number}"));
        Sensor { name, label, quantity, orders: Orders::ALL }
    });
    Scene::new(SceneParts {
        regions: plain.regions().to_vec(),
        lights: plain.named_lights().to_vec(),
        sensors: sensors.collect(),
        ..SceneParts::default()
    })
    .unwrap()
}

/// The first channel of both sensors, summed over the first so many maps.
fn sums(scene: &Scene, estimator: Estimator, maps: u64) -> [f64; 2] {
    let settings = PhotonSettings { photons: PHOTONS, maps, seed: 5, orders: Orders::ALL, estimator };
    let read = by_photons(scene, &settings, &NoProgress).unwrap();
    let of = |sensor: &str| read.measurements.iter().find(|m| m.sensor == sensor).unwrap().mean * maps as f64;
    [of("sensor 0"), of("sensor 1")]
}

/// What the map of this number says, the first being 0.
fn map(scene: &Scene, estimator: Estimator, number: u64) -> [f64; 2] {
    let [after, before] = [number + 1, number].map(|maps| match maps {
        0 => [0.0; 2],
        _ => sums(scene, estimator, maps),
    });
    [after[0] - before[0], after[1] - before[1]]
}

/// The ratio of the last radius to the first by the recurrence, for c = 1, 2, 3.
fn ratio(c: f64, maps: u64) -> f64 {
    let a = 4.0 / (c + 4.0);
    let volume: f64 = (1..=maps).map(|i| (i as f64 + a) / (i as f64 + 1.0)).product();
    libm::pow(volume, 1.0 / c)
}

/// Balls of fluence shrink with c = 3, tubes of points with 2, strips of beams with 1: what the fourth map says is what a fixed radius
/// of that length says of it.
pub fn each_map_is_read_within_the_radius_that_is_due() {
    let scene = scene();
    let (first, last) = (0.5, 3);
    let ball = |radius: f64| {
        Estimator::new(Kernel::Epanechnikov, Gather::radius(radius).unwrap()).treated(Treatment::Clipped)
    };
    let length = |radius: f64| Positive::new("the radius", radius).unwrap();
    let balls = ball(first).progressive();
    let cases = [
        (balls, ball(first * ratio(3.0, last))),
        (
            balls.along_rays(length(first)),
            ball(first * ratio(3.0, last)).along_rays(length(first * ratio(2.0, last))),
        ),
        (
            balls.along_beams(length(first)),
            ball(first * ratio(3.0, last)).along_beams(length(first * ratio(1.0, last))),
        ),
    ];
    for (progressive, fixed) in cases {
        // Radii agree to 1e-15; a photon at the edge of a kernel that vanishes there weighs nothing.
        let (mine, expected) = (map(&scene, progressive, last), map(&scene, fixed, last));
        for (mine, expected) in mine.into_iter().zip(expected) {
            let name = progressive.name();
            assert!(expected > 0.0 && (mine / expected - 1.0).abs() < 1e-6, "{name}: {mine} {expected}");
        }
        // The first map is read as it is asked for.
        let plain = Estimator { is_progressive: false, ..progressive };
        let (mine, expected) = (map(&scene, progressive, 0), map(&scene, plain, 0));
        assert!(mine.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-6));
    }
}
