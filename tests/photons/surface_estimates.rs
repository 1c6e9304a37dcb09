//! Estimates on surfaces, apart from transport: discs, who is accepted, the k nearest, bias and variance.

use crate::support::quadrature::integrate;
use crate::support::verdict;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use turbid::estimators::{Gather, Kernel, cap_share, irradiance};
use turbid::photons::tree::Tangent;
use turbid::photons::{Flags, Photon, PhotonMap, Photons};
use turbid::rng::{Purpose, Stream};
use turbid::stats::Moments;

fn photon(position: DVec3, normal: Vec3) -> Photon {
    Photon { position, dir: -normal, normal, power: Vec3::ONE, order: 1, flags: Flags::DIFFUSE }
}

fn up(slope: f64) -> Tangent {
    Tangent { normal: DVec3::Z, slope, turn: 2.0 * slope }
}

fn gathers(k: usize, radius: f64) -> [Gather; 3] {
    [
        Gather::radius(radius).unwrap(),
        Gather::nearest(k, radius).unwrap(),
        Gather::nearest_biased(k, radius).unwrap(),
    ]
}

/// dA = 2 pi u du, u = x^2 for the cone's root; every kernel is smooth, the rule exact but for the Gaussian's series.
#[test]
fn kernels_on_the_disc() {
    for kernel in Kernel::ALL {
        let over = |f: &dyn Fn(f64) -> f64| integrate(0.0, 1.0, 4, |u| 2.0 * PI * u * f(u));
        let k = |u: f64| kernel.disc_peak() * kernel.profile(u * u);
        assert!((over(&k) - 1.0).abs() < 1e-14, "{kernel:?}");
        assert!((over(&|u| u * u * k(u)) - kernel.disc_m2()).abs() < 1e-14, "{kernel:?}");
        assert!((over(&|u| PI * k(u) * k(u)) - kernel.disc_roughness()).abs() < 1e-13, "{kernel:?}");
        for part in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0 - 1e-9] {
            let end = kernel.sample_disc(part);
            let within = integrate(0.0, end, 4, |u| 2.0 * PI * u * k(u));
            assert!((within - part).abs() < 1e-13, "{kernel:?} {part} {within}");
            assert!((cap_share(kernel, end) - part).abs() < 1e-9, "{kernel:?} {part}");
        }
        assert_eq!([cap_share(kernel, 1.0), cap_share(kernel, 7.0)], [1.0, 1.0]);
    }
}

/// Photons everywhere, in all directions: the sum over those that the tangent accepts, one by one.
#[test]
fn against_every_photon() {
    let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
    let mut photons = Vec::new();
    for _ in 0..4000 {
        let [x, y, z] = stream.triple();
        // Of photons on planes most face up, or nearly; of others any way.
        let wide = if stream.unit() < 0.7 { 0.2 } else { 2.0 };
        let tilt = DVec3::from_array(stream.triple().map(|u| wide * (u - 0.5)));
        let normal = (DVec3::Z + tilt).normalize().as_vec3();
        // Half of them near three parallel planes, half anywhere.
        let height = if stream.unit() < 0.5 { [0.0, 0.02, 0.3][stream.index(3)] + 1e-4 * z } else { z };
        photons.push(photon(DVec3::new(x, y, height), normal));
    }
    let map = PhotonMap::new(photons.clone(), 7).unwrap();
    let mut compared = 0;
    for trial in 0..200 {
        let [x, y, z] = stream.triple();
        let point = DVec3::new(x, y, if trial % 2 == 0 { 0.0 } else { z });
        let normal = (DVec3::Z + DVec3::from_array(stream.triple().map(|u| u - 0.5))).normalize();
        let tangent = if trial % 4 == 0 { up(0.1) } else { Tangent { normal, slope: 0.3, turn: 0.5 } };
        let mut near: Vec<f64> = photons
            .iter()
            .filter(|p| tangent.accepts(p.position - point, p.normal.as_dvec3()))
            .map(|p| p.position.distance(point))
            .collect();
        near.sort_by(f64::total_cmp);
        for kernel in Kernel::ALL {
            let sum = |radius: f64, count: usize| -> f64 {
                let weight = |d: &f64| kernel.profile((d / radius).powi(2).min(1.0));
                near[..count].iter().map(weight).sum::<f64>() * kernel.disc_peak() / (radius * radius * 7.0)
            };
            let inside = |radius: f64| near.partition_point(|d| *d <= radius);
            let mut cases = vec![
                (gathers(20, 0.4)[0], 0.4, inside(0.4), inside(0.4), false),
                (gathers(2000, 0.4)[1], 0.4, inside(0.4), inside(0.4), true),
            ];
            if let Some(kth) = near.get(19).filter(|d| **d < 0.9) {
                cases.push((gathers(20, 0.9)[1], *kth, 19, 20, false));
                cases.push((gathers(20, 0.9)[2], *kth, 20, 20, false));
            }
            compared += cases.len();
            for (gather, radius, count, found, underfull) in cases {
                let estimate = irradiance(&map, point, &tangent, kernel, gather);
                let what = format!("{trial} {kernel:?} {gather:?}");
                assert_eq!((estimate.found, estimate.underfull), (found, underfull), "{what}");
                assert!((estimate.radius / radius - 1.0).abs() < 1e-5, "{what}: {}", estimate.radius);
                let expected = sum(radius, count);
                // Single precision of positions a unit across, at radii above a hundredth: 1e-5 of u, twice in u^2.
                let tolerance = 1e-4 * expected + 1e-4 * kernel.disc_peak() / (radius * radius * 7.0);
                assert!(
                    (estimate.value[1] - expected).abs() < tolerance,
                    "{what}: {} {expected}",
                    estimate.value[1]
                );
            }
        }
    }
    assert!(compared > 3 * 200 * 5, "{compared}");
}

