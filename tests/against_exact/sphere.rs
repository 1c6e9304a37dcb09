//! The sphere: escape, absorption and fluence for a uniform source, a point at the centre, and isotropic incidence.

use crate::checks::slab::exact;
use crate::support::run::{paths, tallies};
use crate::support::scenes::{
    ball, bounded, emitting_sphere, homogeneous, isotropic, outflow, point_light, region, sphere,
    volume_source,
};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::light::{Faces, Light};
use turbid::scene::{Orders, Quantity, Region};
use turbid_analytic::{Sphere, SphereSource};

const PHOTONS: u64 = 1 << 18;
const PATHS: u64 = 1 << 16;

pub fn at(r: f64) -> Quantity {
    Quantity::Fluence(DVec3::new(0.0, r, 0.0))
}

pub fn body(radius: f64) -> turbid::geometry::Shape {
    sphere(DVec3::ZERO, radius)
}

fn center(power: f64) -> Light {
    point_light(DVec3::ZERO, Spectrum::grey(power))
}

/// The exact ball.
pub fn referee(radius: f64, albedo: f64, source: SphereSource) -> Sphere {
    Sphere::new(radius, albedo, source).unwrap()
}

/// The light of one source.
pub fn light_of(source: SphereSource, radius: f64) -> Light {
    match source {
        SphereSource::Uniform => volume_source(body(radius)),
        SphereSource::Centre => center(1.0),
        SphereSource::Incident => isotropic(body(radius), Faces::Both),
    }
}

pub const SOURCES: [SphereSource; 3] = [SphereSource::Uniform, SphereSource::Centre, SphereSource::Incident];

#[test]
fn escape_and_absorption() {
    for (radius, albedo) in [(0.5, 1.0), (1.0, 0.9), (5.0, 0.99), (2.0, 0.0), (0.1, 0.0)] {
        for source in SOURCES {
            let exact_ball = referee(radius, albedo, source);
            let scene = ball(radius, albedo, 0.0, light_of(source, radius));
            let quantities = [
                ("escape", outflow(body(radius)), exact_ball.escape()),
                ("absorbed", Quantity::Absorbed(0), exact_ball.absorptance()),
            ];
            let photons =
                tallies(&scene, &quantities.clone().map(|(_, q, _)| (q, Orders::ALL)), PHOTONS / 3 * 2, 1);
            for ((name, quantity, value), photons) in quantities.into_iter().zip(photons) {
                let what = format!("{name}, {source:?}, radius {radius}, albedo {albedo}");
                verdict::agrees(&format!("photons: {what}"), &photons[0], exact(value), 0.01, 1);
                // Near a point light fluence grows as 1/r^2: its volume mean by random points has no variance, and rays
                // past it have one that diverges, if only as a logarithm. Photons have neither trouble.
                if source != SphereSource::Centre {
                    let by_paths = paths(&scene, quantity, Orders::ALL, PATHS / 3 * 2, 1)[0];
                    verdict::agrees(&format!("paths: {what}"), &by_paths, exact(value), 0.04, 1);
                }
            }
        }
    }
}

#[test]
fn fluence_inside() {
    for albedo in [0.9, 0.5] {
        for source in SOURCES {
            let exact_ball = referee(1.0, albedo, source);
            let scene = ball(1.0, albedo, 0.0, light_of(source, 1.0));
            for r in [0.25, 0.5, 0.9, 1.0] {
                let value = exact_ball.fluence(r).unwrap();
                let moments = paths(&scene, at(r), Orders::ALL, PATHS, 2)[0];
                let what = format!("{source:?}, at {r}, albedo {albedo}");
                verdict::agrees(&what, &moments, exact(value), 0.1 * value.value, 2);
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
    for source in [SphereSource::Uniform, SphereSource::Centre] {
        let light = light_of(source, 1.0);
        let scene =
            bounded(vec![Region { shape: body.clone(), medium: medium.clone() }], Vec::new(), vec![light]);
        let quantities = [(outflow(body.clone()), Orders::ALL), (Quantity::Absorbed(0), Orders::ALL)];
        let photons = tallies(&scene, &quantities, 1 << 18, 3);
        let by_paths = quantities.map(|(q, orders)| paths(&scene, q, orders, 1 << 16, 3));
        for c in 0..3 {
            let exact_ball = referee(sigma_t[c], albedo[c], source);
            for (i, value) in [exact_ball.escape(), exact_ball.absorptance()].into_iter().enumerate() {
                let what = format!("{source:?}, {}, channel {c}", ["escape", "absorbed"][i]);
                verdict::agrees(&format!("photons: {what}"), &photons[i][c], exact(value), 0.02, 3);
                if source == SphereSource::Uniform {
                    verdict::agrees(&format!("paths: {what}"), &by_paths[i][c], exact(value), 0.03, 3);
                }
            }
        }
    }
    let scene = bounded(vec![Region { shape: body, medium }], Vec::new(), vec![center(1.0)]);
    let fluence = paths(&scene, at(0.5), Orders::ALL, 1 << 17, 4);
    for c in 0..3 {
        // Fluence in powers per squared mean free path: a factor sigma_t^2.
        let exact_ball = referee(sigma_t[c], albedo[c], SphereSource::Centre);
        let (value, error) = exact(exact_ball.fluence(0.5 * sigma_t[c]).unwrap());
        let area = sigma_t[c] * sigma_t[c];
        verdict::agrees(&format!("fluence, channel {c}"), &fluence[c], (value * area, error * area), 0.05, 4);
    }
}

/// Where regions overlap, absorption is counted in the later one only, by paths as by photons.
#[test]
fn absorption_is_counted_where_the_medium_is() {
    let (outer, inner) = (body(1.0), body(0.7));
    let regions = vec![region(outer.clone(), 1.0, 0.2, 0.0), region(inner, 0.5, 0.8, 0.0)];
    let scene = bounded(regions, Vec::new(), vec![isotropic(outer.clone(), Faces::Both)]);
    let quantities = [Quantity::Absorbed(0), Quantity::Absorbed(1), outflow(outer)];
    let photons = tallies(&scene, &quantities.clone().map(|q| (q, Orders::ALL)), PHOTONS, 5);
    for (i, quantity) in quantities.into_iter().enumerate() {
        let by_paths = paths(&scene, quantity.clone(), Orders::ALL, PATHS, 5)[0];
        verdict::agree(&format!("{quantity:?}"), &photons[i][0], &by_paths, 0.03, 5);
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
    let together = tallies(
        &fog(lights.to_vec()),
        &[(quantity.clone(), Orders::ALL), (absorbed.clone(), Orders::ALL)],
        PHOTONS / 16,
        8,
    );
    for (i, q) in [quantity, absorbed].into_iter().enumerate() {
        let expected: Vec<_> = lights
            .iter()
            .map(|l| paths(&fog(vec![l.clone()]), q.clone(), Orders::ALL, 1 << 14, 9)[0])
            .collect();
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
