//! Points along a ray, with one radius or one each: sums by hand, copies of a periodic cell, what passes to each place, blur across the ray, walls, and paths.

use super::boundary::known;
use crate::checks::along_rays::{own_radii_by_hand, photon, reading};
use crate::checks::media::{layered, varying};
use crate::support::quadrature::integrate;
use crate::support::run::{paths, sensor};
use crate::support::scenes::{
    CELL, Incidence, bounded, cuboid, homogeneous, incidence, layer, point_light, region,
};
use crate::support::verdict;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel, RayEstimator};
use turbid::geometry::{Rectangle, Shape, Slab, Sphere};
use turbid::math::{FOUR_PI, Interval, Positive, Ray, exp, warp};
use turbid::medium::{Homogeneous, Medium};
use turbid::phase::Phase;
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{Photon, PhotonMap};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Region, Scene, SceneParts};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::{NoProgress, Passage};
use turbid_analytic::beams::Pairing;

#[test]
fn own_radii() {
    own_radii_by_hand();
}

/// One photon beside a ray, in a homogeneous medium and in one that grows denser along it: products of five factors.
#[test]
fn one_photon_by_hand() {
    let ray = Ray::new(DVec3::new(-2.0, 0.03, 0.7), DVec3::X);
    let span = Interval { start: 0.0, end: 4.0 };
    let map = PhotonMap::new(vec![photon(DVec3::new(0.5, 0.06, 0.74), Vec3::Z)], 1).unwrap();
    let even = homogeneous(Spectrum::ONE, Spectrum::grey(0.5), 0.5);
    let beer = |t: f64| Spectrum::grey(exp(-t));
    for (kernel, expected) in
        [(Kernel::Uniform, 0.05579179), (Kernel::Epanechnikov, 0.08368769), (Kernel::Biweight, 0.09414865)]
    {
        let estimate = reading(kernel, 0.1).radiance(&map, (&ray, span), &even, &Boundary::UNKNOWN, &beer);
        assert_eq!((estimate.found, estimate.rejected), (1, 0));
        assert!((estimate.value[0] / expected - 1.0).abs() < 3e-7, "{kernel:?}: {}", estimate.value[0]);
        // Beyond the radius, and behind the end.
        let thin = reading(kernel, 0.0499).radiance(&map, (&ray, span), &even, &Boundary::UNKNOWN, &beer);
        assert_eq!(thin.found, 0);
        let short = Interval { end: 2.49, ..span };
        let short = reading(kernel, 0.1).radiance(&map, (&ray, short), &even, &Boundary::UNKNOWN, &beer);
        assert_eq!(short.found, 0);
    }
    // Extinction .4 + .2 s along the ray: what passes has a depth of 1.625.
    let passed = |t: f64| Spectrum::grey(exp(-(0.4 * t + 0.1 * t * t)));
    let estimate =
        reading(Kernel::Uniform, 0.1).radiance(&map, (&ray, span), &even, &Boundary::UNKNOWN, &passed);
    assert!((estimate.value[0] / 0.13383755 - 1.0).abs() < 3e-7);
}

