//! Free flights by their random numbers: the inverse of the exponential distribution, exactly, and its mean.

use super::media::varying;
use crate::support::scenes::{bounded, region, sphere, volume_source};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{Ray, ln_1p};
use turbid::medium::{Density, Grid};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Region, SURROUNDINGS, Scene};
use turbid::stats::Moments;
use turbid::transport::{Flight, NoProgress, free_flight, run_blocks};

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
