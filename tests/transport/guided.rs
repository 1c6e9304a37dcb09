//! Guided paths: against the exact slab, in a furnace, and what they are worth. Each class and order, by every light and through every
//! body, is beside bidirectional paths.

use crate::checks::guided::{
    below_a_pane, guided_paths_find_as_much, guided_paths_stay_light, learned, of_the_table,
};
use crate::checks::slab::{exact, referee};
use crate::support::run::numbers;
use crate::support::scenes::{
    Incidence, at_depth, bounded, cuboid, emitting_sphere, isotropic, lambertian, region, slab, sphere,
    volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;
use turbid::Spectrum;
use turbid::integrators::{Guides, radiance};
use turbid::light::Faces;
use turbid::math::Ray;
use turbid::medium::Homogeneous;
use turbid::phase::{Isotropic, Phase, Tabulated};
use turbid::photons::{Guide, GuideSettings, MOST_HISTORIES};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region};
use turbid::sensor::{Camera, Film, Filter, Method, Streams, View, sample_guided};
use turbid::stats::Moments;
use turbid::transport::NoProgress;

fn led(guide: &Guide) -> Guides<'_> {
    Guides { windows: None, learned: Some(guide) }
}

#[test]
fn they_find_as_much() {
    guided_paths_find_as_much();
}

#[test]
fn they_stay_light() {
    guided_paths_stay_light();
}

/// What they are worth behind glass: a twentieth of the variance.
#[test]
fn they_vary_less() {
    let scene = below_a_pane(0.0, 2.0);
    let guide = learned(&scene, 100_000, None);
    let variance = |guides, seed| of_the_table(&scene, guides, 1 << 17, seed).variance();
    let (alone, guided) = (variance(Guides::default(), 1), variance(led(&guide), 2));
    assert!(20.0 * guided < alone, "{alone} {guided} {:?}", guide.counts());
}

/// The exact slab, whose cell repeats, with half of all directions learned.
#[test]
fn the_exact_slab() {
    let (tau, albedo) = (2.0, 0.9);
    for (how, seed) in [(Incidence::Beam(0.5), 1), (Incidence::Diffuse, 2)] {
        let (scene, known) = (slab(tau, albedo, 0.0, how), referee(tau, albedo, how));
        let guide = learned(&scene, 20_000, Some(0.5));
        assert!(guide.counts()[0][1] > 8);
        for depth in [0.1, 1.0, 1.9] {
            let moments = numbers(1 << 14, seed, |stream| {
                sample_guided(&scene, &at_depth(depth), Orders::ALL, led(&guide), stream).0[0]
            });
            let value = exact(known.fluence(depth).unwrap());
            verdict::agrees(&format!("{how:?}, depth {depth}"), &moments, value, 0.1 * value.0, seed);
        }
    }
}

/// In light that is the same from all sides, and nothing but, every path brings as much whatever leads it; and the photons that say so, of a
/// light that paths meet by themselves, are kept.
#[test]
fn isotropic_light_stays_isotropic() {
    let white = lambertian(Spectrum::ONE);
    let fog = region(sphere(DVec3::ZERO, 1.0), 1.0, 1.0, 0.6);
    let light = isotropic(sphere(DVec3::ZERO, 2.0), Faces::Both);
    let scene = bounded(vec![fog], vec![(sphere(DVec3::new(0.3, 0.2, 0.0), 0.3), white)], vec![light]);
    let by = |share| learned(&scene, 30_000, share);
    assert_eq!(by(None).counts().map(|[_, used]| used), [0, 0]);
    let guide = by(Some(0.5));
    assert!(guide.counts().iter().all(|[_, used]| *used > 0));
    let ray = Ray::new(DVec3::new(0.0, 0.0, 0.8), DVec3::new(0.2, 0.3, -0.8).normalize());
    let moments = numbers(1 << 16, 3, |stream| {
        let mut sum = 0.0;
        radiance(&scene, (ray, 0), Orders::ALL, led(&guide), stream, |_, value| sum += value[0]);
        sum
    });
    // The irradiance is 1.
    verdict::agrees("radiance", &moments, (FRAC_1_PI, 1e-9), 0.05, 3);
}