/// Rays that run through many copies of a cell, either way, level and steep, from far outside it: found is what all copies, asked
/// one by one, say; and a radius beyond the copies, or a stretch without end, is not known.
#[test]
fn rays_run_through_the_copies_of_a_cell() {
    let (side, reach) = (DVec2::new(2.0, 3.0), 0.4);
    let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
    let photons: Vec<Photon> =
        (0..500).map(|_| photon(DVec3::from(stream.triple()) * side.extend(1.0), Vec3::Z)).collect();
    let map = PhotonMap::periodic(vec![photons.clone().into()], 1, Some((side, reach)), &NoProgress).unwrap();
    let mut found = 0;
    for trial in 0..60 {
        let dir = match trial % 6 {
            0 => DVec3::X,
            1 => DVec3::NEG_Y,
            2 => DVec3::new(-1.0, 1e-3, 1e-4).normalize(),
            _ => warp::square_to_sphere(stream.pair()),
        };
        let through = (DVec3::from(stream.triple()) - 0.5) * DVec3::new(8.0, 9.0, 1.0) + 0.5 * DVec3::Z;
        let ray = Ray::new(through - dir * 5.0, dir);
        let span = Interval { start: 4.0 * stream.unit(), end: 6.0 + 6.0 * stream.unit() };
        let radius = [0.05, 0.2, 0.4][trial % 3];
        let mut sum = [0.0; 3];
        let is_known = map.along(&ray, span, radius, |_, foot, squared| {
            sum = [sum[0] + 1.0, sum[1] + foot, sum[2] + squared];
        });
        assert!(is_known);
        let mut expected = [0.0; 3];
        for (i, j) in (-12..=12).flat_map(|i| (-8..=8).map(move |j| (i, j))) {
            let shift = DVec3::new(f64::from(i) * side.x, f64::from(j) * side.y, 0.0);
            for photon in &photons {
                let way = photon.position + shift - ray.origin;
                let foot = way.dot(dir);
                let squared = (way - dir * foot).length_squared();
                if span.start <= foot && foot < span.end && squared <= radius * radius {
                    expected = [expected[0] + 1.0, expected[1] + foot, expected[2] + squared];
                }
            }
        }
        // Positions are stored in single precision: a photon on the edge may be seen on either side of it.
        assert!((sum[0] - expected[0]).abs() <= 1.0, "{trial}: {sum:?} {expected:?}");
        if sum[0] == expected[0] {
            assert!((sum[1] - expected[1]).abs() < 1e-5 * expected[1].max(1.0), "{trial}");
            assert!((sum[2] - expected[2]).abs() < 1e-5 * expected[2].max(0.1), "{trial}");
        }
        found += expected[0] as u64;
    }
    assert!(found > 2000, "{found}");
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    assert!(!map.along(&ray, Interval { start: 0.0, end: 1.0 }, 0.41, |_, _, _| ()));
    assert!(!map.along(&ray, Interval { start: 0.0, end: f64::INFINITY }, 0.1, |_, _, _| ()));
}

/// What passes to each place of a stretch is right in the mean, in channels of different extinction too, and exact where it has a
/// closed form.
#[test]
fn what_passes_is_unbiased_at_every_place() {
    let corners = (DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0));
    let density = layered(corners, 9, |z| 0.2 + (z - 1.7) * (z - 1.7));
    let medium = varying(Spectrum::rgb(0.3, 1.0, 2.0), 0.8, density);
    let even = homogeneous(Spectrum::rgb(0.3, 1.0, 2.0), Spectrum::grey(0.5), 0.0);
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z);
    let part = Interval { start: 1.25, end: 5.0 };
    let places = [1.25, 1.5, 2.2, 3.7, 4.6];
    let mut moments = [[Moments::new(); 3]; 5];
    for history in 0..100_000 {
        let mut stream = Stream::new(4, Purpose::Paths, 0, history);
        let passage = Passage::new(&medium, &ray, part, &mut stream);
        for (t, moments) in places.iter().zip(&mut moments) {
            let passed = passage.to(*t);
            (0..3).for_each(|channel| moments[channel].push(passed[channel]));
        }
    }
    for (t, moments) in places.iter().zip(&moments) {
        let depth = medium.integrated_depth(&ray, Interval { end: *t, ..part });
        let exact = Passage::new(&even, &ray, part, &mut Stream::new(4, Purpose::Paths, 0, 0)).to(*t);
        for channel in 0..3 {
            let expected = exp(-depth[channel]);
            if *t > part.start {
                let what = format!("to {t}, channel {channel}");
                verdict::agrees(&what, &moments[channel], (expected, 1e-9), 0.05 * expected.max(0.05), 4);
            } else {
                assert_eq!((moments[channel].mean(), moments[channel].std_error()), (1.0, 0.0));
            }
            let rate = [0.3, 1.0, 2.0][channel];
            assert!((exact[channel] / exp(-rate * (t - part.start)) - 1.0).abs() < 1e-14);
        }
    }
}

