//! Steps of a march that share gathers of the volume map.

use super::media::{layered, varying};
use crate::support::scenes::{bounded, cuboid, emitting_sphere, homogeneous};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::estimators::Gather;
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::integrators::{Adaptive, March};
use turbid::math::{Positive, Ray};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Region;
use turbid::stats::Moments;
use turbid::transport::NoProgress;

/// One map, read by many marches of one ray: with shared gathers the mean is that of a gather a step, in each channel, in media that are
/// coloured, that vary, and that hardly scatter behind others; with balls of fixed radius and of the k nearest, equal steps and adaptive
/// ones, few that share and many.
pub fn steps_that_share_a_gather_have_their_sum() {
    let (low, middle, high) = (DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0), DVec3::new(3.0, 1.0, 1.0));
    let colored = homogeneous(Spectrum::rgb(0.5, 2.0, 6.0), Spectrum::rgb(0.9, 0.7, 0.99), 0.3);
    let faint = homogeneous(Spectrum::grey(0.05), Spectrum::grey(0.9), 0.0);
    let wavy = layered((low, high), 12, |z| 0.3 + 4.0 * (z - 0.4) * (z - 0.4));
    let [two, varied] = [
        vec![(middle, low, colored), (high, DVec3::new(2.0, 0.0, 0.0), faint)],
        vec![(high, low, varying(Spectrum::rgb(1.0, 2.0, 4.0), 0.9, wavy))],
    ];
    let mut seed = 0;
    for (name, media) in [("coloured", two), ("varying", varied)] {
        let regions = media.into_iter().map(|(to, from, medium)| Region { shape: cuboid(from, to), medium });
        let lamp = emitting_sphere(DVec3::new(1.0, 0.5, 1.5), 0.3);
        let scene = bounded(regions.collect(), Vec::new(), vec![lamp]);
        let filling = MapSettings {
            global: Amount::Emitted(1),
            caustic: Amount::Emitted(1),
            volume: Amount::Stored(3000),
            media: MediumSamples::Points,
            indirect: Indirect::Seen,
            seed: 3,
            replicate: 0,
        };
        let maps = fill(&scene, &filling, &NoProgress).unwrap();
        let ray = Ray::new(DVec3::new(-1.0, 0.2, 0.1), DVec3::new(1.0, 0.1, 0.2).normalize());
        for (gather, is_adaptive, spacing) in [
            (Gather::nearest(20, 0.3).unwrap(), false, 0.5),
            (Gather::nearest(20, 0.3).unwrap(), true, 2.0),
            (Gather::radius(0.15).unwrap(), false, 2.0),
            (Gather::radius(0.15).unwrap(), false, 100.0),
        ] {
            let mut settings = Settings::for_scene(&scene, 20).unwrap();
            settings.volume.gather = gather;
            let shortest = Positive::new("the shortest step", 0.02).unwrap();
            settings.march = March {
                step: Positive::new("the step", 0.08).unwrap(),
                adaptive: is_adaptive.then_some(Adaptive { tolerance: 0.3, shortest }),
                ..settings.march
            };
            seed += 1;
            let read = |spacing: f64, replicate: u64| {
                let settings = Settings { spacing, ..settings };
                let mapper = Mapper::new(&scene, &maps, &settings);
                let (mut moments, mut gathers) = ([Moments::new(); 3], 0);
                for history in 0..4000 {
                    let mut stream = Stream::new(seed, Purpose::Paths, replicate, history);
                    let (layers, report) = mapper.radiance(ray, None, 0, &mut stream);
                    for (channel, moments) in moments.iter_mut().enumerate() {
                        moments.push(layers.multiple[channel]);
                    }
                    gathers += report.volume.count;
                }
                (moments, gathers)
            };
            let ((each, all), (shared, fewer)) = (read(0.0, 0), read(spacing, 1));
            assert!(fewer < all - all / 10, "{name}, {spacing}: {fewer} gathers of {all}");
            for channel in 0..3 {
                let what = format!(
                    "{name}, {gather:?}, adaptive {is_adaptive}, spacing {spacing}, channel {channel}"
                );
                verdict::agree(&what, &shared[channel], &each[channel], 0.1 * each[channel].mean(), seed);
            }
        }
    }
}