/// A floor lit from above; below it, a hair's breadth apart, a ceiling lit three times as much from below; above it, a
/// shelf. None of the others is detected, in the value or in the radius.
#[test]
fn thin_walls_are_told_apart() {
    let mut stream = Stream::new(5, Purpose::Synthetic, 0, 0);
    let mut place = |z: f64| {
        let [x, y] = stream.pair();
        DVec3::new(x, y, z)
    };
    let floor: Vec<Photon> = (0..2000).map(|_| photon(place(0.0), Vec3::Z)).collect();
    let below = (0..6000).map(|_| photon(place(-1e-4), Vec3::NEG_Z));
    let mut all = floor.clone();
    all.extend(below);
    all.extend((0..2000).map(|_| photon(place(0.05), Vec3::Z)));
    let (alone, crowd) = (PhotonMap::new(floor, 2000).unwrap(), PhotonMap::new(all, 2000).unwrap());
    let point = DVec3::new(0.5, 0.5, 0.0);
    for gather in gathers(50, 0.2) {
        for kernel in Kernel::ALL {
            let a = irradiance(&alone, point, &up(0.1), kernel, gather);
            let b = irradiance(&crowd, point, &up(0.1), kernel, gather);
            assert_eq!((a.found, a.underfull), (b.found, b.underfull));
            assert!((a.radius / b.radius - 1.0).abs() < 1e-5);
            assert!((a.value[0] / b.value[0] - 1.0).abs() < 1e-4, "{kernel:?} {gather:?}");
        }
    }
    // From below the ceiling is seen, three times as bright: 6000 in 2000.
    let ceiling = Tangent { normal: -DVec3::Z, slope: 0.1, turn: 0.2 };
    let seen = irradiance(&crowd, point - DVec3::Z * 1e-4, &ceiling, Kernel::Uniform, gathers(50, 0.2)[0]);
    let expected: f64 = 6000.0 * PI * 0.04;
    assert!((seen.found as f64 - expected).abs() < 5.0 * expected.sqrt());
}

/// In a corner a wall's photons lie within the floor's slope, but face another way: none of them counts.
#[test]
fn beside_a_wall() {
    let mut stream = Stream::new(6, Purpose::Synthetic, 0, 0);
    let (mut photons, mut expected) = (Vec::new(), 0);
    let point = DVec3::new(0.0, 0.5, 0.0);
    for _ in 0..20_000 {
        let [a, b] = stream.pair();
        photons.push(photon(DVec3::new(a, b, 0.0), Vec3::Z));
        photons.push(photon(DVec3::new(0.0, b, a), Vec3::X));
        expected += usize::from(point.distance(DVec3::new(a, b, 0.0)) <= 0.2);
    }
    let map = PhotonMap::new(photons, 20_000).unwrap();
    for slope in [1e-4, 0.1, 0.5] {
        let estimate = irradiance(&map, point, &up(slope), Kernel::Uniform, Gather::radius(0.2).unwrap());
        // Single precision moves a photon or two over the edge of the disc.
        assert!(estimate.found.abs_diff(expected) <= 2, "{slope}: {} {expected}", estimate.found);
    }
}

/// N independent photons on a unit square: the k-1 rule is unbiased at finite N in the mean over maps, the biased one
/// is high by K(1) pi/(k-1); variances are those stated. The smallest detectable bias is four per cent of the mean, half of the variance.
#[test]
fn a_uniform_plane() {
    const N: u64 = 2000;
    for kernel in Kernel::ALL {
        for gather in gathers(30, 0.12) {
            let (mut means, mut squares) = (Moments::new(), Moments::new());
            let mut values = Vec::new();
            for map in 0..256 {
                let mut stream = Stream::new(8, Purpose::Synthetic, map, 0);
                let mut place = || {
                    let [x, y] = stream.pair();
                    photon(DVec3::new(x, y, 0.0), Vec3::Z)
                };
                let map = PhotonMap::new((0..N).map(|_| place()).collect::<Photons>(), N).unwrap();
                let spots =
                    [0.2, 0.4, 0.6, 0.8].into_iter().flat_map(|x| [0.2, 0.4, 0.6, 0.8].map(|y| (x, y)));
                let read: Vec<f64> = spots
                    .map(|(x, y)| irradiance(&map, DVec3::new(x, y, 0.0), &up(0.1), kernel, gather).value[0])
                    .collect();
                means.push(read.iter().sum::<f64>() / read.len() as f64);
                values.push(read);
            }
            let n = N as f64;
            let expected = 1.0 + gather.expected_disc_bias(kernel, 1.0, 0.0, n);
            let what = format!("{kernel:?} {gather:?}");
            verdict::agrees(&what, &means, (expected, 1e-3), 0.04, 8);
            // Deviations of single spots, averaged over the spots of a map.
            let variance = gather.expected_disc_variance(kernel, n, 1.0);
            for read in values {
                let sum: f64 = read.iter().map(|v| (v - expected) * (v - expected)).sum();
                squares.push(sum / read.len() as f64 / variance);
            }
            // At fixed N the variance is lower by 1/N of the mean square, 1/2000 of 1/30.
            verdict::agrees(&format!("variance, {what}"), &squares, (1.0, 0.02), 0.5, 8);
        }
    }
}