/// In an exponential field, across it and aslant: blurred by the kernel's disc, as the referee says, and by nothing else.
#[test]
fn fields_are_blurred_across_the_ray() {
    let (rate, radius) = (3.0, 0.2);
    let synthetic = Synthetic::new(Profile::Exponential { rate }, DVec3::ZERO, DVec3::ONE).unwrap();
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let level = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z);
    let aslant = Ray::new(DVec3::new(-0.2, 0.5, -0.3), DVec3::new(0.6, 0.0, 0.8));
    // From the box's face to face, and from x = .25 to .625, where no kernel reaches beyond it.
    let ways = [
        ("level", level, Interval { start: 1.0, end: 2.0 }),
        ("aslant", aslant, Interval { start: 0.75, end: 1.375 }),
    ];
    let mut moments = [[Moments::new(); 5]; 2];
    for replicate in 0..220 {
        let map = synthetic.map(Number::Expected(20_000), 11, replicate).unwrap();
        for ((_, ray, span), moments) in ways.iter().zip(&mut moments) {
            for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
                let reading = reading(kernel, radius);
                let all = |_| Spectrum::ONE;
                let estimate = reading.radiance(&map, (ray, *span), &even, &Boundary::UNKNOWN, &all);
                moments.push(estimate.value[0]);
            }
        }
    }
    for ((name, ray, span), moments) in ways.iter().zip(&moments) {
        let along = |t: f64| synthetic.density(ray.at(t));
        let sharp = integrate(span.start, span.end, 8, along) / FOUR_PI;
        let across = rate * (1.0 - ray.dir.x * ray.dir.x).sqrt();
        for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
            let blur = Pairing::RayPoints.exponential_mean(known(kernel), across * radius).unwrap();
            let expected = sharp * blur.value;
            let what = format!("{name}, {kernel:?}");
            verdict::agrees(&what, moments, (expected, 1e-6 * expected), 0.02 * expected, 11);
            if kernel == Kernel::Uniform {
                verdict::rejects(&format!("not blurred, {what}"), moments, sharp, 11);
            }
        }
    }
}

/// A wall beside the ray hides the photons beyond it; those of another medium do not count.
#[test]
fn photons_behind_walls_do_not_count() {
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let mut stream = Stream::new(9, Purpose::Synthetic, 0, 0);
    let photons: Vec<Photon> = (0..2000).map(|_| photon(DVec3::from(stream.triple()), Vec3::Z)).collect();
    let map = PhotonMap::new(photons.clone(), 1).unwrap();
    let ray = Ray::new(DVec3::new(0.5, 0.5, 0.0), DVec3::Z);
    let span = Interval { start: 0.0, end: 1.0 };
    // The wall ends half way up.
    let wall = Rectangle::new(DVec3::new(0.6, -1.0, -1.0), DVec3::Y * 3.0, DVec3::Z * 1.5).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let other = [cuboid(DVec3::new(0.0, 0.6, 0.0), DVec3::ONE)];
    let known = Boundary::of(&whole).unwrap();
    let reading = reading(Kernel::Uniform, 0.3);
    for (boundary, is_lost) in [
        (known.about(&walls), (|p: DVec3| p.x > 0.6 && p.z < 0.5) as fn(DVec3) -> bool),
        (known.among(&other), |p: DVec3| p.y > 0.6),
    ] {
        let estimate = reading.radiance(&map, (&ray, span), &even, &boundary, &|_| Spectrum::ONE);
        let near = |p: &&Photon| (p.position - DVec3::new(0.5, 0.5, p.position.z)).length() < 0.3;
        let lost = photons.iter().filter(near).filter(|p| is_lost(p.position)).count();
        let all = photons.iter().filter(near).count();
        assert_eq!((estimate.rejected, estimate.found), (lost, all - lost));
        assert!(lost > 50);
    }
}

/// A uniform source in a box, along a ray that enters and leaves it aslant near edges, alone and beside a wall that ends half way: clipped
/// it comes out right with every kernel, unclipped it does not.
#[test]
fn a_uniform_source_comes_out_right_beside_walls() {
    let synthetic = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::ONE).unwrap();
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let ray = Ray::new(DVec3::new(-0.3, 0.85, 0.1), DVec3::new(0.8, -0.1, 0.59).normalize());
    let span = whole.interval(&ray).unwrap();
    let wall = Rectangle::new(DVec3::new(0.3, 0.0, 0.3), DVec3::Y, DVec3::new(0.4, 0.0, 0.25)).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let known = Boundary::of(&whole).unwrap();
    // However large the disc, what is in the box counts: all photons along the ray.
    let map = synthetic.map(Number::Exact(10_000), 12, 999).unwrap();
    for radius in [3.0, 1e3, 1e6] {
        let reading = RayEstimator { is_clipped: true, ..reading(Kernel::Uniform, radius) };
        let found = reading.radiance(&map, (&ray, span), &even, &known, &|_| Spectrum::ONE).value[0];
        assert!((found * FOUR_PI / span.length() - 1.0).abs() < 0.1, "{radius}: {found}");
    }
    let sheet = |x: f64| Rectangle::new(DVec3::new(x, 0.0, 0.1), DVec3::Y, DVec3::Z * 0.7).unwrap();
    let sheets: Vec<Shape> = (1..=25).map(|n| Shape::Rectangle(sheet(0.037 * f64::from(n)))).collect();
    for (name, boundary) in
        [("alone", known), ("beside a wall", known.about(&walls)), ("among sheets", known.about(&sheets))]
    {
        let mut moments = [[Moments::new(); 5]; 2];
        for replicate in 0..260 {
            let map = synthetic.map(Number::Expected(10_000), 12, replicate).unwrap();
            for (is_clipped, moments) in [true, false].into_iter().zip(&mut moments) {
                for (kernel, moments) in Kernel::ALL.into_iter().zip(moments) {
                    let reading = RayEstimator { is_clipped, ..reading(kernel, 0.2) };
                    let estimate = reading.radiance(&map, (&ray, span), &even, &boundary, &|_| Spectrum::ONE);
                    moments.push(estimate.value[0]);
                }
            }
        }
        let expected = span.length() / FOUR_PI;
        for (kernel, moments) in Kernel::ALL.into_iter().zip(&moments[0]) {
            let what = format!("{name}, {kernel:?}");
            // Of the cone's shares.
            verdict::agrees(&what, moments, (expected, 2e-4 * expected), 0.035 * expected, 12);
        }
        verdict::rejects(&format!("not clipped, {name}"), &moments[1][0], expected, 12);
    }
}

