//! One pass answers any number of estimators: each as if it were the only one.

use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::scene::{Orders, SceneSource};
use turbid::sensor::{MapSettings, PhotonSettings, RadianceMaps, SensorMaps, by_photons};
use turbid::transport::NoProgress;

fn estimators() -> Vec<Estimator> {
    let plain = |gather| Estimator::new(Kernel::Epanechnikov, gather);
    vec![
        plain(Gather::radius(0.3).unwrap()),
        plain(Gather::radius(0.5).unwrap()).treated(Treatment::Clipped),
        plain(Gather::nearest(20, 0.4).unwrap()).treated(Treatment::Reflection),
    ]
}

#[test]
fn every_estimator_reads_as_if_alone() {
    // Without the sensors that tallies answer.
    let mut file = SceneSource::new("slab").resolve().unwrap();
    file.sensors.retain(|sensor| matches!(sensor.measure, turbid::scene::QuantityFile::Fluence { .. }));
    assert!(file.sensors.len() > 2);
    let scene = file.scene(std::path::Path::new("")).unwrap();
    let settings = MapSettings {
        photons: 5000,
        seed: 3,
        replicate: 0,
        reach: 0.5,
        readings: 4,
        radiance: RadianceMaps { points: true, ..RadianceMaps::default() },
    };
    let maps = SensorMaps::fill(&scene, settings, &NoProgress).unwrap();
    for estimator in estimators() {
        let one = PhotonSettings { photons: 5000, maps: 1, seed: 3, orders: Orders::ALL, estimator };
        let alone = by_photons(&scene, &one, &NoProgress).unwrap();
        let read = maps.read(&estimator).unwrap();
        let values: Vec<f64> = read.values.iter().flatten().map(|value| value[0]).collect();
        let means: Vec<f64> = alone.measurements.iter().map(|m| m.mean).collect();
        assert_eq!(values, means, "{}", estimator.name());
        assert_eq!((read.underfull, read.gathers), (alone.underfull, alone.gathers));
    }
    let far = Estimator::new(Kernel::Uniform, Gather::radius(0.6).unwrap());
    let refused = maps.read(&far).unwrap_err().to_string();
    assert!(refused.contains("the reach of an estimator is 0.6"), "{refused}");
}

/// Readings of a ray are independent marches: their mean has the mean of one, and less noise.
#[test]
fn readings_of_a_ray_are_averaged() {
    let text = "\
[[regions]]
shape = { sphere = { center = [0, 0, 0], radius = 1.0 } }
sigma_t = 3.0
albedo = 0.9
g = 0.0
density = { cloud = { center = [0, 0, 0], radii = [0.6, 0.6, 0.6], seed = 2 } }
[[lights]]
point = { position = [0, 0, 2], power = 1.0 }
[[sensors]]
name = 'ray'
measure = { radiance = { origin = [-2, 0, 0], dir = [1, 0, 0] } }
";
    let file = turbid::scene::SceneFile::from_toml(text).unwrap();
    let scene = file.scene(std::path::Path::new("")).unwrap();
    let estimator = Estimator::new(Kernel::Uniform, Gather::radius(0.3).unwrap());
    let moments = |readings: usize| -> turbid::stats::Moments {
        let one = |replicate: u64| {
            // The same photons each time: what differs between maps is the same for both.
            let settings = MapSettings {
                photons: 2000,
                seed: 5,
                replicate,
                reach: 0.3,
                readings,
                radiance: RadianceMaps { points: true, ..RadianceMaps::default() },
            };
            let maps = SensorMaps::fill(&scene, settings, &NoProgress).unwrap();
            maps.read(&estimator).unwrap().values[0][0][0]
        };
        (0..128).map(one).collect::<Vec<f64>>().iter().collect()
    };
    let (one, many) = (moments(1), moments(16));
    let error = (one.std_error().powi(2) + many.std_error().powi(2)).sqrt();
    let limit = turbid::stats::student_critical(turbid::stats::ALPHA, 127);
    assert!((one.mean() - many.mean()).abs() < limit * error, "{} and {}", one.mean(), many.mean());
    assert!(many.variance() < 0.6 * one.variance(), "{} and {}", one.variance(), many.variance());
}
