//! Free flight: the optical depth flown is exponential; forced, through overlapping media, and by channel.

use crate::checks::flights;
use crate::support::run::histories;
use crate::support::scenes::{bounded, homogeneous, region, sphere, volume_source};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{Ray, exp, exp_m1};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Region, SURROUNDINGS, Scene};
use turbid::transport::{Flight, free_flight};

const N: u64 = 1 << 18;

/// Concentric and overlapping balls with vacuum between: a dense core in a thin shell, an empty hole, and another
/// ball that covers part of the shell.
fn overlapping() -> Scene {
    let shell = sphere(DVec3::ZERO, 3.0);
    bounded(
        vec![
            region(shell.clone(), 0.4, 0.5, 0.0),
            region(sphere(DVec3::ZERO, 1.0), 2.0, 0.5, 0.0),
            region(sphere(DVec3::new(0.0, 0.0, 2.0), 0.5), 0.0, 0.5, 0.0),
            region(sphere(DVec3::new(0.0, 0.0, -2.8), 0.7), 1.5, 0.5, 0.0),
        ],
        Vec::new(),
        vec![volume_source(shell)],
    )
}

fn down() -> Ray {
    Ray::new(DVec3::new(0.0, 0.0, -5.0), DVec3::Z)
}

/// By hand, along the axis: 0.7 before and 0.7 after the centre of the ball at -2.8 (from -3.5 to -2.1), then the
/// shell to -1, the core to 1, the shell to 1.5, the hole to 2.5, the shell to 3.
#[test]
fn the_later_region_counts_where_they_overlap() {
    let depth = 1.5 * 1.4 + 0.4 * 1.1 + 2.0 * 2.0 + 0.4 * 0.5 + 0.4 * 0.5;
    let scene = overlapping();
    assert!((scene.optical_depth(&down(), f64::INFINITY, SURROUNDINGS)[0] - depth).abs() < 1e-14);
    // From the inside, and up to a body on the way.
    let inside = Ray::new(DVec3::ZERO, DVec3::Z);
    assert!((scene.optical_depth(&inside, 1.2, SURROUNDINGS)[0] - (2.0 + 0.4 * 0.2)).abs() < 1e-14);
    // Anywhere: a fine sum over what is at each point.
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    for _ in 0..200 {
        let target = DVec3::from_array(stream.triple()) * 6.0 - 3.0;
        let origin = DVec3::from_array(stream.triple()) * 8.0 - 4.0;
        let ray = Ray::new(origin, (target - origin).normalize());
        let step = 1e-3;
        let sum: f64 = (0..14_000)
            .map(|i| {
                let p = ray.at((f64::from(i) + 0.5) * step);
                scene.medium_at(p).map_or(0.0, |m| m.sigma_t(p)[0] * step)
            })
            .sum();
        // Each of at most 8 ends is misplaced by half a step.
        assert!(
            (scene.optical_depth(&ray, f64::INFINITY, SURROUNDINGS)[0] - sum).abs() < 8.0 * step * 2.0,
            "{ray:?}"
        );
    }
}

#[test]
fn the_depth_flown_is_exponential_and_passes_with_the_transmittance() {
    let scene = overlapping();
    let ray = down();
    let depth = scene.optical_depth(&ray, f64::INFINITY, SURROUNDINGS)[0];
    let (mut flown, mut transmitted) = (Vec::new(), 0);
    for i in 0..N {
        match free_flight(
            &scene,
            &ray,
            f64::INFINITY,
            SURROUNDINGS,
            Spectrum::ONE,
            false,
            &mut Stream::new(2, Purpose::Synthetic, 0, i),
        ) {
            Flight::Collision { t, medium, weight } => {
                assert_eq!(weight, Spectrum::ONE);
                assert_eq!(*scene.medium(medium), *scene.medium_at(ray.at(t)).unwrap());
                flown.push(scene.optical_depth(&ray, t, SURROUNDINGS)[0]);
            }
            Flight::Uncollided(weight) => {
                assert_eq!(weight, Spectrum::ONE);
                transmitted += 1;
            }
        }
    }
    let cdf = |tau: f64| exp_m1(-tau) / exp_m1(-depth);
    verdict::fits("depth of collisions", verdict::cumulated(&flown, cdf), 0.01, 2);
    // The negative control: extinction half a per cent off.
    let wrong: Vec<f64> = flown.iter().map(|tau| tau * 1.02).collect();
    verdict::misfits("extinction 2 % off", verdict::cumulated(&wrong, cdf), 2);
    verdict::rate("transmitted", transmitted, N, exp(-depth), 1e-3, 2);
}