/// A uniform source in a layer and in a ball far smaller than the radius, alone, beside plates that are larger than the layer, and cut through by
/// a wall: clipped it comes out right, by rows and one by one.
#[test]
fn what_is_thinner_than_the_radius_is_no_darker() {
    const THICKNESS: f64 = 0.002;
    const PHOTONS: u64 = 4_000;
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let low = DVec3::new(0.0, 0.0, 0.1);
    let layer = cuboid(low, DVec3::new(1.0, 1.0, 0.1 + THICKNESS));
    let ball = Shape::Sphere(Sphere::new(DVec3::splat(0.1), THICKNESS).unwrap());
    let plate = |z: f64| {
        Shape::Rectangle(Rectangle::new(DVec3::new(-1.0, -1.0, z), DVec3::X * 3.0, DVec3::Y * 3.0).unwrap())
    };
    let plates = [plate(0.1 - 1e-4), plate(0.1 + THICKNESS + 1e-4)];
    let wall = [Shape::Rectangle(
        Rectangle::new(DVec3::new(0.0, 0.7, 0.0), DVec3::new(1.0, 0.1, 0.0), DVec3::Z).unwrap(),
    )];
    let (of_layer, of_ball) = (Boundary::of(&layer).unwrap(), Boundary::of(&ball).unwrap());
    let aslant = Ray::new(DVec3::new(-0.2, 0.55, 0.1009), DVec3::new(1.0, -0.1, 3e-4).normalize());
    let through = Ray::new(DVec3::new(-0.2, 0.1005, 0.1), DVec3::new(1.0, 0.0, 1e-3).normalize());
    let cases = [
        ("a layer", &layer, of_layer, aslant),
        ("a layer between plates", &layer, of_layer.about(&plates), aslant),
        ("a layer beside a wall", &layer, of_layer.about(&wall), aslant),
        ("a ball", &ball, of_ball, through),
    ];
    for (name, shape, boundary, ray) in cases {
        let span = shape.interval(&ray).unwrap();
        let volume = if shape == &ball { FOUR_PI / 3.0 * THICKNESS.powi(3) } else { THICKNESS };
        let expected = (1.0 - exp(-span.length())) / (volume * FOUR_PI);
        let mut moments = [Moments::new(); 2];
        for replicate in 0..100 {
            let mut stream = Stream::new(21, Purpose::Synthetic, replicate, 0);
            let mut place = || loop {
                let unit = DVec3::from(stream.triple());
                let place = if shape == &ball {
                    DVec3::splat(0.1) + THICKNESS * (2.0 * unit - 1.0)
                } else {
                    low + unit * DVec3::new(1.0, 1.0, THICKNESS)
                };
                if shape.contains(place) {
                    return place;
                }
            };
            let photons: Vec<Photon> = (0..PHOTONS).map(|_| photon(place(), Vec3::Z)).collect();
            let map = PhotonMap::new(photons, PHOTONS).unwrap();
            let reading =
                RayEstimator { is_clipped: true, ..reading(Kernel::ALL[replicate as usize % 5], 0.2) };
            let passage = Passage::new(&even, &ray, span, &mut stream);
            let rows = reading.radiance(&map, (&ray, span), &even, &boundary, &passage);
            let single = reading.radiance(&map, (&ray, span), &even, &boundary, &|t| passage.to(t));
            moments[0].push(rows.value[0]);
            moments[1].push(single.value[0]);
        }
        for (way, moments) in ["by rows", "one by one"].into_iter().zip(&moments) {
            verdict::agrees(
                &format!("{name}, {way}"),
                moments,
                (expected, 2e-4 * expected),
                0.035 * expected,
                21,
            );
        }
    }
}

