//! Surfaces and the ways to find a light: view factors, spherical cavities, mirrors.

use crate::support::run::{paths, tallies};
use crate::support::scenes::{bounded, emitting_sphere, lambertian, outflow, point_light, rectangle, sphere};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::math::FOUR_PI;
use turbid::scene::{Orders, Quantity};
use turbid::surface::{Mirror, Surface};

const N: u64 = 90_000;

#[test]
fn irradiance_under_an_area_light() {
    crate::checks::light::irradiance_under_an_area_light();
}

/// Lambertian sphere of radius a about a point light anywhere inside, of power 1: the irradiance is the direct one plus
/// rho/(1-rho) times its mean 1/(4 pi a^2), and the fluence at the centre is the direct one plus 4 rho E-mean.
#[test]
fn a_diffuse_cavity_has_its_known_radiosity() {
    let (radius, rho) = (2.0, Spectrum::rgb(0.7, 0.2, 0.0));
    let wall = sphere(DVec3::ZERO, radius);
    for offset in [0.4, 1.2] {
        let light = point_light(DVec3::new(offset, 0.0, 0.0), Spectrum::ONE);
        let scene = bounded(Vec::new(), vec![(wall.clone(), lambertian(rho))], vec![light]);
        let mean_direct = 1.0 / (FOUR_PI * radius * radius);
        let fluence = paths(&scene, Quantity::Fluence(DVec3::ZERO), Orders::ALL, N, 4);
        let inner = outflow(sphere(DVec3::ZERO, 0.2));
        let crossing = tallies(&scene, &[(inner.clone(), Orders::SCATTERED)], N, 4);
        let by_paths = paths(&scene, inner, Orders::SCATTERED, N, 5);
        for c in 0..3 {
            let direct = 1.0 / (FOUR_PI * offset * offset);
            let expected = direct + 4.0 * rho[c] * mean_direct / (1.0 - rho[c]);
            verdict::agrees(
                &format!("fluence, light at {offset}, channel {c}"),
                &fluence[c],
                (expected, 1e-13),
                0.02 * expected,
                4,
            );
            let what = format!("through an inner sphere, light at {offset}, channel {c}");
            verdict::agree(&what, &crossing[0][c], &by_paths[c], 0.01, 5);
            if rho[c] == 0.0 {
                assert_eq!(crossing[0][c].mean(), 0.0);
            }
        }
    }
}

/// A mirror doubles a light: fluence above it is radiance times both solid angles, the image's times the reflectance.
#[test]
fn a_mirror_shows_the_image() {
    let mirror =
        Shape::Rectangle(rectangle(DVec3::new(-50.0, -50.0, 0.0), DVec3::X * 100.0, DVec3::Y * 100.0));
    let rho = Spectrum::rgb(1.0, 0.5, 0.0);
    let light = emitting_sphere(DVec3::new(1.0, 0.0, 1.0), 0.5);
    let surface = Surface::Mirror(Mirror::new(rho).unwrap());
    let scene = bounded(Vec::new(), vec![(mirror, surface)], vec![light]);
    let p = DVec3::new(-1.0, 0.5, 0.7);
    let solid_angle = |center: DVec3| {
        let sin2 = 0.25 / p.distance_squared(center);
        2.0 * PI * sin2 / (1.0 + (1.0 - sin2).sqrt())
    };
    let radiance = 1.0 / (PI * FOUR_PI * 0.25);
    let moments = paths(&scene, Quantity::Fluence(p), Orders::ALL, 1 << 20, 7);
    for c in 0..3 {
        let expected = radiance
            * (solid_angle(DVec3::new(1.0, 0.0, 1.0)) + rho[c] * solid_angle(DVec3::new(1.0, 0.0, -1.0)));
        verdict::agrees(&format!("fluence, channel {c}"), &moments[c], (expected, 1e-13), 0.1 * expected, 7);
    }
    let test_sphere = outflow(sphere(p, 0.3));
    let by_photons = tallies(&scene, &[(test_sphere.clone(), Orders::ALL)], 1 << 20, 8);
    let by_paths = paths(&scene, test_sphere, Orders::ALL, 1 << 20, 8);
    for c in 0..3 {
        verdict::agree(&format!("through a sphere, channel {c}"), &by_photons[0][c], &by_paths[c], 0.003, 8);
    }
}
