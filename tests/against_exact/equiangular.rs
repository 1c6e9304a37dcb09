//! A point light in fog: single scattering along a ray against its closed form, and intervals that can be trusted.
//!
//! Connections from free flights alone have an infinite variance: they are the negative control. A ray that passes
//! the light at a distance b sees it as 1/b; over all directions from a point that leaves a variance that diverges,
//! if only as a logarithm, so that intervals are promised for radiances and for lights with an extent.

use crate::checks::media::{layered, varying};
use crate::checks::point_light::{
    BESIDE, by_both, by_free_flight, fog, intervals_cover, ray, single_scattering,
};
use crate::support::quadrature::integrate;
use crate::support::run::{numbers, paths};
use crate::support::scenes::{bounded, cuboid, homogeneous, point_light};
use crate::support::verdict;
use glam::DVec3;
use turbid::Spectrum;
use turbid::light::{Light, Spot};
use turbid::math::{FOUR_PI, Ray, exp, sin_cos};
use turbid::medium::Density;
use turbid::scene::{Orders, Quantity, Region};

#[test]
fn intervals_cover_with_equal_angles_and_not_without() {
    intervals_cover(by_both);
    let alone = verdict::trial(|| intervals_cover(by_free_flight));
    assert!(alone.is_rejected() && alone.broken.is_some(), "free flights alone pass: {alone:?}");
    assert!(alone.worst().unwrap().z < -10.0, "{alone:?}");
}

/// Grey and in colour, thin (forced flights) and thick: the shares of the two ways to find the light add up to one. A
/// share that differed between them by channel weights would show here.
#[test]
fn single_scattering_is_the_integral() {
    let albedo = Spectrum::rgb(0.9, 0.5, 1.0);
    let cases = [
        Spectrum::ONE,
        Spectrum::rgb(0.2, 1.0, 5.0),
        Spectrum::rgb(8.0, 0.3, 0.1),
        Spectrum::grey(1e-3),
        Spectrum::rgb(1e-3, 1e-2, 3e-2),
    ];
    for sigma_t in cases {
        let scene = fog(sigma_t, albedo);
        let moments = paths(&scene, Quantity::Radiance(ray(BESIDE)), Orders::only(1), 1 << 16, 2);
        for c in 0..3 {
            let expected = single_scattering(sigma_t[c], albedo[c], BESIDE);
            verdict::agrees(
                &format!("sigma_t {}, channel {c}", sigma_t.0),
                &moments[c],
                (expected, 1e-12 * expected),
                0.02 * expected,
                2,
            );
        }
    }
    let scene = fog(Spectrum::ONE, Spectrum::grey(0.9));
    let twice = numbers(1 << 16, 3, |s| by_both(&scene, BESIDE, s) + by_free_flight(&scene, BESIDE, s));
    assert!(twice.mean() > 1.5 * single_scattering(1.0, 0.9, BESIDE), "both in full must differ");
}

/// Two layers some way from the lamp at the origin: one whose density rises, or which is the same everywhere, and behind
/// it one of its own colour.
fn layers(density: Option<Density>) -> [Region; 2] {
    let wide = |low: f64, high: f64| (DVec3::new(-9.0, -9.0, low), DVec3::new(9.0, 9.0, high));
    let (near, far) = (wide(1.0, 2.0), wide(2.0, 3.5));
    let medium = match density {
        Some(density) => varying(NEAR, ALBEDO, density),
        None => homogeneous(NEAR, Spectrum::grey(ALBEDO), 0.0),
    };
    [
        Region { shape: cuboid(near.0, near.1), medium },
        Region { shape: cuboid(far.0, far.1), medium: homogeneous(FAR, Spectrum::grey(ALBEDO), 0.0) },
    ]
}

/// Extinction of the layers where the density is 1.
const NEAR: Spectrum = Spectrum(DVec3::new(1.5, 0.7, 1.0));
const FAR: Spectrum = Spectrum(DVec3::new(0.3, 1.0, 3.0));
const ALBEDO: f64 = 0.9;