/// Where the medium is the same everywhere rows of photons are read at once: as one by one, with every kernel, phase functions of every
/// kind, colours or none, clipped or not, in every solid shape, alone, with walls, a block, a ball and a hole, before, in and behind the
/// medium. Clipped near walls they are divided by the share of a stretch, not of their own foot: right in the mean.
#[test]
fn rows_are_read_as_photons_are_one_by_one() {
    let synthetic = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::ONE).unwrap();
    let map = synthetic.map(Number::Exact(20_000), 12, 1).unwrap();
    let wall = Rectangle::new(DVec3::new(0.3, 0.0, 0.3), DVec3::Y, DVec3::new(0.4, 0.0, 0.25)).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let holes = [cuboid(DVec3::new(0.4, 0.5, 0.1), DVec3::new(0.7, 0.8, 0.4))];
    // Far larger than the map, but for one edge.
    let large =
        Rectangle::new(DVec3::new(-1e7, 0.6, 0.75), DVec3::X * 1e7 + 0.4 * DVec3::X, DVec3::Y * 1e7).unwrap();
    let block = cuboid(DVec3::new(0.6, 0.2, 0.5), DVec3::new(0.9, 0.4, 0.8));
    let blocks = [walls[0].clone(), block, Shape::Rectangle(large)];
    let ball = Shape::Sphere(Sphere::new(DVec3::new(0.3, 0.7, 0.7), 0.15).unwrap());
    let bodies = [&blocks[..], &[ball]].concat();
    let shapes = [
        cuboid(DVec3::ZERO, DVec3::ONE),
        Shape::Sphere(Sphere::new(DVec3::splat(0.5), 0.5).unwrap()),
        Shape::Slab(Slab::new(0.1, 0.7).unwrap()),
    ];
    let mut stream = Stream::new(4, Purpose::Synthetic, 0, 0);
    let (mut read, mut by_rows, mut rejected) = (0, 0, 0);
    let (mut clipped, mut within, mut all) = (Moments::new(), 0, 0);
    for (trial, phase) in Phase::specimens().into_iter().enumerate() {
        let sigma_t = [Spectrum::ONE, Spectrum::rgb(0.3, 4.0, 1.0), Spectrum::rgb(0.0, 12.0, 0.1)][trial % 3];
        let medium =
            Medium::Homogeneous(Homogeneous::new(sigma_t, Spectrum::rgb(0.5, 0.9, 0.7), phase).unwrap());
        for (which, shape) in (0..6).flat_map(|_| &shapes).enumerate() {
            let known = Boundary::of(shape).unwrap();
            let among = [
                known,
                known.about(&walls),
                known.about(&blocks),
                known.about(&bodies),
                known.among(&holes).about(&walls),
                Boundary::UNKNOWN,
                Boundary::UNKNOWN.about(&blocks),
            ];
            let boundary = &among[(trial + which) % among.len()];
            let origin = DVec3::from(stream.triple()) * 3.0 - 1.0;
            let ray = Ray::new(origin, (DVec3::from(stream.triple()) - origin).normalize());
            let Some(span) = shape.interval(&ray) else { continue };
            let passage = Passage::new(&medium, &ray, span, &mut stream);
            for (kernel, is_clipped) in Kernel::ALL.into_iter().zip([true, false].into_iter().cycle()) {
                let radius = [0.02, 0.1, 0.3][trial % 3];
                let reading = RayEstimator { is_clipped, ..reading(kernel, radius) };
                let rows = reading.radiance(&map, (&ray, span), &medium, boundary, &passage);
                let single = reading.radiance(&map, (&ray, span), &medium, boundary, &|t| passage.to(t));
                read += rows.found;
                by_rows += usize::from(rows.value != single.value);
                let what = format!("{trial} {which} {kernel:?} {is_clipped}");
                // A photon at the edge may count by one and not by the other.
                assert!(rows.found.abs_diff(single.found) <= 1, "{what}: {rows:?} {single:?}");
                assert!(rows.rejected.abs_diff(single.rejected) <= 1, "{what}: {rows:?} {single:?}");
                rejected += rows.rejected;
                if rows.found != single.found || single.found == 0 {
                    continue;
                }
                let off = (rows.value - single.value).map(f64::abs).max() / single.value.max();
                if is_clipped && off > 3e-4 {
                    // Where a ray enters a ball the part of a disc grows from nothing, and one photon decides; it may by its phase too.
                    if which % 3 != 1 {
                        assert!(off <= 0.3, "{what}: {rows:?} {single:?}");
                        clipped.push(rows.value[1] / single.value[1]);
                    }
                } else {
                    // Directions in single precision, whose angles of 10^-3 and more a peak has to the third power.
                    assert!(off <= 3e-4, "{what}: {rows:?} {single:?}");
                    within += usize::from(!is_clipped && off <= 2e-5);
                    all += usize::from(!is_clipped);
                }
            }
        }
    }
    assert!(100 * within > 98 * all, "{within} of {all}");
    assert!(rejected > 500, "{rejected}");
    assert!(clipped.n() > 50 && clipped.std_error() < 1e-3, "{clipped:?}");
    assert!((clipped.mean() - 1.0).abs() < 1e-3 + 3.0 * clipped.std_error(), "{clipped:?}");
    assert!(read > 10_000, "{read}");
    // The last bits tell whether rows were read at all.
    assert!(by_rows > 100, "{by_rows}");
}

