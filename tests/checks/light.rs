//! Lights and surfaces: one light in two ways, one emitter in two forms, the cosine.

use crate::support::run::{numbers, paths, tallies};
use crate::support::scenes::{area_light, bounded, outflow, rectangle};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::light::Light;
use turbid::math::{Ray, atan2, warp};
use turbid::scene::{Orders, Quantity};
use turbid::surface::{Lambertian, Surface};

/// The share of a light's power that crosses a box: photons against paths.
pub fn photons_and_paths_cross_a_box_alike(name: &str, light: Light, shape: Shape, paths_run: u64) {
    let scene = bounded(Vec::new(), Vec::new(), vec![light]);
    let by_photons = tallies(&scene, &[(outflow(shape.clone()), Orders::ALL)], 1 << 17, 2);
    let by_paths = paths(&scene, outflow(shape), Orders::ALL, paths_run, 3);
    for c in 0..3 {
        let what = format!("{name}, channel {c}");
        verdict::agree(&what, &by_photons[0][c], &by_paths[c], 0.06, 2);
    }
}

/// View factor from a horizontal element to a parallel rectangle at height h, a corner of it straight above
/// (Howell, Menguc and Siegel, configuration factor B-4).
fn corner_view_factor(a: f64, b: f64, h: f64) -> f64 {
    let (x, y) = (a / h, b / h);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / rx * atan2(y, rx) + y / ry * atan2(x, ry)) / (2.0 * PI)
}

/// Irradiance under a rectangular light, over every way to sample it: aimed at, met by chance, and both together in
/// the path tracer, each against the view factor.
pub fn irradiance_under_an_area_light() {
    const N: u64 = 1 << 18;
    let light =
        area_light(rectangle(DVec3::new(-0.5, 1.5, 1.0), DVec3::X * 2.0, -DVec3::Y * 2.0), Spectrum::ONE);
    let expected: f64 = [(0.5, 0.5), (1.5, 0.5), (0.5, 1.5), (1.5, 1.5)]
        .iter()
        .map(|(a, b)| corner_view_factor(*a, *b, 1.0))
        .sum::<f64>()
        * PI;
    let aimed = numbers(N, 1, |s| light.sample(DVec3::ZERO, s.pair()).map_or(0.0, |l| l.value[0] * l.dir.z));
    verdict::agrees("aimed", &aimed, (expected, 1e-14), 0.02 * expected, 1);
    let met = numbers(N, 2, |s| {
        let ray = Ray::new(DVec3::ZERO, warp::square_to_cosine_hemisphere(s.pair()));
        PI * light.hit(&ray, None).map_or(0.0, |hit| light.emitted(&ray, &hit).0[0])
    });
    verdict::agrees("met", &met, (expected, 1e-14), 0.03 * expected, 2);
    // The path tracer sees the floor from the side: radiance rho E / pi.
    let floor = Shape::Rectangle(rectangle(DVec3::new(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0));
    let rho = Spectrum::rgb(0.5, 1.0, 0.2);
    let diffuse = Surface::Lambertian(Lambertian::new(rho).unwrap());
    let scene = bounded(Vec::new(), vec![(floor, diffuse)], vec![light]);
    let eye = DVec3::new(-2.0, 0.0, 0.5);
    let seen = paths(&scene, Quantity::Radiance(Ray::new(eye, (-eye).normalize())), Orders::ALL, N, 3);
    for c in 0..3 {
        let value = rho[c] * expected / PI;
        verdict::agrees(&format!("path tracer, channel {c}"), &seen[c], (value, 1e-14), 0.02 * value, 3);
        // Counting both ways in full, without sharing, is the negative control.
        verdict::rejects(&format!("both in full, channel {c}"), &seen[c], 2.0 * value, 3);
    }
}

/// The solid angle of a rectangle seen from above a corner at height h: atan(a b / (h sqrt(a^2 + b^2 + h^2))).
pub fn corner_solid_angle(a: f64, b: f64, h: f64) -> f64 {
    atan2(a * b, h * (a * a + b * b + h * h).sqrt())
}

/// A square light of area 1, whole and as four quarters: the fluence under its centre is its radiance times its solid
/// angle, by paths that aim at it and meet it.
pub fn a_light_is_the_sum_of_its_quarters() {
    let (height, radiance) = (0.5, Spectrum::ONE);
    let expected = 4.0 * corner_solid_angle(0.5, 0.5, height);
    // The front faces down: its edges are x and -y.
    let part = |x: f64, y: f64, side: f64| {
        let corner = DVec3::new(x, y + side, height);
        area_light(rectangle(corner, DVec3::X * side, -DVec3::Y * side), radiance)
    };
    let quarters = [(-0.5, -0.5), (0.0, -0.5), (-0.5, 0.0), (0.0, 0.0)].map(|(x, y)| part(x, y, 0.5));
    for (name, lights) in [("whole", vec![part(-0.5, -0.5, 1.0)]), ("quarters", quarters.to_vec())] {
        let scene = bounded(Vec::new(), Vec::new(), lights);
        let fluence = paths(&scene, Quantity::Fluence(DVec3::ZERO), Orders::ALL, 1 << 16, 4)[0];
        verdict::agrees(name, &fluence, (expected, 1e-13), 0.02 * expected, 4);
    }
}
