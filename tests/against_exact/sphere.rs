//! The sphere: escape, absorption and fluence for a uniform source, a point at the centre, and isotropic incidence.

use crate::reference::{Reference, sphere as row};
use crate::support::run::{numbers, paths, tallies};
use crate::support::scenes::{
    ball, bounded, emitting_sphere, homogeneous, isotropic, outflow, point_light, region, sphere,
    volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::light::{Faces, Light};
use turbid::math::{FOUR_PI, exp, exp_m1};
use turbid::scene::{Orders, Quantity, Region};

const PHOTONS: u64 = 1 << 18;
const PATHS: u64 = 1 << 16;

fn at(r: f64) -> Quantity {
    Quantity::Fluence(DVec3::new(0.0, r, 0.0))
}

fn body(radius: f64) -> turbid::geometry::Shape {
    sphere(DVec3::ZERO, radius)
}

fn center(power: f64) -> Light {
    point_light(DVec3::ZERO, Spectrum::grey(power))
}

/// Photons and paths: escape and absorption of one light.
fn balance(what: &str, radius: f64, albedo: f64, light: Light, (escape, error): Reference) {
    let scene = ball(radius, albedo, 0.0, light);
    let quantities = [(outflow(body(radius)), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)];
    let photons = tallies(&scene, &quantities, PHOTONS, 1);
    for (i, (name, value)) in [("escape", escape), ("absorbed", 1.0 - escape)].into_iter().enumerate() {
        let what = format!("{name}, {what}, radius {radius}, albedo {albedo}");
        verdict::agrees(&format!("photons: {what}"), &photons[i][0], (value, error + 1e-14), 0.01, 1);
        // Near a point light fluence grows as 1/r^2: its volume mean by random points has no variance, and rays past it
        // have one that diverges, if only as a logarithm. Photons have neither trouble.
        if !matches!(light, Light::Point(_)) {
            let by_paths = paths(&scene, quantities[i].0, Orders::ALL, PATHS, 1)[0];
            verdict::agrees(&format!("paths: {what}"), &by_paths, (value, error + 1e-14), 0.04, 1);
        }
    }
}

#[test]
fn escape_and_absorption() {
    for (radius, albedo) in [(1.0, 0.9), (1.0, 0.5), (5.0, 0.99), (0.5, 1.0), (2.0, 0.0)] {
        balance(
            "uniform",
            radius,
            albedo,
            volume_source(body(radius)),
            row(radius, albedo, "escape_uniform_source", None),
        );
        balance("central", radius, albedo, center(1.0), row(radius, albedo, "escape_central_point", None));
        let (absorbed, error) = row(radius, albedo, "absorbed_incidence", None);
        balance("incidence", radius, albedo, isotropic(body(radius), Faces::Both), (1.0 - absorbed, error));
    }
}

/// Without scattering, closed forms: escape from a uniform source 3/(8a^3) [2a^2 - 1 + (1+2a) e^-2a], transmission of
/// isotropic light [1 - (1+2a) e^-2a]/(2a^2), of a point at the centre e^-a.
#[test]
fn escape_without_scattering() {
    for a in [0.1f64, 1.0, 3.0] {
        let tail = (1.0 + 2.0 * a) * exp(-2.0 * a);
        balance(
            "uniform",
            a,
            0.0,
            volume_source(body(a)),
            (3.0 / (8.0 * a * a * a) * (2.0 * a * a - 1.0 + tail), 1e-12),
        );
        balance("incidence", a, 0.0, isotropic(body(a), Faces::Both), ((1.0 - tail) / (2.0 * a * a), 1e-12));
        balance("central", a, 0.0, center(1.0), (exp(-a), 0.0));
    }
}

#[test]
fn fluence_inside() {
    for albedo in [0.9, 0.5] {
        for r in [0.25, 0.5, 0.9] {
            let lights = [
                ("fluence_uniform_source", volume_source(body(1.0)), 0.02),
                ("fluence_incidence", isotropic(body(1.0), Faces::Both), 0.1),
                ("fluence_central_point", center(1.0), 0.05),
            ];
            for (quantity, light, promise) in lights {
                let scene = ball(1.0, albedo, 0.0, light);
                let moments = paths(&scene, at(r), Orders::ALL, PATHS, 2)[0];
                verdict::agrees(
                    &format!("{quantity} at {r}, albedo {albedo}"),
                    &moments,
                    row(1.0, albedo, quantity, Some(r)),
                    promise,
                    2,
                );
            }
        }
    }
}

/// Three spheres in one: a medium whose optical radius and albedo differ by channel is three grey media. Flights by
/// channel, weights, colour roulette, absorbed powers and equiangular connections must each be right for that.
#[test]
fn a_coloured_sphere_is_three_grey_ones() {
    let (sigma_t, albedo) = (Spectrum::rgb(1.0, 0.5, 2.0), Spectrum::rgb(0.9, 1.0, 0.0));
    let body = body(1.0);
    let medium = homogeneous(sigma_t, albedo, 0.0);
    let lights = [("uniform_source", volume_source(body)), ("central_point", center(1.0))];
    for (name, light) in lights {
        let scene = bounded(vec![Region { shape: body, medium }], Vec::new(), vec![light]);
        let quantities = [(outflow(body), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)];
        let photons = tallies(&scene, &quantities, 1 << 20, 3);
        let by_paths = quantities.map(|(q, orders)| paths(&scene, q, orders, 1 << 18, 3));
        for c in 0..3 {
            let (escape, error) = row(sigma_t[c], albedo[c], &format!("escape_{name}"), None);
            for (i, value) in [escape, 1.0 - escape].into_iter().enumerate() {
                let what = format!("{name}, {}, channel {c}", ["escape", "absorbed"][i]);
                verdict::agrees(&format!("photons: {what}"), &photons[i][c], (value, error + 1e-14), 0.02, 3);
                if name == "uniform_source" {
                    verdict::agrees(
                        &format!("paths: {what}"),
                        &by_paths[i][c],
                        (value, error + 1e-14),
                        0.03,
                        3,
                    );
                }
            }
        }
    }
    let scene = bounded(vec![Region { shape: body, medium }], Vec::new(), vec![center(1.0)]);
    let fluence = paths(&scene, at(0.5), Orders::ALL, 1 << 18, 4);
    for c in 0..3 {
        // Fluence in powers per squared mean free path: a factor sigma_t^2.
        let (value, error) = row(sigma_t[c], albedo[c], "fluence_central_point", Some(0.5 * sigma_t[c]));
        let area = sigma_t[c] * sigma_t[c];
        verdict::agrees(&format!("fluence, channel {c}"), &fluence[c], (value * area, error * area), 0.05, 4);
    }
}

/// Where regions overlap, absorption is counted in the later one only, by paths as by photons.
#[test]
fn absorption_is_counted_where_the_medium_is() {
    let (outer, inner) = (body(1.0), body(0.7));
    let regions = vec![region(outer, 1.0, 0.2, 0.0), region(inner, 0.5, 0.8, 0.0)];
    let scene = bounded(regions, Vec::new(), vec![isotropic(outer, Faces::Both)]);
    let quantities = [Quantity::Absorbed(0), Quantity::Absorbed(1), outflow(outer)];
    let photons = tallies(&scene, &quantities.map(|q| (q, Orders::ALL)), PHOTONS, 5);
    for (i, quantity) in quantities.into_iter().enumerate() {
        let by_paths = paths(&scene, quantity, Orders::ALL, PATHS, 5)[0];
        verdict::agree(&format!("{quantity:?}"), &photons[i][0], &by_paths, 0.03, 5);
    }
}

/// A small emitting sphere in vacuum: fluence is radiance times solid angle; in fog, paths and photons agree.
#[test]
fn a_small_emitting_sphere() {
    let radius = 0.1;
    let scene = bounded(Vec::new(), Vec::new(), vec![emitting_sphere(DVec3::ZERO, radius)]);
    for d in [0.11, 0.5, 3.0] {
        let radiance = 1.0 / (std::f64::consts::PI * FOUR_PI * radius * radius);
        let sin2 = (radius / d) * (radius / d);
        let one_minus_mu = sin2 / (1.0 + (1.0 - sin2).sqrt());
        let expected = radiance * 2.0 * std::f64::consts::PI * one_minus_mu;
        let moments = paths(&scene, at(d), Orders::ALL, PATHS, 6)[0];
        verdict::agrees(&format!("distance {d}"), &moments, (expected, 1e-14 * expected), 0.1 * expected, 6);
    }
    let fog = ball(2.0, 0.9, 0.5, emitting_sphere(DVec3::new(0.3, 0.0, 0.0), 0.2));
    let photons =
        tallies(&fog, &[(outflow(body(2.0)), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)], PHOTONS, 7);
    for (i, quantity) in [outflow(body(2.0)), Quantity::Absorbed(0)].into_iter().enumerate() {
        let by_paths = paths(&fog, quantity, Orders::ALL, PATHS, 7)[0];
        verdict::agree(&format!("{quantity:?}"), &photons[i][0], &by_paths, 0.1, 7);
    }
}

/// Lights inside and outside a ball of fog add up: two lights of different powers are the sum of each.
#[test]
fn lights_add_up() {
    let outside = area();
    let lights = [center(0.3), emitting_sphere(DVec3::new(0.0, 0.0, 2.0), 0.5), outside];
    let quantity = outflow(body(1.0));
    let absorbed = Quantity::Absorbed(0);
    let powers = [0.3, 1.0, std::f64::consts::PI];
    let total: f64 = powers.iter().sum();
    let fog = |lights: Vec<Light>| bounded(vec![region(body(1.0), 1.0, 0.7, 0.3)], Vec::new(), lights);
    let together =
        tallies(&fog(lights.to_vec()), &[(quantity, Orders::ALL), (absorbed, Orders::ALL)], PHOTONS, 8);
    for (i, q) in [quantity, absorbed].into_iter().enumerate() {
        let expected: Vec<_> =
            lights.iter().map(|l| paths(&fog(vec![*l]), q, Orders::ALL, 1 << 18, 9)[0]).collect();
        let sum: f64 = expected.iter().zip(powers).map(|(m, p)| m.mean() * p / total).sum();
        let error: f64 =
            expected.iter().zip(powers).map(|(m, p)| (m.std_error() * p / total).powi(2)).sum::<f64>().sqrt();
        verdict::agrees(&format!("{q:?}"), &together[i][0], (sum, error), 0.05, 8);
    }
}

fn area() -> Light {
    let r = crate::support::scenes::rectangle(DVec3::new(-3.0, -0.5, -0.5), DVec3::Y, DVec3::Z);
    crate::support::scenes::area_light(r, Spectrum::ONE)
}

/// Equal chords: of isotropic light on a purely absorbing ball the mean of 1 - e^-L over chords is what is absorbed.
#[test]
fn absorption_is_the_mean_over_chords() {
    let scene = ball(1.5, 0.0, 0.0, isotropic(body(1.5), Faces::Both));
    let chords = numbers(PHOTONS, 10, |s| -exp_m1(-3.0 * s.unit().sqrt()));
    let photons = tallies(&scene, &[(Quantity::Absorbed(0), Orders::ALL)], PHOTONS, 10)[0][0];
    verdict::agree("absorbed", &photons, &chords, 0.01, 10);
}