/// Light that is the same from all sides is as bright, by photons, on the faces of a block as in the fog about it.
#[test]
fn it_is_as_bright_on_surfaces_as_in_media() {
    let fog = region(sphere(DVec3::ZERO, 1.0), 0.7, 1.0, 0.6);
    let block = cuboid(DVec3::new(-0.3, -0.2, -0.25), DVec3::new(0.3, 0.2, 0.25));
    let light = isotropic(sphere(DVec3::ZERO, 2.0), Faces::Both);
    let scene = bounded(vec![fog], vec![(block, lambertian(Spectrum::ONE))], vec![light]);
    let guide = learned(&scene, 2_000_000, Some(0.5));
    let brightness = guide.brightness().unwrap();
    let inner = [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5];
    let (mut faces, mut media) = (Moments::new(), Moments::new());
    for (x, y) in inner.into_iter().flat_map(|x| inner.map(|y| (x, y))) {
        for side in [-1.0, 1.0] {
            // Cells of two faces but those along their edges.
            faces.push(brightness.surfaces.at(DVec3::new(0.075 * x, 0.05 * y, 0.25 * side)));
            // Of the fog, cells that lie in it wholly.
            if x.abs() + y.abs() <= 2.0 {
                media.push(brightness.media.at(DVec3::new(x, y, 2.5 * side) * 0.25));
            }
        }
    }
    let relative = |moments: &Moments| moments.std_error() / moments.mean();
    let error = (relative(&faces).powi(2) + relative(&media).powi(2)).sqrt();
    let ratio = faces.mean() / media.mean();
    assert!(error < 0.02 && (ratio - 1.0).abs() < 4.5 * error, "{ratio} +- {error}");
}

/// Fluence beside a lamp, a volume source and a medium that emits, which its first direction may meet and connections find too.
#[test]
fn fluences_by_lights_of_every_extent() {
    let block = cuboid(DVec3::new(-0.6, -0.8, -0.6), DVec3::new(-0.2, -0.3, 0.0));
    let glowing =
        Homogeneous::new(Spectrum::grey(2.0), Spectrum::grey(0.5), Phase::Isotropic(Isotropic)).unwrap();
    let glowing = glowing.with_emission(Spectrum::rgb(3.0, 1.0, 0.5)).unwrap();
    let fog = region(cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), 1.0, 0.9, 0.5);
    let ember = Region { shape: sphere(DVec3::new(0.4, 0.2, -0.2), 0.25), medium: glowing.into() };
    let lamp = emitting_sphere(DVec3::new(0.3, 0.6, 0.4), 0.2);
    for (lights, seed) in [(vec![lamp.clone()], 1), (vec![lamp, volume_source(block)], 3)] {
        let scene = bounded(vec![fog.clone(), ember.clone()], Vec::new(), lights);
        let guide = learned(&scene, 20_000, Some(0.5));
        assert!(guide.counts()[0][1] > 4);
        for at in [DVec3::new(0.1, 0.3, 0.2), DVec3::new(-0.4, -0.5, -0.3), DVec3::new(0.4, 0.25, -0.1)] {
            let by = |guides: Guides<'_>, seed| {
                numbers(1 << 16, seed, |stream| {
                    sample_guided(&scene, &Quantity::Fluence(at), Orders::ALL, guides, stream).0[0]
                })
            };
            let paths = by(Guides::default(), seed);
            verdict::agree(&format!("{at}"), &by(led(&guide), seed + 1), &paths, 0.1 * paths.mean(), seed);
        }
    }
}

