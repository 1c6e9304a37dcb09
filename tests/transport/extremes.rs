//! Extremes: thin and thick, white and black, grazing, peaked, empty; every number stays finite and right.

use crate::support::run::{pass, paths};
use crate::support::scenes::{
    self, CELL, Incidence, at_depth, ball, isotropic, outflow, point_light, reflectance, slab, sphere,
    transmittance,
};
use crate::support::verdict;
use glam::DVec3;
use std::f64::consts::PI;
use turbid::Error;
use turbid::Spectrum;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::light::Faces;
use turbid::math::{Ray, exp};
use turbid::photons::{Emitter, Histories, Photon, PhotonMap, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, SURROUNDINGS, Scene, SceneParts, decay};
use turbid::sensor::{PathSettings, PhotonSettings, by_paths, by_photons};
use turbid::transport::{LONG, NoProgress, Roulette, Step, Visitor, Walker, walk};

fn photon_settings(photons: u64, gather: Gather) -> PhotonSettings {
    PhotonSettings {
        photons,
        maps: 1,
        seed: 1,
        orders: Orders::ALL,
        estimator: Estimator::new(Kernel::Uniform, gather).treated(Treatment::Clipped),
    }
}

fn with_sensors(scene: &Scene, quantities: &[Quantity]) -> Scene {
    Scene::new(SceneParts {
        regions: scene.regions().to_vec(),
        objects: scene.objects().to_vec(),
        lights: scene.lights().to_vec(),
        cell: scene.periodic_cell().map(|s| s.side),
        sensors: quantities.iter().map(|q| crate::support::run::sensor(q.clone(), Orders::ALL)).collect(),
        ..SceneParts::default()
    })
    .unwrap()
}

/// tau -> 0: R / tau = albedo b / mu0 with b = 1/2 for isotropic scattering, where the next term is tau ln tau: nothing
/// at 1e-8. A free flight would collide once in 1e8; forced ones measure the limit to 1e-3.
#[test]
fn an_optical_thickness_of_1e_8() {
    let tau = 1e-8;
    for mu0 in [1.0, 0.5] {
        let scene = slab(tau, 0.9, 0.0, Incidence::Beam(mu0));
        let expected = 0.9 * tau * 0.5 / mu0;
        let sensors = [
            (reflectance(tau), Orders::ALL),
            (transmittance(tau), Orders::SCATTERED),
            (transmittance(tau), Orders::ALL),
        ];
        let photons = pass(&scene, &sensors, 1 << 22, 1, |_| false).tallies;
        for (i, name) in ["R", "T scattered"].into_iter().enumerate() {
            assert!(
                photons[i][0].std_error() < 1e-3 * expected,
                "{name}: {}",
                photons[i][0].std_error() / expected
            );
            verdict::agrees(
                &format!("{name} by photons, mu0 {mu0}"),
                &photons[i][0],
                (expected, 1e-6 * expected),
                8e-3 * expected,
                1,
            );
        }
        assert!((photons[2][0].mean() - (1.0 - 1.9 * expected / 0.9)).abs() < 1e-8);
        let by_paths = paths(&scene, reflectance(tau), Orders::ALL, 1 << 18, 1)[0];
        verdict::agrees(
            &format!("R by paths, mu0 {mu0}"),
            &by_paths,
            (expected, 1e-6 * expected),
            0.5 * expected,
            1,
        );
    }
}

/// Diffuse light meets 2 tau on its way, half of what is scattered turns back: R = albedo tau, the next term being
/// tau^2 ln tau. Roulette must not take back what the forced collision gave: paths of weight tau are not weak ones.
#[test]
fn a_thin_slab_under_diffuse_light_by_paths() {
    let (tau, albedo) = (1e-8, 0.9);
    let scene = slab(tau, albedo, 0.0, Incidence::Diffuse);
    let moments = paths(&scene, reflectance(tau), Orders::ALL, 1 << 24, 12)[0];
    let expected = albedo * tau;
    assert!(moments.std_error() < 1.3e-3 * expected, "{}", moments.std_error() / expected);
    verdict::agrees("R by paths", &moments, (expected, 1e-6 * expected), 1e-2 * expected, 12);
}

