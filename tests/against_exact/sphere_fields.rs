//! Fields of the sphere: fluence against radius from photons in shells, and the radiance that leaves against its angle,
//! by photons as they leave and by paths.

use super::sphere::{SOURCES, body, light_of, referee};
use crate::checks::slab::exact;
use crate::support::quadrature::integrate;
use crate::support::run::{Watcher, paths, watched};
use crate::support::scenes::ball;
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::math::{FOUR_PI, Ray, exp, exp_m1};
use turbid::photons::{Histories, shoot};
use turbid::scene::{Orders, Quantity, Scene};
use turbid::stats::Moments;
use turbid::transport::{NoProgress, Step, Walker};
use turbid_analytic::{Sphere, SphereSource};

/// Radius and albedo.
const BALLS: [(f64, f64); 3] = [(0.5, 1.0), (1.0, 0.9), (5.0, 0.99)];
/// Photons a batch in shells: those in the small ball seldom collide.
const PER_BATCH: [u64; 3] = [1 << 14, 1 << 13, 1 << 11];
const BATCHES: u64 = 64;

/// Mean fluence of shells about the origin between these radii from the photons that collide there, extinction 1: no
/// kernel, hence no blur.
pub fn in_shells(scene: &Scene, edges: &[f64], count: u64, seed: u64) -> Vec<Moments> {
    let mut shells = vec![Moments::new(); edges.len() - 1];
    for replicate in 0..BATCHES {
        let histories = Histories { count, seed, replicate, max_order: None };
        let pass = shoot(scene, histories, &[], |_| true, &NoProgress).unwrap();
        let mut sums = vec![0.0; shells.len()];
        for photon in pass.photons() {
            let above = edges.partition_point(|&edge| edge <= photon.position.length());
            if (1..edges.len()).contains(&above) {
                sums[above - 1] += f64::from(photon.power.x);
            }
        }
        for ((moments, sum), edges) in shells.iter_mut().zip(sums).zip(edges.windows(2)) {
            let (a, b) = (edges[0], edges[1]);
            let volume = FOUR_PI / 3.0 * (b - a) * (a * a + a * b + b * b);
            moments.push(sum / (pass.emitted() as f64 * volume));
        }
    }
    shells
}

/// Mean of a field over the shell from a to b, good to 4e-10 (measured against three times the nodes), with room for f32
/// powers. Nodes crowd at both ends: r^2 phi is smooth at a central point, and like t ln t at a surface.
pub fn shell_mean(a: f64, b: f64, field: impl Fn(f64) -> f64) -> (f64, f64) {
    let integral = integrate(0.0, 1.0, 1, |s| {
        let r = a + (b - a) * s * s * (3.0 - 2.0 * s);
        field(r) * r * r * (b - a) * 6.0 * s * (1.0 - s)
    });
    let mean = 3.0 * integral / ((b - a) * (a * a + a * b + b * b));
    (mean, 1e-6 * mean)
}

/// The inmost shell of a central source holds its singularity.
#[test]
fn fluence_of_photons_in_shells() {
    for ((radius, albedo), count) in BALLS.into_iter().zip(PER_BATCH) {
        for source in SOURCES {
            let exact_ball = referee(radius, albedo, source);
            let scene = ball(radius, albedo, 0.0, light_of(source, radius));
            // A photon on the surface may lie a rounding beyond it.
            let edges = [0.0, 0.3, 0.5, 0.7, 0.85, 1.0].map(|part| part * radius);
            let counted = in_shells(&scene, &[&edges[..5], &[radius * (1.0 + 1e-12)]].concat(), count, 1);
            for (shell, moments) in counted.iter().enumerate() {
                let field = |r| exact_ball.fluence(r).unwrap().value;
                let reference = shell_mean(edges[shell], edges[shell + 1], field);
                let what = format!("{source:?}, shell {shell}, radius {radius}, albedo {albedo}");
                verdict::agrees(&what, moments, reference, 0.15 * reference.0, 1);
            }
        }
    }
}

