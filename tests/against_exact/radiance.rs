//! Scattered radiance in Henyey-Greenstein slabs by direction and azimuth, inside and as it leaves: what fluxes average
//! over. By paths, and from photon maps with the blur that is predicted of them.
//!
//! A map of gather radius r blurs in-scattered radiance over balls. In a slab only depths matter: with k the kernel's
//! marginal, J becomes int k(z) J(t + r z) dz, J nothing outside the slab. Along a ray of cosine mu that light follows from
//! its far face, at depth f, to depth t, transmittance depends on the difference of depths alone: the ray collects the
//! same average over rays that begin and end r z deeper,
//!
//! int k(z) \[I(t + r z) - e^(-|t - f|/|mu|) I(f + r z)\] dz,
//!
//! I the exact radiance, continued behind the face where light leaves by e^(-distance/|mu|) and behind the far face by 0.
//! So the loss at faces and the blur within are both predicted, exactly. Points along a ray blur across it alone: the same with the
//! marginal of the disc, in r sin(theta) of depth.

use super::henyey_greenstein::{MEDIA, medium, referee};
use crate::checks::slab::exact;
use crate::support::quadrature::integrate;
use crate::support::run::{paths, sensor};
use crate::support::scenes::{CELL, Incidence, homogeneous, incidence, layer, region, slab};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{Positive, Ray, exp};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::AnisotropicSlab;

/// Gather radius of the maps.
const RADIUS: f64 = 0.5;
const MAPS: u64 = 64;
const PHOTONS: u64 = 1 << 13;
const PATHS: u64 = 1 << 16;

/// A place and a direction of travel: depth over thickness, cosine (up is positive), azimuth against that of the beam.
pub type View = (f64, f64, f64);

/// Leaving through both faces, and inside: up, down and level.
pub const VIEWS: [View; 8] = [
    (0.0, 0.3, 0.0),
    (0.0, 0.9, 0.5 * PI),
    (0.0, 0.3, PI),
    (1.0, -0.4, 0.0),
    (1.0, -0.8, PI),
    (0.4, 0.5, PI / 3.0),
    (0.4, -0.6, 2.0 * PI / 3.0),
    (0.6, 0.0, 0.25 * PI),
];

/// A view of the slab from one point in the cell: the ray looks against the light.
pub fn looking(tau: f64, (part, mu, dphi): View) -> Quantity {
    let s = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let (sin, cos) = turbid::math::sin_cos(dphi);
    let travel = DVec3::new(s * cos, s * sin, -mu);
    Quantity::Radiance(Ray::new(DVec3::new(0.5 * CELL, 0.5 * CELL, part * tau), -travel.normalize()))
}

fn exact_radiance(slab: &AnisotropicSlab, t: f64, mu: f64, dphi: f64) -> (f64, f64) {
    exact(slab.radiance(t, mu, dphi).unwrap())
}

const INCIDENCES: [Incidence; 3] = [Incidence::Beam(1.0), Incidence::Beam(0.5), Incidence::Diffuse];

#[test]
fn radiance_of_paths() {
    for ((tau, albedo, g), promise) in MEDIA.into_iter().zip([0.07, 0.15, 0.5]) {
        let exact_medium = medium(albedo, g);
        for how in INCIDENCES {
            let exact_slab = referee(&exact_medium, tau, how);
            let scene = slab(tau, albedo, g, how);
            // Next events hit a sharp peak seldom: more paths, and fewer views.
            let (histories, step) = match (g, how) {
                (0.95, Incidence::Diffuse) => (PATHS / 4, 1),
                (0.75, Incidence::Diffuse) | (-0.5, Incidence::Beam(_)) => (PATHS / 2, 1),
                (0.95, _) => (4 * PATHS, 3),
                _ => (PATHS, 1),
            };
            for view in VIEWS.into_iter().step_by(step) {
                let (part, mu, dphi) = view;
                let reference = exact_radiance(&exact_slab, part * tau, mu, dphi);
                let moments = paths(&scene, looking(tau, view), Orders::SCATTERED, histories, 1)[0];
                let what = format!("depth {part} tau, mu {mu}, dphi {dphi:.3}, g {g}, {how:?}");
                verdict::agrees(&what, &moments, reference, promise * reference.0, 1);
            }
        }
    }
}

/// What a map of this gather radius, in mean free paths, is expected to see.
fn blurred(slab: &AnisotropicSlab, view: View, radius: f64) -> f64 {
    // 3/4 (1 - z^2) of the ball.
    shifted(slab, view, radius, |cos| 0.75 * cos * cos)
}