/// At 1e-12 the flux is still there, and nothing is lost: 1 - T = 1.9/1.8 ... of 1e-12 is below T's own rounding, R is not.
#[test]
fn an_optical_thickness_of_1e_12() {
    let tau = 1e-12;
    let scene = slab(tau, 1.0, 0.0, Incidence::Diffuse);
    let photons = pass(&scene, &[(reflectance(tau), Orders::ALL)], 1 << 18, 2, |_| false).tallies;
    // Diffuse: R = albedo tau + ...
    verdict::agrees("R", &photons[0][0], (tau, 1e-6 * tau), 0.2 * tau, 2);
}

/// tau = 1e4: nothing passes, everything finite. Without absorption the mean path is 2e4 collisions: few histories.
#[test]
fn an_optical_thickness_of_1e4() {
    let tau = 1e4;
    let scene = with_sensors(
        &slab(tau, 0.9, 0.75, Incidence::Beam(1.0)),
        &[reflectance(tau), transmittance(tau), at_depth(1.0), at_depth(5e3), at_depth(tau)],
    );
    let settings = PathSettings { samples: 4096, seed: 1, replicate: 0, orders: Orders::ALL };
    let measurements = by_paths(&scene, &settings, &NoProgress).unwrap();
    // Paths that bring nothing know nothing of their error.
    assert!(measurements.iter().all(|r| r.mean.is_finite() && r.std_error.is_none_or(f64::is_finite)));
    assert!(
        measurements[1].mean < 1e-300 && measurements[3].mean < 1e-300 && measurements[4].mean < 1e-300,
        "{measurements:?}"
    );
    let photons =
        by_photons(&scene, &photon_settings(4096, Gather::nearest(10, 1.0).unwrap()), &NoProgress).unwrap();
    assert_eq!((photons.measurements[1].mean, photons.measurements[3].mean), (0.0, 0.0));
    let white = slab(tau, 1.0, 0.0, Incidence::Diffuse);
    // What is reflected or passes is all there is, exactly, but for histories that end by roulette.
    let emitter = Emitter::by_power(&white);
    let mut ended = 0;
    for history in 0..64 {
        let mut stream = Stream::new(3, Purpose::Photons, 0, history);
        let start = emitter.emit(&white, &mut stream).unwrap();
        let sent = start.weight;
        let mut left = Left::default();
        walk(&white, start, Roulette::Analog, None, &mut stream, &mut left);
        if left.events <= LONG {
            assert_eq!(left.escaped, sent, "history {history}");
            ended += 1;
        }
    }
    assert!(ended > 48, "{ended} of 64");
    let tallies = pass(&white, &[(transmittance(tau), Orders::ALL)], 64, 3, |_| false).tallies;
    // Conservative and thick: T = (4/3)/(tau + 2 x 0.7104) = 1.3e-4, so that of 64 hardly one passes.
    assert!(tallies[0][0].mean() <= 3.0 / 64.0);
}

/// What leaves, and after how many events.
#[derive(Default)]
struct Left {
    escaped: Spectrum,
    events: u32,
}

impl Visitor for Left {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        self.events = walker.events;
        if let Step::Escaped(weight) = step {
            self.escaped += weight;
        }
    }
}

#[test]
fn transmittance_keeps_its_digits() {
    crate::checks::numbers::transmittance_keeps_its_digits();
}

#[test]
fn a_box_is_seen_along_its_axes() {
    crate::checks::numbers::a_box_is_seen_along_its_axes();
}

#[test]
fn the_largest_word_is_below_one() {
    crate::checks::numbers::the_largest_word_is_below_one();
}

