//! Free flights by their random numbers: the inverse of the exponential distribution, exactly, and its mean; and flights that are led.

use super::media::varying;
use crate::support::scenes::{
    bounded, cuboid, homogeneous, lambertian, layer, region, sphere, volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{Ray, exp, exp_m1, ln_1p};
use turbid::medium::{Density, Grid};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Region, SURROUNDINGS, Scene};
use turbid::stats::Moments;
use turbid::surface::{Filter, Mirror, Surface};
use turbid::transport::{Brightness, BrightnessGrid, Flight, NoProgress, free_flight, run_blocks};

/// Where flights start that are led.
const ORIGIN: DVec3 = DVec3::new(0.1, 0.2, 0.1);

/// Flights drawn a stream.
const DRAWS: u64 = 1024;

/// Ways to fly a grey ball of extinction 2 and radius 40 about the origin: a homogeneous medium in closed form; the same
/// beside a small one that varies, piece by piece; a constant grid, by tentative collisions that are all real.
fn ways() -> [(&'static str, Scene); 3] {
    let ball = sphere(DVec3::ZERO, 40.0);
    let grid = || {
        let box_of_all = (DVec3::splat(-50.0), DVec3::splat(50.0));
        Density::grid(Grid::new(box_of_all, [1; 3], 1, vec![1.0]).unwrap()).unwrap()
    };
    let even = || region(ball.clone(), 2.0, 0.5, 0.0);
    let speck = || Region {
        shape: sphere(DVec3::new(0.0, 30.0, 0.0), 1.0),
        medium: varying(Spectrum::ONE, 0.5, grid()),
    };
    let tracked = Region { shape: ball.clone(), medium: varying(Spectrum::grey(2.0), 0.5, grid()) };
    let scene = |regions: Vec<Region>| bounded(regions, Vec::new(), vec![volume_source(ball.clone())]);
    [
        ("closed form", scene(vec![even()])),
        ("piece by piece", scene(vec![even(), speck()])),
        ("tracked", scene(vec![tracked])),
    ]
}

/// The same ball filled with a density that rises along x: from 1 in the middle to 1.5 at 25.
fn rising() -> Scene {
    let box_of_all = (DVec3::splat(-50.0), DVec3::splat(50.0));
    let density = Density::grid(Grid::new(box_of_all, [2, 1, 1], 1, vec![0.5, 1.5]).unwrap()).unwrap();
    let ball = sphere(DVec3::ZERO, 40.0);
    let region = Region { shape: ball.clone(), medium: varying(Spectrum::grey(2.0), 0.5, density) };
    bounded(vec![region], Vec::new(), vec![volume_source(ball)])
}

/// Its optical depth from the middle to a distance along x over that of the even ball.
fn of_rising(t: f64) -> f64 {
    let near = t.min(25.0);
    near * (1.0 + near / 100.0) + 1.5 * (t - near)
}

/// The optical depth of a flight from the middle along x, if the medium is even.
fn flown(scene: &Scene, stream: &mut Stream) -> f64 {
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    match free_flight(scene, &ray, f64::INFINITY, SURROUNDINGS, Spectrum::ONE, false, stream) {
        Flight::Collision { t, .. } => 2.0 * t,
        // 80 mean free paths, one flight in 1e34.
        Flight::Uncollided(_) => f64::NAN,
    }
}

/// The first random number u of a flight makes it -ln(1 - u) deep, to the roundings of a product and a quotient.
pub fn flights_are_the_exact_inverse() {
    for (name, scene) in ways() {
        for history in 0..2000 {
            let mut stream = Stream::new(81, Purpose::Synthetic, 0, history);
            let u = stream.clone().unit();
            let (depth, expected) = (flown(&scene, &mut stream), -ln_1p(-u));
            let off = (depth - expected).abs();
            assert!(off <= 4.0 * f64::EPSILON * expected, "{name}: {depth} for {expected}, u {u}");
        }
    }
}

/// The mean depth of so many flights each way; bias promised to be detected.
///
/// A mean of n exponential numbers is known to 1/sqrt n: 5.4e7 see 0.1 per cent at the level of the suite, 1e7 0.25.
pub fn flights_are_a_mean_free_path_long() {
    let [closed, piece_by_piece, tracked] = ways();
    let even: fn(f64) -> f64 = |t| t;
    let cases = [
        (closed, even, 26, 1e-3),
        (piece_by_piece, even, 23, 2.6e-3),
        (tracked, even, 23, 2.6e-3),
        (("tracked where density rises", rising()), of_rising, 23, 2.6e-3),
    ];
    for ((name, scene), depth, log2, promise) in cases {
        let block = |range: std::ops::Range<u64>| {
            let mut moments = Moments::new();
            for history in range {
                let mut stream = Stream::new(82, Purpose::Synthetic, 0, history);
                (0..DRAWS).for_each(|_| moments.push(2.0 * depth(0.5 * flown(&scene, &mut stream))));
            }
            moments
        };
        let merge = |mut a: Moments, b: Moments| {
            a.merge(&b);
            a
        };
        let moments = run_blocks((1u64 << log2) / DRAWS, &NoProgress, block, merge).unwrap().unwrap();
        verdict::agrees(name, &moments, (1.0, 1e-15), promise, 82);
        verdict::rejects(name, &moments, 1.0 + promise, 82);
    }
}

/// A grid of brightness of cells of this size \[L\] about the ray's origin, dark in a fifth of them.
fn patchy(size: f64, seed: u64) -> BrightnessGrid {
    let (low, high) = (ORIGIN - 3.0 * size, ORIGIN + 5.0 * size);
    let mut grid = BrightnessGrid::new(low, high);
    let mut stream = Stream::new(seed, Purpose::Synthetic, 1, 0);
    for cell in 0..512 {
        let middle = DVec3::new((cell % 8) as f64, (cell / 8 % 8) as f64, (cell / 64) as f64) + 0.5;
        let u = stream.unit();
        grid.add(low + size * middle, if u < 0.2 { 0.0 } else { u * u });
    }
    grid
}

/// Three layers of colour along z, the last without extinction in red, and a void: with what lies behind them.
fn layered(behind: Option<Surface>) -> Scene {
    let layer = |near: f64, far: f64, sigma_t: Spectrum| Region {
        shape: cuboid(DVec3::new(-1.0, -1.0, near), DVec3::new(1.0, 1.0, far)),
        medium: homogeneous(sigma_t, Spectrum::rgb(0.9, 0.5, 0.2), 0.0),
    };
    let regions = vec![
        layer(0.2, 1.0, Spectrum::rgb(0.5, 1.0, 2.0)),
        layer(1.0, 1.5, Spectrum::ZERO),
        layer(1.5, 2.0, Spectrum::grey(0.7)),
        layer(2.0, 3.0, Spectrum::rgb(0.0, 0.3, 20.0)),
    ];
    let wall = cuboid(DVec3::new(-2.0, -2.0, 4.0), DVec3::new(2.0, 2.0, 4.5));
    let objects = behind.into_iter().map(|surface| (wall.clone(), surface)).collect();
    bounded(regions, objects, vec![volume_source(sphere(DVec3::ZERO, 9.0))])
}

/// Flights that are led to bright places collide up to each distance, and pass, as the transmittance has it, channel by channel,
/// whatever weight they start with and whatever is said to be bright: through layers of colour to a wall, a mirror or nothing, in a slab
/// without end, through 20,000 mean free paths.
pub fn led_flights_are_as_many() {
    const FLIGHTS: u64 = 1 << 19;
    let (up, level) = (DVec3::Z, DVec3::X);
    let slab = |sigma_t: f64| {
        let within = region(layer(1.0), sigma_t, 0.9, 0.0);
        bounded(vec![within], Vec::new(), vec![volume_source(sphere(DVec3::ZERO, 1.0))])
    };
    let grey = Spectrum::rgb(0.5, 0.5, 0.5);
    let cases = [
        (
            "a wall",
            layered(Some(lambertian(Spectrum::rgb(0.9, 0.5, 0.1)))),
            up,
            vec![0.5, 1.7, 2.1, 3.0],
            Spectrum::rgb(1.0, 3.0, 0.5),
        ),
        (
            "a mirror",
            layered(Some(Surface::Mirror(Mirror::new(Spectrum::grey(0.9)).unwrap()))),
            up,
            vec![1.2, 1.9],
            Spectrum::rgb(0.0, 1.0, 1.0),
        ),
        ("nothing", layered(None), up, vec![0.9, 2.6], Spectrum::ONE),
        ("a level slab", slab(2.0), level, vec![0.3, 2.0, 9.0], grey),
        ("a deep slab", slab(2e4), level, vec![2e-5, 2e-4], grey),
    ];
    for (seed, (what, scene, dir, distances, weight)) in (1..).zip(cases) {
        let size = f64::min(distances[0], 1.0);
        let brightness = Brightness {
            share: 0.5,
            media: patchy(size, seed),
            surfaces: patchy(size, seed + 9),
            period: None,
        };
        let ray = Ray::new(ORIGIN, dir);
        let hit = scene.hit(&ray, None);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let mut collided = vec![[Moments::new(); 3]; distances.len()];
        let mut passed = [Moments::new(); 3];
        let mut longest = 0.0f64;
        for history in 0..FLIGHTS {
            let mut stream = Stream::new(seed, Purpose::Synthetic, 0, history);
            let ahead = (hit.as_ref(), end, SURROUNDINGS);
            let (flight, factor) = brightness.fly(&scene, &ray, ahead, weight, &mut stream).unwrap();
            longest = longest.max(factor);
            let (t, after) = match flight {
                Flight::Collision { t, weight, .. } => (t, weight),
                Flight::Uncollided(weight) => (f64::INFINITY, weight),
            };
            for channel in 0..3 {
                for (moments, distance) in collided.iter_mut().zip(&distances) {
                    moments[channel].push(if t < *distance { after[channel] } else { 0.0 });
                }
                passed[channel].push(if t == f64::INFINITY { after[channel] } else { 0.0 });
            }
        }
        assert!(longest > 1.5 && longest <= 2.0, "{what}: {longest}");
        for channel in (0..3).filter(|channel| weight[*channel] > 0.0) {
            let through = |t: f64| exp(-scene.optical_depth(&ray, t, SURROUNDINGS)[channel]);
            for (moments, distance) in collided.iter().zip(&distances) {
                let expected = weight[channel] * (1.0 - through(*distance));
                let what = format!("{what}, channel {channel}, to {distance}");
                verdict::agrees(&what, &moments[channel], (expected, 1e-12), 0.025 * weight.max(), seed);
            }
            let expected = weight[channel] * through(end);
            if expected > 1e-3 {
                let what = format!("{what}, channel {channel}, beyond");
                verdict::agrees(&what, &passed[channel], (expected, 1e-12), 0.025 * weight.max(), seed);
            }
        }
    }
}

/// The probabilities of a flight's ends are those of its media to the last digits, however thin these are, with whatever lies behind; where it
/// is bright only behind so much that no flight comes there, and where photons fell into one point, flights keep their own ends or are led
/// by numbers.
pub fn ends_are_as_likely_as_flights_end() {
    let brightness = |media: BrightnessGrid| {
        let surfaces = BrightnessGrid::new(ORIGIN, ORIGIN);
        Brightness { share: 0.5, media, surfaces, period: None }
    };
    let filter = || Surface::Filter(Filter::new(Spectrum::grey(0.5)).unwrap());
    for sigma_t in [1e-29, 1e-19, 6e-17, 1e-10, 0.1, 3.0, 1e5] {
        for color in [Spectrum::ONE, Spectrum::rgb(0.0, 0.3, 1.0)] {
            let air = Region {
                shape: cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)),
                medium: homogeneous(color * sigma_t, Spectrum::grey(0.5), 0.0),
            };
            let pane = cuboid(DVec3::new(-1.0, -1.0, 2.0), DVec3::new(1.0, 1.0, 2.1));
            let scene =
                bounded(vec![air], vec![(pane, filter())], vec![volume_source(sphere(DVec3::ZERO, 1.0))]);
            let (ray, weight) = (Ray::new(ORIGIN, DVec3::Z), Spectrum::rgb(0.2, 0.3, 0.7));
            let hit = scene.hit(&ray, None);
            let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
            let segments = scene.segments(&ray, end, SURROUNDINGS);
            let mut led_by = 0;
            for seed in 0..20 {
                let brightness = brightness(patchy(0.2, seed));
                let ends = brightness.ends(&scene, &ray, (hit.as_ref(), &segments), weight);
                // Where a flight comes no further than a dark cell.
                let Some(ends) = ends else { continue };
                led_by += 1;
                let (beyond, within) = ends.ways().split_last().unwrap();
                let collided: f64 = within.iter().map(|(own, _)| own).sum();
                let share = |channel: usize| weight[channel] / weight.sum();
                let depth = |channel: usize| color[channel] * sigma_t * 0.9;
                let expected: f64 = (0..3).map(|channel| share(channel) * -exp_m1(-depth(channel))).sum();
                assert!((collided / expected - 1.0).abs() < 1e-13, "{sigma_t} {color:?}: {collided}");
                assert!((collided + beyond.0 - 1.0).abs() < 1e-13, "{sigma_t} {color:?}: {}", beyond.0);
                // The pane keeps its probability, and the rest theirs together.
                assert!((ends.more_often(beyond.1, 0.5) - 1.0).abs() < 1e-12);
                let led: f64 = ends.ways().iter().map(|way| way.0 * ends.more_often(way.1, 0.5)).sum();
                assert!((led - 1.0).abs() < 1e-12, "{sigma_t} {color:?}: {led}");
            }
            assert!(led_by >= 10, "{sigma_t} {color:?}: {led_by}");
        }
    }
    let ray = Ray::new(ORIGIN, DVec3::Z);
    let fly = |brightness: &Brightness, scene: &Scene, seed: u64| {
        let hit = scene.hit(&ray, None);
        let end = hit.map_or(f64::INFINITY, |found| found.hit.t);
        let mut stream = Stream::new(seed, Purpose::Synthetic, 2, 0);
        brightness.fly(scene, &ray, (hit.as_ref(), end, SURROUNDINGS), Spectrum::ONE, &mut stream)
    };
    // All photons at one point, on the ray, beside it, or at the origin of the world.
    for point in [ray.at(0.5), DVec3::new(0.3, 0.1, -0.2), DVec3::ZERO] {
        let mut grid = BrightnessGrid::new(point, point);
        grid.add(point, 3.0);
        assert!(grid.scale().is_finite() && grid.at(point) > 0.0);
        let brightness = Brightness { surfaces: grid.clone(), ..brightness(grid) };
        for seed in 0..100 {
            if let Some((_, factor)) = fly(&brightness, &layered(Some(lambertian(Spectrum::ONE))), seed) {
                assert!(factor > 0.0 && factor <= 2.0, "{factor}");
            }
        }
    }
    // Lit fog behind 400 mean free paths.
    let slab = |near: f64, far: f64, sigma_t: Spectrum| Region {
        shape: cuboid(DVec3::new(-1.0, -1.0, near), DVec3::new(1.0, 1.0, far)),
        medium: homogeneous(sigma_t, Spectrum::grey(0.5), 0.0),
    };
    let regions = vec![
        slab(0.0, 1.1, Spectrum::rgb(400.0, 410.0, 420.0)),
        slab(1.1, 2.0, Spectrum::rgb(1.0, 2.0, 3.0)),
    ];
    let scene = bounded(regions, Vec::new(), vec![volume_source(sphere(DVec3::ZERO, 1.0))]);
    let mut grid = BrightnessGrid::new(DVec3::splat(-1.0), DVec3::splat(2.0));
    grid.add(ray.at(1.5), 1.0);
    assert!((0..100).all(|seed| fly(&brightness(grid.clone()), &scene, seed).is_none()));
}
