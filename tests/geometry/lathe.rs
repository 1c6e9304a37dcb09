//! Lathes: against spheres, cylinders and cones, against a fine mesh, without gaps.

use super::solids::{crossings, direction, point, stream};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use turbid::geometry::{Mesh, Revolution, Shape, Sphere, smooth};
use turbid::math::{Frame, Ray, sin_cos};

fn p(radius: f64, height: f64) -> DVec2 {
    DVec2::new(radius, height)
}

/// The axis of the lathes under test: askew.
const AXIS: DVec3 = DVec3::new(0.48, 0.6, 0.64);
const BASE: DVec3 = DVec3::new(0.3, -0.7, 0.2);

fn lathe(profile: &[DVec2]) -> Revolution {
    Revolution::new(BASE, AXIS, profile).unwrap()
}

/// A closed cylinder of radius 0.8 from height -0.5 to 1.
fn can() -> Vec<DVec2> {
    vec![p(0.0, -0.5), p(0.8, -0.5), p(0.8, 1.0), p(0.0, 1.0)]
}

/// A glass with foot, stem and hollow bowl, in `pieces` to a span.
fn glass(pieces: u32) -> Vec<DVec2> {
    let points = [
        p(0.0, 0.0),
        p(0.7, 0.0),
        p(0.7, 0.0),
        p(0.65, 0.06),
        p(0.1, 0.12),
        p(0.08, 0.7),
        p(0.5, 1.1),
        p(0.6, 1.6),
        p(0.45, 2.1),
        p(0.42, 2.12),
        p(0.41, 2.1),
        p(0.55, 1.6),
        p(0.45, 1.15),
        p(0.0, 0.8),
    ];
    smooth(&points, pieces)
}

/// The ball of radius 1 about the base, as `n` frusta with their rings on it.
fn ball(n: usize) -> Vec<DVec2> {
    let at = |i: usize| {
        let (sin, cos) = sin_cos(PI * i as f64 / n as f64);
        if i == 0 || i == n { p(0.0, -cos) } else { p(sin, -cos) }
    };
    (0..=n).map(at).collect()
}

/// A cylinder is met where planes and circles say, a cone where its quadratic does.
#[test]
fn cylinders_and_cones_in_closed_form() {
    let frame = Frame::new(AXIS);
    let solid = lathe(&can());
    let cone = lathe(&[p(0.0, 0.0), p(1.0, 0.0), p(0.0, 2.0)]);
    let mut s = stream(11);
    let (mut hits, mut cone_hits) = (0, 0);
    for i in 0..20_000 {
        let (o, d) =
            (point(&mut s) * 3.0, if i % 5 == 0 { DVec3::AXES[i / 5 % 3] } else { direction(&mut s) });
        let ray = Ray::new(BASE + frame.to_world(o), frame.to_world(d).normalize());
        // The cylinder is the part of the line within the circle and between the planes.
        let (a, b) = (d.truncate().length_squared(), o.truncate().dot(d.truncate()));
        let c = o.truncate().length_squared() - 0.64;
        let root = (b * b - a * c).sqrt();
        let (mut near, mut far) =
            if a > 0.0 { ((-b - root) / a, (-b + root) / a) } else { (f64::NEG_INFINITY, f64::INFINITY) };
        let is_within = if a > 0.0 { b * b >= a * c } else { c < 0.0 };
        if d.z != 0.0 {
            let (u, v) = ((-0.5 - o.z) / d.z, (1.0 - o.z) / d.z);
            (near, far) = (near.max(u.min(v)), far.min(u.max(v)));
        } else if !(-0.5..=1.0).contains(&o.z) {
            far = f64::NEG_INFINITY;
        }
        let expected = [near, far].into_iter().find(|t| *t > 0.0).filter(|_| is_within && near < far);
        let found = solid.hit(&ray, None);
        assert_eq!(found.map(|h| h.t > 0.0), expected.map(|t| t > 0.0), "{o} {d}");
        if let (Some(found), Some(t)) = (found, expected) {
            hits += 1;
            assert!((found.t - t).abs() < 1e-9, "{} {t}", found.t);
            assert!((found.normal.length() - 1.0).abs() < 1e-14);
            let q = o + d * t;
            let sides = [
                (q.truncate().length() - 0.8, q.with_z(0.0)),
                (-0.5 - q.z, DVec3::NEG_Z),
                (q.z - 1.0, DVec3::Z),
            ];
            let side = sides.iter().max_by(|x, y| x.0.total_cmp(&y.0)).unwrap();
            let other = sides.iter().filter(|x| x.1 != side.1).all(|x| x.0 < -1e-6);
            assert!(!other || frame.to_local(found.normal).distance(side.1.normalize()) < 1e-8, "{found:?}");
        }
        // The mantle of the cone: x^2 + y^2 = (1 - z/2)^2.
        let (k, m) = (1.0 - 0.5 * o.z, -0.5 * d.z);
        let (a, b, c) = (a - m * m, b - k * m, o.truncate().length_squared() - k * k);
        let roots = [(-b - (b * b - a * c).sqrt()) / a, (-b + (b * b - a * c).sqrt()) / a];
        let mantle = roots.into_iter().filter(|t| *t > 0.0 && (0.0..=2.0).contains(&(o.z + t * d.z)));
        let floor = Some(-o.z / d.z).filter(|t| *t > 0.0 && (o + d * *t).truncate().length() <= 1.0);
        let expected = mantle.chain(floor).fold(f64::INFINITY, f64::min);
        let found = cone.hit(&ray, None).map_or(f64::INFINITY, |h| h.t);
        cone_hits += usize::from(found.is_finite());
        assert!(found == expected || (found - expected).abs() < 1e-7, "{found} {expected}: {o} {d}");
    }
    assert!(hits > 1000 && cone_hits > 500, "{hits} {cone_hits}");
}