/// What points along the ray within this distance of it are expected to see.
fn blurred_across(slab: &AnisotropicSlab, view: View, radius: f64) -> f64 {
    let (_, mu, _) = view;
    // (2/pi) sqrt(1 - z^2) of the disc.
    shifted(slab, view, radius * ((1.0 - mu) * (1.0 + mu)).sqrt(), |cos| 2.0 / PI * cos)
}

/// The mean over depths that are shifted by `reach` z, by a marginal of z, which is given its cosine, sqrt(1 - z^2).
fn shifted(
    slab: &AnisotropicSlab,
    (part, mu, dphi): View,
    radius: f64,
    marginal: impl Fn(f64) -> f64,
) -> f64 {
    let (tau, size) = (slab.tau(), mu.abs());
    let t = part * tau;
    let inside = |t: f64| exact_radiance(slab, t, mu, dphi).0;
    let continued = |t: f64| {
        let (near, beyond) = if mu > 0.0 { (0.0, -t) } else { (tau, t - tau) };
        if (0.0..=tau).contains(&t) {
            inside(t)
        } else if beyond > 0.0 && size > 0.0 {
            inside(near) * exp(-beyond / size)
        } else {
            0.0
        }
    };
    let (far, depth) = if mu > 0.0 { (tau, tau - t) } else { (0.0, t) };
    let behind = if size > 0.0 { exp(-depth / size) } else { 0.0 };
    // Kinks where a depth crosses a face.
    let mut edges = vec![-1.0, 1.0];
    edges.extend([t, t - tau, far, far - tau].map(|d| -d / radius).into_iter().filter(|z| z.abs() < 1.0));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let piece = |a: f64, b: f64| {
        // By the angle whose sine is z: the marginal of a disc has endless slopes at its ends.
        integrate(libm::asin(a), libm::asin(b), 1, |angle| {
            let (z, cos) = turbid::math::sin_cos(angle);
            let r = radius * z;
            cos * marginal(cos) * (continued(t + r) - behind * continued(far + r))
        })
    };
    edges.windows(2).map(|edge| piece(edge[0], edge[1])).sum()
}

/// The slab with views as sensors.
fn viewed((tau, albedo, g): (f64, f64, f64), how: Incidence, views: &[View]) -> Scene {
    let region = region(layer(tau), 1.0, albedo, g);
    layered(region, how, views.iter().map(|view| looking(tau, *view)))
}

fn layered(region: Region, how: Incidence, views: impl Iterator<Item = Quantity>) -> Scene {
    Scene::new(SceneParts {
        lights: vec![incidence(region.shape.clone(), how)],
        regions: vec![region],
        sensors: views.map(|view| sensor(view, Orders::SCATTERED)).collect(),
        cell: Some(glam::DVec2::splat(CELL)),
        ..SceneParts::default()
    })
    .unwrap()
}

/// Balls at places of a march.
fn in_balls() -> Estimator {
    Estimator::new(Kernel::Uniform, Gather::radius(RADIUS).unwrap())
}

/// One number a map, view and channel.
fn of_maps(scene: &Scene, photons: u64, seed: u64, estimator: Estimator) -> Vec<Moments> {
    let mut views = Vec::new();
    for map in 0..MAPS {
        let settings =
            PhotonSettings { photons, maps: 1, seed: (seed << 32) + map, orders: Orders::ALL, estimator };
        let measurements = by_photons(scene, &settings, &NoProgress).unwrap().measurements;
        views.resize(measurements.len(), Moments::new());
        for (view, measurement) in views.iter_mut().zip(measurements) {
            view.push(measurement.mean);
        }
    }
    views
}

