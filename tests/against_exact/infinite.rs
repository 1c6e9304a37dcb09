//! A point light in an unbounded medium: fluence against distance, and how far scattering takes the photons.
//!
//! A ball of radius 60 mean free paths stands for the unbounded medium: of albedo 0.9, light decays with at least 0.3 in
//! a mean free path, so that what the rest would send back is below 1e-12 everywhere.

use super::sphere_fields::{in_shells, shell_mean};
use crate::checks::slab::exact;
use crate::support::scenes::{ball, point_light};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::photons::{Histories, shoot};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::InfiniteMedium;
use turbid_analytic::infinite::{mean_cosine, mean_square_displacement};

const ALBEDO: f64 = 0.9;

fn scene(g: f64) -> Scene {
    ball(60.0, ALBEDO, g, point_light(DVec3::ZERO, Spectrum::ONE))
}

#[test]
fn fluence_against_distance() {
    let edges = [0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0];
    for g in [0.0, 0.75] {
        let medium = InfiniteMedium::henyey_greenstein(ALBEDO, g).unwrap();
        let field = |r: f64| medium.fluence(r).unwrap().value;
        for (moments, edge) in in_shells(&scene(g), &edges, 1 << 11, 1).iter().zip(edges.windows(2)) {
            let reference = shell_mean(edge[0], edge[1], field);
            let what = format!("{} to {}, g {g}", edge[0], edge[1]);
            verdict::agrees(&what, moments, reference, 0.1 * reference.0, 1);
        }
    }
}

/// After n flights, n - 1 scatterings, <R^2> = 2n/(1-g) - 2g (1-g^n)/(1-g)^2, and after n scatterings the mean cosine with
/// the first direction is g^n. Both per emitted photon: w^(n-1) of them are left.
#[test]
fn how_far_scattering_takes_them() {
    const FLIGHTS: u32 = 6;
    for g in [-0.5, 0.0, 0.75, 0.95] {
        let scene = scene(g);
        let mut sums = [[Moments::new(); 2]; FLIGHTS as usize];
        for replicate in 0..128 {
            let histories = Histories { count: 1024, seed: 3, replicate, max_order: Some(FLIGHTS - 1) };
            let pass = shoot(&scene, histories, &[], |_| true, &NoProgress).unwrap();
            let mut batch = [[0.0; 2]; FLIGHTS as usize];
            let mut first = DVec3::ZERO;
            for photon in pass.photons() {
                let dir = photon.dir.as_dvec3();
                if photon.order == 0 {
                    first = dir;
                }
                let power = f64::from(photon.power.x);
                batch[usize::from(photon.order)][0] += power * photon.position.length_squared();
                batch[usize::from(photon.order)][1] += power * dir.dot(first);
            }
            for (moments, batch) in sums.iter_mut().zip(batch) {
                for (m, sum) in moments.iter_mut().zip(batch) {
                    m.push(sum / pass.emitted() as f64);
                }
            }
        }
        for (n, [square, cosine]) in (1..=FLIGHTS).zip(&sums) {
            let left = ALBEDO.powi(n as i32 - 1);
            let (value, error) = exact(mean_square_displacement(g, n).unwrap());
            let what = format!("R^2 after {n} flights, g {g}");
            // f32 powers and directions are good to 6e-8.
            verdict::agrees(&what, square, (left * value, left * error + 1e-6 * value), 0.1 * value, 3);
            let (value, error) = exact(mean_cosine(g, n - 1).unwrap());
            let what = format!("cosine after {} scatterings, g {g}", n - 1);
            verdict::agrees(&what, cosine, (left * value, left * error + 1e-6), 0.03, 3);
            let wrong = left * mean_square_displacement(g, n + 1).unwrap().value;
            verdict::rejects(&format!("a flight more than {n}, g {g}"), square, wrong, 3);
        }
    }
}