#[test]
fn black_and_white_media() {
    let black = slab(2.0, 0.0, 0.5, Incidence::Beam(0.5));
    let photons = pass(
        &black,
        &[(reflectance(2.0), Orders::ALL), (transmittance(2.0), Orders::ALL)],
        1 << 16,
        4,
        |_| true,
    );
    assert_eq!(photons.tallies[0][0].mean(), 0.0);
    assert!(photons.photons().all(|p| p.order == 0 && p.flags.is_direct()));
    verdict::agrees("T of a black slab", &photons.tallies[1][0], (exp(-4.0), 1e-15), 0.01, 4);
    assert_eq!(paths(&black, reflectance(2.0), Orders::ALL, 4096, 4)[0].mean(), 0.0);
    let phi = paths(&black, at_depth(1.0), Orders::ALL, 4096, 4)[0];
    assert!((phi.mean() / (2.0 * exp(-2.0)) - 1.0).abs() < 1e-14 && phi.std_error() < 1e-15);
    let white = slab(2.0, 1.0, 0.5, Incidence::Beam(0.5));
    let photons = pass(&white, &[(Quantity::Absorbed(0), Orders::ALL)], 1 << 12, 4, |_| false);
    assert_eq!((photons.tallies[0][0].mean(), photons.report.ledger.absorbed), (0.0, 0.0));
    assert_eq!(paths(&white, Quantity::Absorbed(0), Orders::ALL, 4096, 4)[0].mean(), 0.0);
}

#[test]
fn no_photons_at_all() {
    let scene = with_sensors(&slab(1.0, 0.9, 0.0, Incidence::Beam(1.0)), &[reflectance(1.0), at_depth(0.5)]);
    let histories = Histories { count: 0, seed: 1, replicate: 0, max_order: None };
    let pass = shoot(&scene, histories, scene.sensors(), |_| true, &NoProgress).unwrap();
    assert_eq!((pass.emitted(), pass.photons().count(), pass.tallies.len()), (0, 0, 2));
    assert!(pass.tallies[0][0].std_error().is_infinite());
    let refused = PhotonMap::new(Vec::new(), 0).unwrap_err().to_string();
    assert!(refused.contains("emitted") && refused.contains("at least 1"), "{refused}");
    assert!(by_photons(&scene, &photon_settings(0, Gather::radius(0.1).unwrap()), &NoProgress).is_err());
}

/// Photons were sent but none stored: an estimate of 0, no error, no NaN. And k larger than the map: all of them within
/// the cap, counted as under-full.
#[test]
fn few_photons_in_the_map() {
    let fluence = |map: &PhotonMap, sigma_t: Spectrum, gather: Gather| {
        Estimator::new(Kernel::Uniform, gather).fluence(map, DVec3::ZERO, sigma_t, &Boundary::UNKNOWN)
    };
    let empty = PhotonMap::new(Vec::new(), 10).unwrap();
    for gather in [Gather::radius(1.0).unwrap(), Gather::nearest(50, 1.0).unwrap()] {
        let estimate = fluence(&empty, Spectrum::ONE, gather);
        assert_eq!((estimate.value, estimate.found), (Spectrum::ZERO, 0));
    }
    let photon = |x: f64| Photon {
        position: DVec3::new(x, 0.0, 0.0),
        dir: glam::Vec3::Z,
        normal: glam::Vec3::ZERO,
        power: glam::Vec3::ONE,
        order: 1,
        flags: turbid::photons::Flags::MEDIUM,
    };
    let map = PhotonMap::new((0..5).map(|i| photon(0.1 * f64::from(i))).collect::<Vec<_>>(), 10).unwrap();
    let estimate = fluence(&map, Spectrum::grey(2.0), Gather::nearest(50, 1.0).unwrap());
    let ball = 4.0 / 3.0 * PI;
    assert!(estimate.underfull && estimate.found == 5);
    assert!((estimate.value[0] / (5.0 / (10.0 * 2.0 * ball)) - 1.0).abs() < 1e-6, "{estimate:?}");
}