#[test]
fn radiance_of_photon_maps() {
    for ((tau, albedo, g), promise) in MEDIA.into_iter().zip([0.1, 0.15, 0.4]) {
        let exact_medium = medium(albedo, g);
        for how in [Incidence::Beam(0.5), Incidence::Diffuse] {
            // Where a sharp peak sends little, few photons near the peak bring it all: a matter for paths.
            let (views, photons) = match (g > 0.9, how) {
                (true, Incidence::Diffuse) => continue,
                (true, _) => (vec![VIEWS[3], VIEWS[7]], 2 * PHOTONS),
                (false, _) => (VIEWS.to_vec(), PHOTONS),
            };
            let exact_slab = referee(&exact_medium, tau, how);
            let measured = of_maps(&viewed((tau, albedo, g), how, &views), photons, 2, in_balls());
            for (moments, view) in measured.iter().zip(views) {
                let (part, mu, dphi) = view;
                let expected = blurred(&exact_slab, view, RADIUS);
                let what = format!("depth {part} tau, mu {mu}, dphi {dphi:.3}, g {g}, {how:?}");
                // The quadrature is good to 3e-8 (measured against three times the nodes), f32 sums to 2e-6.
                verdict::agrees(&what, moments, (expected, 1e-5 * expected), promise * expected, 2);
                if view == VIEWS[0] {
                    let sharp = exact_radiance(&exact_slab, part * tau, mu, dphi).0;
                    verdict::rejects(&format!("not blurred, {what}"), moments, sharp, 2);
                }
            }
        }
    }
}

/// Points along rays in the same slabs, at half the radius: cut square at faces, blurred across the ray, and by no step.
#[test]
fn radiance_of_points_along_rays() {
    let radius = 0.5 * RADIUS;
    let of_rays = in_balls().along_rays(Positive::new("the radius", radius).unwrap());
    // Of peaks the noise has heavy tails here: one photon that travels along the ray counts most.
    for ((tau, albedo, g), promise) in MEDIA.into_iter().zip([0.13]) {
        let exact_medium = medium(albedo, g);
        for how in [Incidence::Beam(0.5), Incidence::Diffuse] {
            let exact_slab = referee(&exact_medium, tau, how);
            let scene = viewed((tau, albedo, g), how, &VIEWS);
            let measured = of_maps(&scene, 2 * PHOTONS, 3, of_rays);
            for (moments, view) in measured.iter().zip(VIEWS) {
                let (part, mu, dphi) = view;
                let expected = blurred_across(&exact_slab, view, radius);
                let what = format!("depth {part} tau, mu {mu}, dphi {dphi:.3}, g {g}, {how:?}");
                verdict::agrees(&what, moments, (expected, 1e-5 * expected), promise * expected, 3);
            }
        }
    }
}

/// Published numbers of the quadrature: slab of one mean free path, albedo 0.9, isotropic, irradiance 1 along the normal; looking
/// in under a cosine of 0.5, at four radii, and of 0.2.
#[test]
fn blur_across_a_ray_by_quadrature() {
    let slab = referee(&medium(0.9, 0.0), 1.0, Incidence::Beam(1.0));
    for (mu, radius, expected) in [
        (0.5, 0.05, 0.092650725),
        (0.5, 0.1, 0.090417852),
        (0.5, 0.2, 0.086054367),
        (0.5, 0.4, 0.077770332),
        (0.2, 0.1, 0.104910070),
    ] {
        let found = blurred_across(&slab, (0.0, mu, 0.0), radius);
        assert!((found / expected - 1.0).abs() < 1e-6, "{mu} {radius}: {found}");
    }
}

/// Three channels, a hundred times as dense in one as in another: the march has to suit the thin one and the dense one at
/// once. Places by the mean extinction had brought a quarter of the radiance in the thin one, with an error bar to suit.
#[test]
fn radiance_of_photon_maps_in_colours() {
    let (thickness, albedo, g) = (3.0, [0.9, 0.8, 0.7], 0.3);
    let sigma_t = [0.1, 1.0, 10.0];
    let views = [(0.1, 0.0, 0.25 * PI), (0.1, 0.5, PI / 3.0), (0.0, 0.3, PI)];
    let medium_of = homogeneous(Spectrum(sigma_t.into()), Spectrum(albedo.into()), g);
    let coloured = Region { shape: layer(thickness), medium: medium_of };
    let how = Incidence::Beam(0.5);
    let scene = layered(coloured, how, views.iter().map(|view| looking(thickness, *view)));
    let measured = of_maps(&scene, 4 * PHOTONS, 3, in_balls());
    assert_eq!(measured.len(), 9);
    for (index, moments) in measured.iter().enumerate() {
        let (view, channel) = (views[index / 3], index % 3);
        let tau = sigma_t[channel] * thickness;
        let exact_slab = referee(&medium(albedo[channel], g), tau, how);
        let expected = blurred(&exact_slab, view, sigma_t[channel] * RADIUS);
        let what = format!("channel {channel}, depth {} tau, mu {}", view.0, view.1);
        verdict::agrees(&what, moments, (expected, 1e-5 * expected), 0.08 * expected, 3);
    }
}