/// Light that is scattered twice and more, along rays through a box of even and of varying density: as by paths.
#[test]
fn radiance_along_rays_is_that_of_paths() {
    let corners = (DVec3::splat(-1.0), DVec3::ONE);
    let even = homogeneous(Spectrum::rgb(1.0, 2.0, 0.5), Spectrum::rgb(0.9, 0.5, 0.8), 0.4);
    let density = layered(corners, 7, |z| 1.0 + 0.7 * z);
    let media: [(&str, Medium); 2] = [("even", even), ("varying", varying(Spectrum::ONE, 0.9, density))];
    let orders = Orders { min: 2, max: None };
    let views = [
        Ray::new(DVec3::new(0.1, 0.2, -3.0), DVec3::Z),
        Ray::new(DVec3::new(-0.2, 0.3, 0.1), DVec3::new(0.48, 0.6, 0.64)),
    ];
    for (name, medium) in media {
        let region = Region { shape: cuboid(corners.0, corners.1), medium };
        let light = point_light(DVec3::new(0.5, -0.4, 0.6), Spectrum::ONE);
        let plain = bounded(vec![region.clone()], Vec::new(), vec![light.clone()]);
        let scene = Scene::new(SceneParts {
            regions: vec![region],
            lights: plain.named_lights().to_vec(),
            sensors: views.iter().map(|ray| sensor(Quantity::Radiance(*ray), orders)).collect(),
            ..SceneParts::default()
        })
        .unwrap();
        let radius = Positive::new("the radius", 0.1).unwrap();
        let points = Estimator::new(Kernel::Epanechnikov, Gather::Radius(radius));
        let settings = PhotonSettings {
            photons: 10_000,
            maps: 256,
            seed: 6,
            orders: Orders::ALL,
            estimator: points.along_rays(radius),
        };
        let read = by_photons(&scene, &settings, &NoProgress).unwrap().measurements;
        let channels = read.len() / views.len();
        for (view, ray) in views.iter().enumerate() {
            let reference = paths(&plain, Quantity::Radiance(*ray), orders, 1 << 17, 3);
            for channel in 0..channels {
                let found = &read[view * channels + channel];
                let (x, y) = (found.mean, reference[channel].mean());
                let error = libm::hypot(found.std_error.unwrap(), reference[channel].std_error());
                assert!(error < 0.05 * y, "{name} {view} {channel}: {found:?} {reference:?}");
                // The blur is m2 r^2/4 = 1/1200 of the Laplacian across the ray, which is a few times the field.
                assert!((x - y).abs() < 4.0 * error + 0.005 * y, "{name} {view} {channel}: {x} {y} {error}");
            }
        }
    }
}

/// The number of photons that are within r of a place of an exponential field, of this density there.
fn within(density: f64, rate: f64, r: f64) -> f64 {
    let x = rate * r;
    4.0 * PI * density * (x * libm::cosh(x) - libm::sinh(x)) / (rate * rate * rate)
}

/// The chance that a Poisson number is below k.
fn is_below(k: u32, mean: f64) -> f64 {
    let mut term = exp(-mean);
    (0..k).fold(0.0, |sum, i| {
        let sum = sum + term;
        term *= mean / f64::from(i + 1);
        sum
    })
}