const BINS: usize = 4;

/// Powers that leave a ball by the cosine of the angle to the surface's normal: scattered light in equal bins.
struct Leaving {
    radius: f64,
    bins: [f64; BINS],
}

impl Watcher<BINS> for Leaving {
    fn see(&mut self, walker: &Walker, step: Step) {
        if let Step::Escaped(weight) = step
            && walker.order > 0
            && let Some(inside) = body(self.radius).interval(&walker.ray)
        {
            let mu = walker.ray.at(inside.end).normalize().dot(walker.ray.dir);
            self.bins[((mu * BINS as f64) as usize).min(BINS - 1)] += weight[0];
        }
    }

    fn numbers(&self) -> [f64; BINS] {
        self.bins
    }
}

/// Scattered radiance that leaves at a cosine, per unit of emitted power \[W/(L^2 sr)\]: the whole of it, less the direct
/// part of the uniform source, (1 - e^-2 a mu) over 4 pi times the volume, or of incident light, e^(-2 a mu)/pi.
pub fn scattered(ball: &Sphere, mu: f64) -> (f64, f64) {
    let radius = ball.radius();
    let volume = FOUR_PI / 3.0 * radius * radius * radius;
    let chord = 2.0 * radius * mu;
    let (value, error) = exact(ball.exit_radiance(mu).unwrap());
    let (direct, power) = match ball.source() {
        SphereSource::Uniform => (-exp_m1(-chord) / (FOUR_PI * volume), 1.0),
        SphereSource::Centre => (0.0, 1.0),
        SphereSource::Incident => (exp(-chord) / PI, FOUR_PI * radius * radius),
    };
    ((value - direct) / power, error / power)
}

#[test]
fn power_that_leaves_by_angle() {
    for (radius, albedo) in BALLS {
        for source in SOURCES {
            let scene = ball(radius, albedo, 0.0, light_of(source, radius));
            let exact_ball = referee(radius, albedo, source);
            let bins = watched(&scene, 1 << 17, 2, || Leaving { radius, bins: [0.0; BINS] });
            for (bin, moments) in bins.iter().enumerate() {
                let edge = |i: usize| (1.0 - i as f64 / BINS as f64).sqrt();
                // mu = 1 - y^2: the central source's radiance grows as 1/y.
                let power = integrate(edge(bin + 1), edge(bin), 1, |y| {
                    let mu = (1.0 - y) * (1.0 + y);
                    scattered(&exact_ball, mu).0 * mu * 2.0 * y
                });
                let expected = power * 2.0 * PI * FOUR_PI * radius * radius;
                let what = format!("{source:?}, bin {bin}, radius {radius}, albedo {albedo}");
                verdict::agrees(&what, moments, (expected, 1e-8), 0.012, 2);
            }
        }
    }
}

#[test]
fn radiance_that_leaves() {
    for (radius, albedo) in BALLS {
        for source in SOURCES {
            // Many connections to a point from inside fog have a variance that diverges, if only as a logarithm.
            if source == SphereSource::Centre && radius > 1.0 {
                continue;
            }
            let scene = ball(radius, albedo, 0.0, light_of(source, radius));
            let exact_ball = referee(radius, albedo, source);
            for mu in [0.2f64, 0.5, 0.95] {
                let dir = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, -mu);
                let ray = Ray::new(DVec3::new(0.0, 0.0, radius), dir);
                let moments = paths(&scene, Quantity::Radiance(ray), Orders::SCATTERED, 1 << 17, 3)[0];
                let (value, error) = scattered(&exact_ball, mu);
                let power = if source == SphereSource::Incident { FOUR_PI * radius * radius } else { 1.0 };
                let what = format!("{source:?}, mu {mu}, radius {radius}, albedo {albedo}");
                let reference = (value * power, error * power);
                verdict::agrees(&what, &moments, reference, 0.12 * reference.0, 3);
            }
        }
    }
}
