//! Light that fills volumes: densities of directions towards it, and what paths make of them.

use crate::checks::emitters::a_furnace_is_as_bright_everywhere;
use crate::support::quadrature::integrate;
use crate::support::run::{histories, numbers, paths};
use crate::support::scenes::{bounded, cuboid, lambertian, rectangle, region, sphere, volume_source};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Spectrum;
use turbid::geometry::Shape;
use turbid::integrators::{Guides, radiance};
use turbid::light::{Light, MediumEmission, VolumeSource};
use turbid::math::{FOUR_PI, Ray, exp, exp_m1, warp};
use turbid::medium::{Cloud, CloudShape, Density, Heterogeneous, Homogeneous};
use turbid::phase::{Isotropic, Phase};
use turbid::rng::Stream;
use turbid::scene::{Orders, Quantity, Region, Scene};
use turbid::surface::Surface;

const N: u64 = 1 << 16;

fn absorber(sigma_t: f64, albedo: f64) -> Homogeneous {
    Homogeneous::new(Spectrum::grey(sigma_t), Spectrum::grey(albedo), Phase::Isotropic(Isotropic)).unwrap()
}

fn glowing(shape: Shape, sigma_t: f64, albedo: f64) -> Region {
    Region { shape, medium: absorber(sigma_t, albedo).with_emission(Spectrum::ONE).unwrap().into() }
}

fn cloud(center: DVec3) -> Region {
    let cloud = Cloud::new(CloudShape::plain(center, DVec3::new(0.5, 0.4, 0.6))).unwrap();
    let medium = Heterogeneous::new(absorber(3.0, 0.5), Density::Cloud(cloud.into()));
    let shape = cuboid(center - DVec3::splat(0.8), center + DVec3::splat(0.8));
    Region { shape, medium: medium.with_emission_by_density(Spectrum::rgb(1.0, 0.5, 2.0)).unwrap().into() }
}

fn emission_of(scene: &Scene) -> &MediumEmission {
    match &scene.lights()[0] {
        Light::MediumEmission(medium) => medium,
        light => panic!("no medium: {light:?}"),
    }
}

/// Uniform directions weighted by a density: it integrates to 1, and has the mean direction of its sampler.
fn is_a_density(
    what: &str,
    p: DVec3,
    pdf: impl Fn(&Ray) -> f64 + Sync,
    sample: impl Fn(&mut Stream) -> DVec3 + Sync,
) {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    let uniform = histories(4 * N, 61, |s| {
        let dir = warp::square_to_sphere(s.pair()).normalize();
        let weight = FOUR_PI * pdf(&Ray::new(p, dir));
        Spectrum::rgb(weight, weight * (1.0 + dir.dot(axis)), 0.0)
    });
    verdict::agrees(&format!("{what} from {p}"), &uniform[0], (1.0, 1e-12), 0.15, 61);
    let sampled = numbers(4 * N, 62, |s| 1.0 + sample(s).dot(axis));
    verdict::agree(&format!("{what} from {p}, mean direction"), &uniform[1], &sampled, 0.3, 61);
}

#[test]
fn directions_towards_volumes_have_their_density() {
    let places = [DVec3::new(2.0, 0.4, -0.3), DVec3::new(0.6, -1.3, 0.9), DVec3::new(-0.95, 0.2, 0.9)];
    let shapes = [sphere(DVec3::ZERO, 0.9), cuboid(DVec3::new(-0.8, -0.6, -0.9), DVec3::new(0.5, 0.7, 0.8))];
    for p in places {
        for (i, shape) in shapes.iter().enumerate() {
            let source = VolumeSource::new(shape.clone(), Spectrum::ONE).unwrap();
            let aimed = |s: &mut Stream| source.sample(p, s.triple()).unwrap().dir;
            is_a_density(&format!("shape {i}"), p, |ray| source.pdf_solid_angle(ray), aimed);
        }
        let scene = bounded(vec![cloud(DVec3::ZERO)], Vec::new(), Vec::new());
        let medium = emission_of(&scene);
        let aimed = |s: &mut Stream| medium.sample(p, s.triple()).unwrap();
        is_a_density("cloud", p, |ray| medium.pdf_solid_angle(ray), aimed);
    }
    // The negative control takes the length inside for the integral of squared distances.
    let (p, shape) = (places[0], &shapes[1]);
    let wrong = numbers(N, 63, |s| {
        let ray = Ray::new(p, warp::square_to_sphere(s.pair()).normalize());
        FOUR_PI * p.length_squared() * shape.interval(&ray).map_or(0.0, |i| i.length()) / shape.volume()
    });
    verdict::rejects("length for squared distances", &wrong, 1.0, 63);
    // Nowhere from inside: there chance is as good.
    let source = VolumeSource::new(shape.clone(), Spectrum::ONE).unwrap();
    assert!(source.sample(DVec3::ZERO, [0.5; 3]).is_none());
    assert_eq!(source.pdf_solid_angle(&Ray::new(DVec3::ZERO, DVec3::X)), 0.0);
}