/// In an exponential field whose photons have radii of their own, across it: the blur is that of the radius at each photon, not of
/// that at the ray. With R(y) the distance to the k-th of a Poisson process about y, the mean is the integral of f(y) E K_R(y - x)
/// over the plane across the ray; R does not depend on the photon at y. Sharp, or with the law of the radius at the ray, it is another.
#[test]
fn fields_are_blurred_by_the_radius_at_each_photon() {
    let (rate, count, cap) = (6.0, 6000, 0.2);
    let synthetic = Synthetic::new(Profile::Exponential { rate }, DVec3::ZERO, DVec3::ONE).unwrap();
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    // No ball reaches beyond the box.
    let span = Interval { start: 1.25, end: 1.75 };
    let rays = [0.3, 0.4, 0.5, 0.6, 0.7].map(|y| Ray::new(DVec3::new(0.5, y, -1.0), DVec3::Z));
    let specimens = [(Kernel::Uniform, 12), (Kernel::Biweight, 24)];
    let mut moments = [Moments::new(); 2];
    for replicate in 0..600 {
        let map = synthetic.map(Number::Expected(count), 13, replicate).unwrap();
        for ((kernel, k), moments) in specimens.iter().zip(&mut moments) {
            let radii = map.radii(*k as usize, cap);
            let read = |ray: &Ray| {
                let of = (&map, &radii);
                let all = |_| Spectrum::ONE;
                reading(*kernel, cap)
                    .radiance_by_radii(of, (ray, span), &even, &Boundary::UNKNOWN, &all)
                    .value[0]
            };
            moments.push(rays.iter().map(read).sum::<f64>() / rays.len() as f64);
        }
    }
    let middle = synthetic.density(DVec3::splat(0.5));
    let sharp = middle * span.length() / FOUR_PI;
    for ((kernel, k), moments) in specimens.into_iter().zip(&moments) {
        let plane = |u2: f64, r: f64| kernel.disc_peak() * kernel.profile(u2) / (r * r);
        // The mean kernel at a distance, where radii are those of a density.
        let mean = |distance: f64, density: f64| {
            let expected = f64::from(count as u32) * density;
            let inside = integrate(distance, cap, 2, |r| {
                let many = within(expected, rate, r);
                let faster = 4.0 * PI * expected * r * libm::sinh(rate * r) / rate;
                let last = is_below(k, many) - is_below(k - 1, many);
                faster * last * plane(distance * distance / (r * r), r)
            });
            inside + is_below(k, within(expected, rate, cap)) * plane(distance * distance / (cap * cap), cap)
        };
        let blurred = |density_of: &dyn Fn(f64) -> f64| {
            // Rings of the disc, and angles on them.
            let ring = |s: f64| {
                let angle = |phi: f64| {
                    let x = s * turbid::math::cos(phi);
                    exp(-rate * x) * mean(s, density_of(x))
                };
                2.0 * s * integrate(0.0, PI, 1, angle)
            };
            sharp * integrate(0.0, cap, 4, ring)
        };
        let expected = blurred(&|x| middle * exp(-rate * x));
        let what = format!("{kernel:?} k={k}");
        verdict::agrees(&what, moments, (expected, 1e-5 * expected), 0.036 * expected, 13);
        let at_the_ray = blurred(&|_| middle);
        verdict::rejects(&format!("{what}, radius at the ray"), moments, at_the_ray, 13);
    }
}

/// Along the normal of a slab the light of a disc is the same all over it, and so is the law of its radii: what leaves it comes out
/// exactly, whatever the k, under a beam and in a furnace.
#[test]
fn slabs_along_their_normal_know_no_radius() {
    let places = [[0.5, 0.5], [0.2, 0.7], [0.8, 0.3], [0.1, 0.1]];
    let look = |[x, y]: [f64; 2]| Quantity::Radiance(Ray::new(DVec3::new(x * CELL, y * CELL, 0.0), DVec3::Z));
    for (how, albedo, expected) in
        [(Incidence::Beam(1.0), 0.9, 0.066_845_328), (Incidence::Both, 1.0, -turbid::math::exp_m1(-1.0) / PI)]
    {
        let scene = Scene::new(SceneParts {
            lights: vec![incidence(layer(1.0), how)],
            regions: vec![region(layer(1.0), 1.0, albedo, 0.0)],
            sensors: places.map(|place| sensor(look(place), Orders::SCATTERED)).to_vec(),
            cell: Some(DVec2::splat(CELL)),
            ..SceneParts::default()
        })
        .unwrap();
        let of = |k: usize| {
            let along = Estimator::new(Kernel::Uniform, Gather::radius(0.1).unwrap())
                .treated(turbid::estimators::boundary::Treatment::Clipped)
                .along_rays(Positive::new("the radius", 0.6).unwrap());
            along.of_nearest(NonZeroUsize::new(k).unwrap())
        };
        let estimators = [4, 30].map(of);
        let measured = crate::checks::beams::means_by_maps(&scene, (4000, 100), 14, &estimators);
        for (estimator, moments) in estimators.iter().zip(&measured) {
            let what = format!("{how:?}, {}", estimator.name());
            verdict::agrees(&what, moments, (expected, 1e-8), 0.13 * expected, 14);
        }
    }
}