/// A forced flight collides for certain, with the probability as its weight, exponentially within what is there.
#[test]
fn a_forced_flight_always_collides() {
    for sigma_t in [1e-12, 1e-8, 1e-3, 1.0, 40.0] {
        let ball = sphere(DVec3::ZERO, 1.0);
        let scene =
            bounded(vec![region(ball.clone(), sigma_t, 0.5, 0.0)], Vec::new(), vec![volume_source(ball)]);
        let ray = Ray::new(DVec3::new(0.0, 0.0, -2.0), DVec3::Z);
        let probability = -exp_m1(-2.0 * sigma_t);
        let flown: Vec<f64> = (0..1 << 16)
            .map(|i| {
                let mut stream = Stream::new(3, Purpose::Synthetic, 0, i);
                let flight =
                    free_flight(&scene, &ray, f64::INFINITY, SURROUNDINGS, Spectrum::ONE, true, &mut stream);
                let Flight::Collision { t, weight, .. } = flight else { panic!("{flight:?}") };
                assert!((weight[0] / probability - 1.0).abs() < 4.0 * f64::EPSILON, "{weight:?}");
                assert!((1.0..=3.0).contains(&t), "{t}");
                t
            })
            .collect();
        let cdf = |t: f64| exp_m1(-sigma_t * (t - 1.0)) / exp_m1(-2.0 * sigma_t);
        verdict::fits(&format!("sigma_t = {sigma_t}"), verdict::cumulated(&flown, cdf), 0.02, 3);
    }
}

fn chromatic() -> Scene {
    let ball = sphere(DVec3::ZERO, 1.0);
    let core = sphere(DVec3::ZERO, 0.25);
    let shell =
        Region { shape: ball.clone(), medium: homogeneous(Spectrum::rgb(0.2, 1.0, 3.0), Spectrum::ONE, 0.0) };
    let core = Region { shape: core, medium: homogeneous(Spectrum::rgb(2.0, 0.0, 1.0), Spectrum::ONE, 0.0) };
    bounded(vec![shell, core], Vec::new(), vec![volume_source(ball)])
}

/// Where extinction differs by channel each channel is unbiased, in every part of the way and behind it, and the
/// summed weight stays as it was. Expectations are in closed form, part by part.
#[test]
fn a_chromatic_flight_is_unbiased_by_channel() {
    let scene = chromatic();
    let ray = Ray::new(DVec3::new(0.0, 0.0, -1.0), DVec3::Z);
    let weight = Spectrum::rgb(1.0, 0.5, 0.25);
    let ends = [0.0, 0.4, 0.75, 1.0, 1.25, 1.6, 2.0];
    let seed = 4;
    for part in 0..ends.len() {
        let (low, high) = (ends[part], ends.get(part + 1).copied().unwrap_or(f64::INFINITY));
        for forced in [false, true] {
            let sampled = histories(N / 8, seed, |stream| {
                match free_flight(&scene, &ray, f64::INFINITY, SURROUNDINGS, weight, forced, stream) {
                    Flight::Collision { t, weight: w, .. } => {
                        assert!(forced || (w.sum() / weight.sum() - 1.0).abs() < 8.0 * f64::EPSILON);
                        if low <= t && t < high { w } else { Spectrum::ZERO }
                    }
                    Flight::Uncollided(w) => {
                        assert!((w.sum() / weight.sum() - 1.0).abs() < 8.0 * f64::EPSILON);
                        if high.is_infinite() { w } else { Spectrum::ZERO }
                    }
                }
            });
            for c in 0..3 {
                let pass = |t: f64| exp(-scene.optical_depth(&ray, t, SURROUNDINGS)[c]);
                let expected = weight[c] * if high.is_finite() { pass(low) - pass(high) } else { pass(2.0) };
                let what = format!("from {low} to {high}, channel {c}, forced {forced}");
                if forced && high.is_infinite() {
                    assert_eq!(sampled[c].mean(), 0.0);
                } else if expected == 0.0 {
                    assert!(sampled[c].mean().abs() < 1e-12, "{what}");
                } else {
                    verdict::agrees(&what, &sampled[c], (expected, 0.0), 0.02 * weight.sum(), seed);
                }
            }
        }
    }
}

#[test]
fn flights_are_the_exact_inverse() {
    flights::flights_are_the_exact_inverse();
}

#[test]
fn flights_are_a_mean_free_path_long() {
    flights::flights_are_a_mean_free_path_long();
}

#[test]
fn led_flights_are_as_many() {
    flights::led_flights_are_as_many();
}

#[test]
fn ends_are_as_likely_as_flights_end() {
    flights::ends_are_as_likely_as_flights_end();
}