#[test]
fn a_probe_outside_the_medium() {
    let scene = ball(1.0, 0.9, 0.0, isotropic(sphere(DVec3::ZERO, 1.0), Faces::Both));
    let outside = Quantity::Fluence(DVec3::new(3.0, 0.0, 0.0));
    let scene = with_sensors(&scene, std::slice::from_ref(&outside));
    let error =
        by_photons(&scene, &photon_settings(10, Gather::radius(0.1).unwrap()), &NoProgress).unwrap_err();
    assert!(matches!(&error, Error::Scene(text) if text.contains("(3, 0, 0)")), "{error}");
    // Paths: without absorption, what leaves is a radiance of 1/pi within the cone of the sphere.
    let white = ball(1.0, 1.0, 0.0, isotropic(sphere(DVec3::ZERO, 1.0), Faces::Both));
    let expected = 2.0 * (1.0 - (1.0 - 1.0 / 9.0f64).sqrt());
    verdict::agrees(
        "outside",
        &paths(&white, outside, Orders::ALL, 1 << 16, 5)[0],
        (expected, 1e-14),
        0.3 * expected,
        5,
    );
}

/// |g| = 1 - 1e-9: all but a 1e-9th goes straight on, or straight back. Forward, the slab is as good as empty.
#[test]
fn the_sharpest_peaks() {
    let forward = slab(2.0, 1.0, 1.0 - 1e-9, Incidence::Beam(0.5));
    let tallies = pass(&forward, &[(transmittance(2.0), Orders::ALL)], 1 << 14, 6, |_| false).tallies;
    assert_eq!(tallies[0][0].mean(), 1.0);
    // Backward: a beam that turns at each collision, R = 2 x of a one-dimensional slab: with depth s = tau/mu0 along
    // the beam every collision reverses it, so that T = 1/(1+s), R = s/(1+s).
    let backward = slab(2.0, 1.0, -1.0 + 1e-9, Incidence::Beam(0.5));
    let both = [(reflectance(2.0), Orders::ALL), (transmittance(2.0), Orders::ALL)];
    let tallies = pass(&backward, &both, 1 << 18, 7, |_| false).tallies;
    verdict::agrees("R", &tallies[0][0], (0.8, 1e-6), 0.01, 7);
    verdict::agrees("T", &tallies[1][0], (0.2, 1e-6), 0.01, 7);
    for scene in [&forward, &backward] {
        let phi = paths(scene, at_depth(1.0), Orders::only(0), 4096, 8)[0];
        assert!((phi.mean() / (2.0 * exp(-2.0)) - 1.0).abs() < 1e-14);
        let all = paths(scene, at_depth(1.0), Orders::ALL, 4096, 8)[0];
        assert!(all.mean().is_finite() && all.std_error().is_finite());
    }
}

/// Rays along the faces, and probes on them.
#[test]
fn horizontal_rays_and_faces() {
    let scene = slab(2.0, 0.9, 0.0, Incidence::Diffuse);
    let furnace = slab(2.0, 1.0, 0.5, Incidence::Both);
    for z in [0.0, 1.0, 2.0] {
        let ray = Ray::new(DVec3::new(0.5 * CELL, 0.5 * CELL, z), DVec3::X);
        assert!(scene.optical_depth(&ray, f64::INFINITY, SURROUNDINGS)[0].is_infinite());
        assert_eq!(decay(scene.optical_depth(&ray, f64::INFINITY, SURROUNDINGS))[0], 0.0);
        assert_eq!(decay(scene.optical_depth(&ray, 0.5, SURROUNDINGS))[0], exp(-0.5));
        // In the furnace every ray, these too, has the radiance 1/pi.
        let moments = paths(&furnace, Quantity::Radiance(ray), Orders::ALL, 1 << 16, 9)[0];
        verdict::agrees(&format!("radiance along z = {z}"), &moments, (1.0 / PI, 1e-15), 0.02, 9);
    }
    // Just outside, nothing is in the way.
    let outside = Ray::new(DVec3::new(0.0, 0.0, -1e-9), DVec3::X);
    assert_eq!(decay(scene.optical_depth(&outside, f64::INFINITY, SURROUNDINGS))[0], 1.0);
    let mapped =
        with_sensors(&scene, &[at_depth(0.0), at_depth(2.0), Quantity::Fluence(DVec3::new(0.0, 0.0, 1.0))]);
    let measurements =
        by_photons(&mapped, &photon_settings(1 << 14, Gather::radius(0.3).unwrap()), &NoProgress).unwrap();
    assert!(measurements.measurements.iter().all(|r| r.mean.is_finite() && r.mean > 0.0));
}