/// Near a face the share is that of the photon's own disc: pairs of photons a tenth apart, whose radii are all that, read as with a
/// fixed radius of a tenth, clipped and not, beside a wall too.
#[test]
fn shares_near_walls_are_of_each_radius() {
    let whole = cuboid(DVec3::ZERO, DVec3::ONE);
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let photons: Vec<Photon> = (0..64)
        .flat_map(|i| {
            let (row, column) = (i / 8, i % 8);
            // No other pair is as near.
            let at = DVec3::new(0.03 + 0.3 * f64::from(row % 4), 0.02, 0.06 + 0.12 * f64::from(column));
            [at, at + DVec3::Y * 0.1].map(|at| photon(at + DVec3::Y * 0.3 * f64::from(row / 4), Vec3::Z))
        })
        .collect();
    let map = PhotonMap::new(photons, 1).unwrap();
    let radii = map.radii(1, 0.25);
    let ray = Ray::new(DVec3::new(0.05, 0.06, 0.0), DVec3::Z);
    let span = Interval { start: 0.0, end: 1.0 };
    let wall = Rectangle::new(DVec3::new(0.1, 0.0, 0.0), DVec3::Y, DVec3::Z * 0.5).unwrap();
    let walls = [Shape::Rectangle(wall)];
    let known = Boundary::of(&whole).unwrap();
    for boundary in [known, known.about(&walls)] {
        for is_clipped in [true, false] {
            for kernel in Kernel::ALL {
                let fixed = RayEstimator { is_clipped, ..reading(kernel, 0.1) };
                let own = RayEstimator { is_clipped, ..reading(kernel, 0.25) };
                let all = |_| Spectrum::ONE;
                let expected = fixed.radiance(&map, (&ray, span), &even, &boundary, &all);
                let found = own.radiance_by_radii((&map, &radii), (&ray, span), &even, &boundary, &all);
                assert!(expected.found > 4 && found.found == expected.found, "{kernel:?}");
                let ratio = found.value[0] / expected.value[0];
                assert!((ratio - 1.0).abs() < 1e-5, "{kernel:?} {is_clipped}: {ratio}");
            }
        }
    }
}

/// Copies of a cell have the radii of the photons that they stand for: a ray through the cell's edge reads as one through its middle of
/// photons that are moved by half a cell.
#[test]
fn copies_of_a_cell_have_their_radii() {
    let side = DVec2::new(2.0, 3.0);
    let mut stream = Stream::new(18, Purpose::Synthetic, 0, 0);
    let here: Vec<Photon> =
        (0..400).map(|_| photon(DVec3::from(stream.triple()) * side.extend(1.0), Vec3::Z)).collect();
    let half = (0.5 * side).extend(0.0);
    let moved = here.iter().map(|one| {
        let position = turbid::math::wrap(one.position + half, side);
        Photon { position, ..*one }
    });
    let even = homogeneous(Spectrum::ONE, Spectrum::ONE, 0.0);
    let of = |photons: Vec<Photon>| {
        PhotonMap::periodic(vec![photons.into()], 1, Some((side, 0.5)), &NoProgress).unwrap()
    };
    let maps = [of(here.clone()), of(moved.collect())];
    let mut found = 0;
    for dir in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, -0.8, 0.6)] {
        let span = Interval { start: 0.0, end: 1.0 };
        let read = |(map, origin): (&PhotonMap, DVec3)| {
            let radii = map.radii(6, 0.5);
            let ray = Ray::new(origin, dir);
            reading(Kernel::Cone, 0.5).radiance_by_radii(
                (map, &radii),
                (&ray, span),
                &even,
                &Boundary::UNKNOWN,
                &|_| Spectrum::ONE,
            )
        };
        let [edge, middle] = [read((&maps[0], DVec3::ZERO)), read((&maps[1], half))];
        assert_eq!(edge.found, middle.found, "{dir}");
        assert!((edge.value[0] / middle.value[0] - 1.0).abs() < 1e-4, "{edge:?} {middle:?}");
        found += edge.found;
    }
    assert!(found > 20, "{found}");
    assert!(maps[0].radii(6, 0.6).largest() <= 0.6);
}