/// A medium that scatters into one half of directions alone, without loss: what a histogram draws from the other half comes
/// to an end, and all light is found.
#[test]
fn a_phase_function_that_sends_nothing_back() {
    let forward = Tabulated::new(&[(0.0, 1.0), (90.0, 0.0), (180.0, 0.0)]).unwrap();
    let phase = Phase::Tabulated(Arc::new(forward));
    let fog = Homogeneous::new(Spectrum::grey(2.0), Spectrum::ONE, phase).unwrap();
    let (low, high) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let fog = Region { shape: cuboid(low, high), medium: fog.into() };
    let scene = bounded(vec![fog], Vec::new(), vec![emitting_sphere(DVec3::new(0.3, 0.2, 0.1), 0.2)]);
    let guide = learned(&scene, 20_000, Some(0.5));
    let ray = Ray::new(DVec3::new(-0.5, 0.3, 0.8), DVec3::new(0.3, -0.1, -0.9).normalize());
    let by = |guides: Guides<'_>, seed| {
        numbers(1 << 17, seed, |stream| {
            let mut sum = 0.0;
            radiance(&scene, (ray, 0), Orders::SCATTERED, guides, stream, |_, value| sum += value[0]);
            sum
        })
    };
    let paths = by(Guides::default(), 1);
    verdict::agree("forwards", &by(led(&guide), 2), &paths, 0.1 * paths.mean(), 2);
}

/// The same pictures on any number of threads, and in parts.
#[test]
fn the_same_bits_on_any_number_of_threads() {
    let scene = below_a_pane(0.5, 2.0);
    let (position, look_at, up) = (DVec3::new(0.0, -0.3, 0.9), DVec3::ZERO, DVec3::Y);
    let view = View { position, look_at, up, fov: 70.0, width: 8, height: 8, filter: Filter::Box };
    let camera = Camera::new(view).unwrap();
    let film = |threads: usize, calls: &[u64]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let guide = learned(&scene, 30_000, None);
            let mut film = Film::new(8, 8);
            for samples in calls {
                let method = Method::Guided(&scene, &guide);
                let streams = Streams { seed: 3, replicate: 1 };
                method.extend(&mut film, &camera, *samples, streams, &NoProgress).unwrap();
            }
            film
        })
    };
    assert!(film(1, &[20]) == film(2, &[3, 17]));
}

/// No photons, more than fit in memory, and a share of nothing or of all, are refused; a scene without events leads nobody.
#[test]
fn what_cannot_be_learned_from() {
    let scene = below_a_pane(0.0, 2.0);
    let refused = |histories, share| {
        let settings = GuideSettings { histories, seed: 1, replicate: 0, share };
        Guide::learn(&scene, &settings, &NoProgress).unwrap_err().to_string()
    };
    for (histories, share) in
        [(0, None), (MOST_HISTORIES + 1, None), (9, Some(0.0)), (9, Some(1.0)), (9, Some(f64::NAN))]
    {
        let text = refused(histories, share);
        assert!(text.contains("allowed"), "{text}");
    }
    let settings = GuideSettings { histories: MOST_HISTORIES, seed: 1, replicate: 0, share: None };
    let cloud = slab(20.0, 1.0, 0.0, Incidence::Beam(1.0));
    let text = Guide::learn(&cloud, &settings, &NoProgress).unwrap_err().to_string();
    assert!(text.contains("would store") && text.contains("allowed: at most"), "{text}");
    let empty = bounded(Vec::new(), Vec::new(), vec![isotropic(sphere(DVec3::ZERO, 1.0), Faces::Both)]);
    let guide = learned(&empty, 1000, None);
    assert_eq!(guide.counts().map(|[_, used]| used), [0, 0]);
    let mut stream = Stream::new(1, Purpose::Paths, 0, 0);
    let ray = (Ray::new(DVec3::ZERO, DVec3::X), 0);
    let mut sum = Spectrum::ZERO;
    radiance(&empty, ray, Orders::ALL, led(&guide), &mut stream, |_, value| sum += value);
    assert_eq!(sum, Spectrum::grey(FRAC_1_PI));
}