/// mu0 = 1e-3: the beam runs a thousand mean free paths to a depth of one. Power comes in, is scattered near the face,
/// and R + T + A = 1; the direct fluence on the face is 1/mu0.
#[test]
fn a_grazing_beam() {
    let scene = slab(2.0, 0.9, 0.0, Incidence::Beam(1e-3));
    let sensors = [reflectance(2.0), transmittance(2.0), Quantity::Absorbed(0)].map(|q| (q, Orders::ALL));
    let tallies = pass(&scene, &sensors, 1 << 16, 10, |_| false).tallies;
    let sum: f64 = tallies.iter().map(|t| t[0].mean()).sum();
    assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    let incidence = turbid_analytic::Incidence::Beam { mu0: 1e-3 };
    let exact = turbid_analytic::IsotropicSlab::new(2.0, 0.9, incidence).unwrap();
    verdict::agrees("R", &tallies[0][0], (exact.reflectance().value, 1e-9), 0.02, 10);
    verdict::agrees("T", &tallies[1][0], (exact.transmittance().value, 1e-9), 0.02, 10);
    let on_face = paths(&scene, at_depth(0.0), Orders::only(0), 64, 10)[0];
    assert!((on_face.mean() / 1e3 - 1.0).abs() < 1e-14);
}

/// Seen from anywhere, near, far, on the surface and from the light itself, path samples are finite.
#[test]
fn nothing_is_non_finite() {
    let lights = [
        point_light(DVec3::new(0.1, 0.0, 0.0), Spectrum::ONE),
        scenes::emitting_sphere(DVec3::new(0.1, 0.0, 0.0), 1e-6),
        isotropic(sphere(DVec3::ZERO, 1.0), Faces::Both),
    ];
    let mut places = vec![
        DVec3::new(0.0, 1.0, 0.0),
        DVec3::ZERO,
        DVec3::new(1e9, 0.0, 0.0),
        DVec3::new(0.1 + 1e-5, 0.0, 0.0),
    ];
    places.extend([1e-300, 1e-30, 1e-12].map(|x| DVec3::new(x, 0.0, 1.0)));
    for light in lights {
        for g in [-1.0 + 1e-9, 0.0, 1.0 - 1e-9] {
            let scene = ball(1.0, 0.99, g, light.clone());
            let quantities: Vec<_> = places
                .iter()
                .map(|p| Quantity::Fluence(*p))
                .chain([outflow(sphere(DVec3::ZERO, 1.0))])
                .collect();
            for quantity in quantities {
                let settings = PathSettings { samples: 4096, seed: 11, replicate: 0, orders: Orders::ALL };
                let scene = with_sensors(&scene, std::slice::from_ref(&quantity));
                let measurements = by_paths(&scene, &settings, &NoProgress).unwrap();
                assert!(
                    measurements[0].mean.is_finite() && measurements[0].std_error.is_none_or(f64::is_finite),
                    "{quantity:?}"
                );
            }
        }
    }
}

/// A gather that reaches beyond the copies around the periodic cell would lose photons without a word: it is refused.
#[test]
fn a_gather_wider_than_the_cell() {
    let scene = with_sensors(&slab(2.0, 0.9, 0.0, Incidence::Diffuse), &[at_depth(1.0)]);
    let run = |radius: f64| {
        by_photons(&scene, &photon_settings(1 << 12, Gather::radius(radius).unwrap()), &NoProgress)
    };
    assert!(run(CELL).is_ok());
    let error = run(CELL * 2.6).unwrap_err().to_string();
    assert!(error.contains("cell"), "{error}");
}