/// A lamp and a sensor in one place, rays that start ever so closely beside the lamp, that point straight at it, and that
/// pass it closely: the medium begins some way off, so that all of them are finite.
///
/// At height z, past the lamp at a distance x, sigma_s e^(-depth) / (16 pi^2 r^2), the depth of both ways being those of the
/// height times their slants.
#[test]
fn rays_through_the_lamp_itself() {
    let rising = |z: f64| 0.2 + 1.6 * (z - 1.0);
    let grid = layered((DVec3::new(-9.0, -9.0, 1.0), DVec3::new(9.0, 9.0, 2.0)), 16, rising);
    // A spot that is as bright in its cone, which holds all that the rays meet.
    let part = |degrees: f64| 1.0 - sin_cos(degrees.to_radians()).1;
    let power = Spectrum::grey(0.25 * (part(20.0) + part(40.0)));
    let spot = Light::Spot(Spot::new(DVec3::ZERO, DVec3::Z, (20.0, 40.0), power).unwrap());
    let point = point_light(DVec3::ZERO, Spectrum::ONE);
    for (name, lamp, density) in [
        ("point", &point, None),
        ("point", &point, Some(grid.clone())),
        ("spot", &spot, None),
        ("spot", &spot, Some(grid)),
    ] {
        let regions = layers(density.clone());
        let scene = bounded(regions.to_vec(), Vec::new(), vec![lamp.clone()]);
        assert_eq!(scene.plan().has_heterogeneous, density.is_some());
        let up = Ray::new(DVec3::ZERO, DVec3::Z);
        // Depth straight from the lamp to a height, and extinction there.
        let depth = |z: f64| scene.optical_depth(&up, z, 0);
        let sigma_t = |z: f64| regions[usize::from(z > 2.0)].medium.sigma_t(DVec3::new(0.0, 0.0, z));
        let aslant = DVec3::new(0.2, 0.1, 1.0).normalize();
        let cases = [
            (DVec3::ZERO, DVec3::Z),
            (DVec3::ZERO, aslant),
            (DVec3::new(1e-300, 0.0, 0.0), DVec3::Z),
            (DVec3::new(1e-16, 0.0, 0.0), DVec3::Z),
            (DVec3::new(1e-9, 0.0, 0.0), DVec3::Z),
            (DVec3::new(0.1, 0.0, 0.0), DVec3::Z),
            (DVec3::new(0.0, 0.0, 5.0), -DVec3::Z),
            (5.0 * aslant, -aslant),
            (DVec3::new(1e-5, 0.0, 5.0), -DVec3::Z),
            (DVec3::new(0.0, 0.0, -1.0), DVec3::Z),
        ];
        for (origin, dir) in cases {
            let ray = Ray::new(origin, dir);
            let got = paths(&scene, Quantity::Radiance(ray), Orders::only(1), 6000, 4);
            for (c, got) in got.iter().enumerate() {
                let of = |z: f64| {
                    let t = (z - origin.z) / dir.z;
                    let r = ray.at(t).length();
                    let seen = (depth(z)[c] - depth(origin.z.max(0.0))[c]).abs() / dir.z.abs();
                    let lit = depth(z)[c] * r / z;
                    sigma_t(z)[c] * exp(-seen - lit) / (r * r) / dir.z.abs()
                };
                // The grid's cells are a sixteenth high, its lines break in their middles.
                let sum = integrate(1.0, 2.0, 32, of) + integrate(2.0, 3.5, 16, of);
                let expected = ALBEDO / (FOUR_PI * FOUR_PI) * sum;
                let varies = density.is_some();
                let what = format!("{name}, from {origin} along {dir}, varying {varies}, channel {c}");
                verdict::agrees(&what, got, (expected, 1e-9 * expected), 0.1 * expected, 4);
            }
        }
    }
}

/// Rays across a spot's cone, along it, near its edge, towards the lamp and away from it, cones from a quarter of a degree to
/// wider than a half space: light scattered once is the integral over all of the ray.
#[test]
fn rays_across_the_cone_of_a_spot() {
    let (sigma_t, albedo) = (0.7, 0.9);
    let (low, high) = (DVec3::splat(-3.0), DVec3::splat(3.0));
    let fog = Region {
        shape: cuboid(low, high),
        medium: homogeneous(Spectrum::grey(sigma_t), Spectrum::grey(albedo), 0.0),
    };
    // Samples of the same numbers would err to the same side everywhere.
    let mut seed = 0;
    for edge in [0.25, 5.0, 30.0, 80.0, 90.0, 130.0] {
        let spot = Spot::new(DVec3::ZERO, DVec3::Z, (0.6 * edge, edge), Spectrum::ONE).unwrap();
        let scene = bounded(vec![fog.clone()], Vec::new(), vec![Light::Spot(spot)]);
        // Widths across the cone at height 1; beyond 60 degrees those of 60.
        let width = sin_cos(f64::min(edge, 60.0).to_radians()).0;
        let aslant = DVec3::new(0.8, 0.1, 0.6).normalize();
        let cases = [
            (DVec3::new(-2.5, 0.3 * width, 1.0), DVec3::X),
            (DVec3::new(-2.5, 0.0, 0.2), DVec3::X),
            (DVec3::new(0.7 * width, 0.2 * width, 2.5), -DVec3::Z),
            (DVec3::new(0.4 * width, -0.1 * width, -2.5), DVec3::Z),
            (DVec3::new(0.5 * width, 0.0, 1.0) - 2.0 * aslant, aslant),
            (DVec3::new(0.2 * width, 0.1 * width, 1.0), aslant),
        ];
        for (origin, dir) in cases {
            let ray = Ray::new(origin, dir);
            let end = scene.segments(&ray, f64::INFINITY, 0).iter().last().unwrap().interval.end;
            let of = |t: f64| {
                let p = ray.at(t);
                let r = p.length();
                sigma_t * albedo / FOUR_PI * exp(-sigma_t * (t + r)) * spot.intensity(p / r)[0] / (r * r)
            };
            // The finest detail is where a narrow cone is crossed.
            let expected = integrate(0.0, end, 5_000, of);
            seed += 1;
            let got = paths(&scene, Quantity::Radiance(ray), Orders::only(1), 1 << 14, seed);
            let what = format!("cone of {edge} degrees, from {origin} along {dir}");
            verdict::agrees(&what, &got[0], (expected, 1e-6 * expected), 0.1 * expected, seed);
        }
    }
}