/// Fluence beside a ball that emits 1 and absorbs, and radiance of a floor under it, for which the ball's disc is integrated: the
/// light of a chord c is (1 - e^-c), extinction 1. The same from a medium and from a volume source in one that does not emit.
#[test]
fn a_glowing_ball_is_seen_from_beside() {
    let (d, rho) = (1.5_f64, 0.7);
    let widest = 1.0 - (1.0 - 1.0 / (d * d)).sqrt();
    let disc = |f: &dyn Fn(f64) -> f64| {
        2.0 * PI
            * integrate(0.0, 1.0, 8, |u| {
                // 1 - mu = widest (1 - u^2): the chord is smooth in u at the rim.
                let one_minus_mu = widest * (1.0 - u * u);
                let sine2 = one_minus_mu * (2.0 - one_minus_mu);
                let chord = 2.0 * (1.0 - d * d * sine2).max(0.0).sqrt();
                -exp_m1(-chord) * f(1.0 - one_minus_mu) * 2.0 * widest * u
            })
    };
    let (fluence, irradiance) = (disc(&|_| 1.0), disc(&|mu| mu));
    let ball = sphere(DVec3::Z * d, 1.0);
    let source = VolumeSource::new(ball.clone(), Spectrum::grey(FOUR_PI)).unwrap();
    let emitters = [
        (vec![glowing(ball.clone(), 1.0, 0.0)], Vec::new()),
        (vec![region(ball, 1.0, 0.0, 0.0)], vec![Light::VolumeSource(source)]),
    ];
    let floor = || {
        let floor = rectangle(DVec3::new(-9.0, -9.0, 0.0), DVec3::X * 18.0, DVec3::Y * 18.0);
        vec![(Shape::Rectangle(floor), lambertian(Spectrum::grey(rho)))]
    };
    for (i, (regions, lights)) in emitters.into_iter().enumerate() {
        let seed = 64 + i as u64;
        let open = bounded(regions.clone(), Vec::new(), lights.clone());
        let seen = paths(&open, Quantity::Fluence(DVec3::ZERO), Orders::ALL, N, seed);
        verdict::agrees(&format!("fluence, {i}"), &seen[0], (fluence, 1e-9), 0.02 * fluence, seed);
        let lit = bounded(regions, floor(), lights);
        let eye = DVec3::new(-3.0, 0.0, 0.5);
        let seen = paths(&lit, Quantity::Radiance(Ray::new(eye, (-eye).normalize())), Orders::ALL, N, seed);
        let radiance = rho * irradiance / PI;
        verdict::agrees(&format!("floor, {i}"), &seen[0], (radiance, 1e-9), 0.02 * radiance, seed);
    }
}

/// Light of a cloud and of two balls, one in the other, found by chance alone and by both ways together, at a point and on a floor,
/// through a filter, in fog: the same mean, and less than half of the variance.
#[test]
fn chance_alone_finds_the_same_light() {
    let ball = |x: f64, r: f64| glowing(sphere(DVec3::new(x, 0.0, 2.0), r), 0.8, 0.0);
    let regions = vec![
        region(sphere(DVec3::ZERO, 6.0), 0.2, 0.0, 0.0),
        ball(1.0, 0.5),
        ball(1.2, 0.2),
        cloud(DVec3::new(-1.0, 1.0, 1.5)),
    ];
    let pane = rectangle(DVec3::new(-4.0, -4.0, 0.7), DVec3::X * 4.8, DVec3::Y * 8.0);
    let pane = (
        Shape::Rectangle(pane),
        Surface::Filter(turbid::surface::Filter::new(Spectrum::rgb(0.9, 0.5, 0.7)).unwrap()),
    );
    let floor = Shape::Rectangle(rectangle(DVec3::new(-4.0, -4.0, 0.0), DVec3::X * 8.0, DVec3::Y * 8.0));
    let far = volume_source(cuboid(DVec3::new(2.0, 2.0, 1.0), DVec3::new(2.5, 2.6, 1.4)));
    let scene = bounded(regions, vec![pane, (floor, lambertian(Spectrum::ONE))], vec![far]);
    let by_chance = |p: DVec3, dir: DVec3, s: &mut Stream| {
        let mut sum = Spectrum::ZERO;
        radiance(&scene, (Ray::new(p, dir), 0), Orders::only(0), Guides::default(), s, |_, value| {
            sum += value
        });
        sum
    };
    let point = DVec3::new(0.3, -0.5, 0.4);
    let chance = histories(4 * N, 66, |s| {
        let dir = warp::square_to_sphere(s.pair()).normalize();
        by_chance(point, dir, s) * FOUR_PI
    });
    let both = paths(&scene, Quantity::Fluence(point), Orders::only(0), N, 67);
    // On the floor: what the eye sees through fog of extinction 0.2 is the mean over the cosine.
    let eye = DVec3::new(0.0, -1.0, 0.5);
    let at = DVec3::new(0.2, 0.1, 0.0);
    let on_floor = histories(4 * N, 68, |s| {
        by_chance(at + DVec3::Z * 1e-12, warp::square_to_cosine_hemisphere(s.pair()).normalize(), s)
            * exp(-0.2 * eye.distance(at))
    });
    let seen =
        paths(&scene, Quantity::Radiance(Ray::new(eye, (at - eye).normalize())), Orders::only(1), N, 69);
    for c in 0..3 {
        verdict::agree(&format!("point, channel {c}"), &chance[c], &both[c], 0.1 * both[c].mean(), 66);
        verdict::agree(&format!("floor, channel {c}"), &on_floor[c], &seen[c], 0.1 * seen[c].mean(), 68);
        assert!(
            both[c].variance() < 0.5 * chance[c].variance()
                && seen[c].variance() < 0.5 * on_floor[c].variance()
        );
    }
}

#[test]
fn furnace() {
    a_furnace_is_as_bright_everywhere();
}