/// Many frusta on a ball: within the sagitta, pi^2/(8 n^2), of the sphere, with its area and volume to the same order.
#[test]
fn a_turned_ball_is_the_sphere() {
    let n = 400;
    let (turned, exact) = (lathe(&ball(n)), Shape::Sphere(Sphere::new(BASE, 1.0).unwrap()));
    let sagitta = PI * PI / (8.0 * (n * n) as f64);
    let mut s = stream(12);
    let mut hits = 0;
    for _ in 0..5000 {
        let ray = Ray::new(BASE + point(&mut s) * 2.0, direction(&mut s));
        let Some(found) = turned.hit(&ray, None) else { continue };
        let r = ray.at(found.t).distance(BASE);
        assert!(r < 1.0 + 1e-12 && r > 1.0 - sagitta - 1e-12, "{r}");
        assert!(found.normal.dot((ray.at(found.t) - BASE).normalize()) > 0.9999);
        // Where neither just touches, the distances agree.
        if found.normal.dot(ray.dir).abs() > 0.1 {
            let expected = exact.hit(&ray, None).unwrap();
            assert!((found.t - expected.t).abs() < 20.0 * sagitta, "{} {}", found.t, expected.t);
            hits += 1;
        }
    }
    assert!(hits > 500, "{hits}");
    assert!((turned.area() / (4.0 * PI) - 1.0).abs() < 4.0 * sagitta, "{}", turned.area());
    assert!((turned.volume() / (4.0 * PI / 3.0) - 1.0).abs() < 4.0 * sagitta, "{}", turned.volume());
    assert!(turned.is_closed() && lathe(&can()).is_closed() && !lathe(&can()[1..]).is_closed());
}

/// A glass as a lathe and as a mesh of the same rings with 720 meridians: hits within the meridians' sagitta.
#[test]
fn a_lathe_is_its_mesh() {
    let rings = glass(3);
    let turned = Revolution::new(DVec3::ZERO, DVec3::Z, &rings).unwrap();
    let around = 720u32;
    let mut corners = Vec::new();
    for ring in &rings {
        for j in 0..around {
            let (sin, cos) = sin_cos(TAU * f64::from(j) / f64::from(around));
            corners.push(DVec3::new(ring.x * cos, ring.x * sin, ring.y));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..rings.len() as u32 - 1 {
        for j in 0..around {
            let at = |i: u32, j: u32| i * around + j % around;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let solid = Mesh::new(&corners, &triangles, None).unwrap();
    let sagitta = 0.7 * PI * PI / (2.0 * f64::from(around * around));
    assert!(
        (turned.area() / solid.area() - 1.0).abs() < 1e-4
            && (turned.volume() / solid.volume() - 1.0).abs() < 1e-4
    );
    let mut s = stream(13);
    let mut hits = 0;
    for _ in 0..5000 {
        let origin = point(&mut s) * 2.0;
        let target = DVec3::new(0.7, 0.7, 1.0) * point(&mut s) + DVec3::Z;
        let ray = Ray::new(origin, (target - origin).normalize());
        let (found, expected) = (turned.hit(&ray, None), solid.hit(&ray, None));
        if let (Some(found), Some(expected)) = (found, expected)
            && found.normal.dot(ray.dir).abs() > 0.1
        {
            if (found.t - expected.t).abs() > 20.0 * sagitta {
                // One of the two passed a rim or an outline that the other touched.
                continue;
            }
            assert!(found.normal.dot(expected.normal) > 0.999, "{found:?} {expected:?}");
            hits += 1;
        }
    }
    assert!(hits > 2500, "{hits}");
}

/// Lines through closed lathes, aimed anywhere and at rings exactly, level ones among them: in and out by turns.
#[test]
fn closed_lathes_have_no_gaps() {
    let frame = Frame::new(AXIS);
    for (number, profile) in [can(), ball(12), ball(100), glass(1), glass(10)].iter().enumerate() {
        let solid = lathe(profile);
        let mut s = stream(14);
        let mut most = 0;
        for i in 0..4000 {
            let ring = profile[i % profile.len()];
            let (sin, cos) = sin_cos(TAU * s.unit());
            let target = match i % 4 {
                0 => DVec3::new(ring.x * cos, ring.x * sin, ring.y),
                1 => DVec3::Z * ring.y,
                _ => DVec3::new(0.6, 0.6, 1.0) * point(&mut s) + DVec3::Z,
            };
            // Level lines, but none in the plane of a flat face or through a tip.
            let has_faces = number == 0 || number >= 3;
            let is_level = i % 12 < 3 && (i % 4 == 2 || (i % 4 == 0 && !has_faces && ring.x > 0.0));
            let away = if is_level { direction(&mut s).with_z(0.0).normalize() } else { direction(&mut s) };
            let origin = BASE + frame.to_world(target + away * (5.0 + s.unit()));
            let ray = Ray::new(origin, -frame.to_world(away).normalize());
            // A line that touches a ring or a tip of the outline, or the edge of a rim, is inside for no length; in a
            // glass it may do so after other crossings.
            let touches = |h: turbid::geometry::Hit| !solid.contains(ray.at(h.t + 1e-7));
            if i % 4 < 2 && (number >= 3 || solid.hit(&ray, None).is_some_and(touches)) {
                continue;
            }
            let count = crossings(&ray, false, |ray, from| solid.hit(ray, from));
            assert!(count % 2 == 0, "{number} {i}");
            most = most.max(count);
        }
        assert!(most >= if number >= 3 { 4 } else { 2 }, "{number}: {most}");
    }
}

/// Rays from points that were sampled on the surface: to the outside or the inside as their direction says, and out.
#[test]
fn rays_that_start_on_a_lathe_stay_on_their_side() {
    for profile in [can(), ball(30), glass(6)] {
        let solid = lathe(&profile);
        let mut s = stream(15);
        for _ in 0..5000 {
            let (p, normal, primitive) = solid.sample_surface(s.pair());
            let dir = direction(&mut s);
            let is_inside = normal.dot(dir) < 0.0;
            crossings(&Ray::new(p, dir), is_inside, |ray, from| solid.hit(ray, from.or(Some(primitive))));
        }
    }
}

/// Points are uniform over the area: between frusta, along a frustum and around it.
#[test]
fn points_are_uniform_over_a_lathe() {
    let profile = [p(0.0, 0.0), p(1.0, 0.2), p(0.5, 1.0), p(0.5, 2.0), p(0.0, 2.0)];
    let solid = Revolution::new(DVec3::ZERO, DVec3::Z, &profile).unwrap();
    let n = 40_000;
    let mut s = stream(16);
    let mut counts = vec![0.0; 4 * 2 * 3];
    for _ in 0..n {
        let (p, _, k) = solid.sample_surface(s.pair());
        let (from, to) = (profile[k as usize], profile[k as usize + 1]);
        let part = (DVec2::new(p.truncate().length(), p.z) - from).length() / (to - from).length();
        let around = (turbid::math::atan2(p.y, p.x) / TAU).rem_euclid(1.0);
        counts[k as usize * 6 + usize::from(part > 0.5) * 3 + ((3.0 * around) as usize).min(2)] += 1.0;
    }
    // The two halves of a frustum have areas as their mean radii.
    let area = |k: usize, half: usize| {
        let (from, to) = (profile[k], profile[k + 1]);
        let middle = (from + to) * 0.5;
        let (a, b) = if half == 0 { (from, middle) } else { (middle, to) };
        PI * (a.x + b.x) * a.distance(b)
    };
    let total: f64 = (0..4).flat_map(|k| [area(k, 0), area(k, 1)]).sum();
    assert!((total / solid.area() - 1.0).abs() < 1e-14);
    let expected: Vec<f64> = (0..24).map(|i| f64::from(n) * area(i / 6, i / 3 % 2) / (3.0 * total)).collect();
    verdict::fits("lathe points", verdict::counted(&counts, &expected), 0.05, 16);
}

#[test]
fn bad_profiles_are_refused() {
    let say = |profile: &[DVec2]| Revolution::new(DVec3::ZERO, DVec3::Z, profile).unwrap_err().to_string();
    assert_eq!(
        say(&[p(0.1, 0.0), p(-0.1, 1.0)]),
        "radius of a profile is -0.1; allowed: finite and at least 0"
    );
    assert_eq!(say(&[p(0.1, f64::NAN), p(0.1, 1.0)]), "height of a profile is NaN; allowed: finite");
    for profile in [&[][..], &[p(1.0, 0.0)], &[p(1.0, 0.0), p(1.0, 0.0)], &[p(0.0, 0.0), p(0.0, 1.0)]] {
        assert_eq!(say(profile), "a profile needs two points that are not both on the axis");
    }
    assert!(
        Revolution::new(DVec3::ZERO, DVec3::ZERO, &can()).is_err()
            && Revolution::new(DVec3::NAN, DVec3::Z, &can()).is_err()
    );
}
