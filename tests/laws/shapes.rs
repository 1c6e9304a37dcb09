//! Shapes: hits, intervals and insides agree; area and volume by sampling.

use crate::common::config as properties;
use crate::support::run::numbers;
use crate::support::scenes::{cuboid, layer, rectangle, sphere};
use crate::support::{unit_vector, verdict};
use glam::DVec3;
use proptest::prelude::*;
use turbid::geometry::{Face, Shape};
use turbid::math::{Frame, Ray, warp};

fn coordinate() -> impl Strategy<Value = f64> {
    -4.0..4.0f64
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn direction() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        (-1.0..=1.0f64, 0.0..6.3f64).prop_map(|(z, azimuth)| unit_vector(z, azimuth)),
        prop::sample::select(vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]),
        (-1e-9..1e-9f64, 0.0..6.3f64).prop_map(|(z, azimuth)| unit_vector(z, azimuth)),
    ]
}

fn solid() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (point(), 0.01..3.0f64).prop_map(|(c, r)| sphere(c, r)),
        (point(), 0.01..3.0f64, 0.01..3.0f64, 0.01..3.0f64)
            .prop_map(|(min, x, y, z)| cuboid(min, min + DVec3::new(x, y, z))),
        (0.01..3.0f64).prop_map(layer),
    ]
}

/// Lengths here are below 20: positions round to 20 eps, and a hit at cosine c to the surface to that over c, for a
/// sphere of radius r to at most sqrt(20 eps r).
const NEAR: f64 = 1e-6;

proptest! {
    #![proptest_config(properties(20_000))]

    #[test]
    fn intervals_are_what_is_inside(shape in solid(), origin in point(), dir in direction()) {
        let ray = Ray::new(origin, dir);
        match shape.interval(&ray) {
            None => {
                for i in 0..200 {
                    let p = ray.at(f64::from(i) * 0.1);
                    // A tangent may touch within rounding: then the point a little deeper tells.
                    prop_assert!(!shape.contains(p) || is_near_boundary(&shape, p), "{p}");
                }
            }
            Some(inside) => {
                prop_assert!(inside.start >= 0.0 && inside.end > inside.start);
                let end = inside.end.min(inside.start + 1e3);
                for part in [0.001, 0.3, 0.5, 0.999] {
                    let p = ray.at(inside.start + part * (end - inside.start));
                    prop_assert!(shape.contains(p) || is_near_boundary(&shape, p), "{p}");
                }
                if inside.start > 0.0 {
                    prop_assert!(is_near_boundary(&shape, ray.at(inside.start)));
                    let p = ray.at(0.5 * inside.start);
                    prop_assert!(!shape.contains(p) || is_near_boundary(&shape, p), "{p} before entry");
                } else {
                    prop_assert!(shape.contains(origin) || is_near_boundary(&shape, origin));
                }
                if inside.end.is_finite() {
                    let p = ray.at(inside.end * 1.5 + 0.1);
                    prop_assert!(!shape.contains(p) || is_near_boundary(&shape, p), "{p} after exit");
                }
            }
        }
    }

    #[test]
    fn hits_are_the_ends_of_intervals(shape in solid(), origin in point(), dir in direction()) {
        let ray = Ray::new(origin, dir);
        let inside = shape.interval(&ray).filter(|i| i.start > 0.0 || i.end.is_finite());
        let hit = shape.hit(&ray, None);
        prop_assert_eq!(hit.map(|h| h.t), inside.map(|i| if i.start > 0.0 { i.start } else { i.end }));
        if let (Some(hit), Some(inside)) = (hit, inside) {
            prop_assert!((hit.normal.length() - 1.0).abs() < 4.0 * f64::EPSILON);
            // Entering against the outward normal, leaving along it.
            let cosine = hit.normal.dot(dir);
            prop_assert!(if inside.start > 0.0 { cosine < 1e-7 } else { cosine > -1e-7 }, "{cosine}");
            let p = ray.at(hit.t);
            prop_assert!(is_near_boundary(&shape, p), "{p}");
            prop_assert!(is_outward(&shape, p, hit.normal), "{p}: {}", hit.normal);
        }
    }

    /// From a point on the surface: inwards the far side is met, outwards nothing; the near side never.
    #[test]
    fn a_ray_from_here_meets_the_far_side_only(shape in solid(), u in prop::array::uniform3(0.0..1.0f64), cosine in 0.001..1.0f64, azimuth in 0.0..6.3f64, inwards: bool, is_top: bool) {
        let face = if is_top { Face::Top } else { Face::Bottom };
        let (p, outward, _) = shape.sample_boundary(face, glam::DVec2::splat(4.0), u);
        let cosine = if inwards { -cosine } else { cosine };
        let dir = Frame::new(outward).to_world(unit_vector(cosine, azimuth)).normalize();
        let found = shape.hit(&Ray::new(p, dir), Some(0));
        if cosine > 0.0 {
            prop_assert_eq!(found, None);
        } else {
            let middle = Ray::new(p, dir).at(1e-4);
            let is_thin = !shape.contains(middle);
            let far = found.unwrap();
            prop_assert!(far.t > 0.0 && is_near_boundary(&shape, p + dir * far.t));
            prop_assert!(far.normal.dot(dir) > 0.0);
            if !is_thin {
                let expected = 1e-4 + shape.hit(&Ray::new(middle, dir), None).unwrap().t;
                prop_assert!((far.t - expected).abs() < 1e-9 * (1.0 + far.t), "{} {expected}", far.t);
            }
        }
    }

    #[test]
    fn rectangles_are_hit_where_they_are(corner in point(), dir in direction(), a in -0.5..1.5f64, b in -0.5..1.5f64,
                                          cosine in 0.001..1.0f64, azimuth in 0.0..6.3f64, from_front: bool, distance in 0.1..5.0f64, lu in 0.1..3.0f64, lv in 0.1..3.0f64) {
        let frame = Frame::new(dir);
        let r = rectangle(corner, frame.x * lu, frame.y * lv);
        let target = r.sample([a, b]);
        let away = frame.to_world(unit_vector(if from_front { cosine } else { -cosine }, azimuth)).normalize();
        // On the very edge rounding decides.
        prop_assume!([a, b].iter().all(|x| x.abs() > 1e-9 && (x - 1.0).abs() > 1e-9));
        let ray = Ray::new(target + away * distance, -away);
        let hit = Shape::Rectangle(r).hit(&ray, None);
        let is_on = (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b);
        prop_assert_eq!(hit.is_some(), is_on);
        if let Some(hit) = hit {
            prop_assert!((hit.t - distance).abs() < 1e-10 && hit.normal == r.normal(), "{}", hit.t - distance);
        }
        prop_assert_eq!(Shape::Rectangle(r).hit(&ray, Some(0)), None);
    }
}

/// Signed depth under the surface, by the shapes' definitions.
fn depth(shape: &Shape, p: DVec3) -> f64 {
    match shape {
        Shape::Sphere(s) => s.radius() - p.distance(s.center()),
        Shape::Cuboid(c) => (p - c.min()).min(c.max() - p).min_element(),
        Shape::Slab(s) => (p.z - s.top()).min(s.top() + s.thickness() - p.z),
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => f64::NAN,
    }
}

fn is_near_boundary(shape: &Shape, p: DVec3) -> bool {
    depth(shape, p).abs() < NEAR
}

/// A step along the outward normal leaves, a step against it goes deeper.
fn is_outward(shape: &Shape, p: DVec3, normal: DVec3) -> bool {
    let step = 1e-3;
    depth(shape, p + normal * step) < -0.9 * step && depth(shape, p - normal * step) > -NEAR
}

/// Volume over a box that holds the shape, by counting.
#[test]
fn volumes_by_counting() {
    let shapes = [
        sphere(DVec3::new(0.5, -0.2, 0.1), 1.2),
        cuboid(DVec3::new(-1.0, 0.0, -0.5), DVec3::new(0.5, 1.5, 1.0)),
    ];
    for shape in shapes {
        let share = numbers(1 << 18, 11, |s| {
            let [x, y, z] = s.triple();
            f64::from(u8::from(shape.contains(DVec3::new(x, y, z) * 4.0 - 2.0)))
        });
        let expected = shape.volume() / 64.0;
        verdict::agrees(&format!("{shape:?}"), &share, (expected, 0.0), 0.08 * expected, 11);
    }
}

/// Cauchy's formula ties area, volume, boundary sampling and intervals together: isotropic light that enters a
/// convex body uniformly runs 4 V/S on average. The negative control enters with directions uniform over the hemisphere.
#[test]
fn mean_chord_is_four_volumes_over_surface() {
    let shapes = [
        sphere(DVec3::new(1.0, 2.0, 3.0), 0.7),
        cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5)),
        cuboid(DVec3::ZERO, DVec3::ONE),
    ];
    for shape in shapes {
        let chord = |is_lambertian: bool, seed: u64| {
            numbers(1 << 18, seed, |s| {
                let (p, outward, _) = shape.sample_boundary(Face::Top, glam::DVec2::ZERO, s.triple());
                let u = s.pair();
                let local = if is_lambertian {
                    warp::square_to_cosine_hemisphere(u)
                } else {
                    warp::square_to_cone(u, 1.0)
                };
                let ray = Ray::new(p, Frame::new(-outward).to_world(local));
                shape.hit(&ray, Some(0)).map_or(0.0, |h| h.t)
            })
        };
        let expected = 4.0 * shape.volume() / shape.area();
        verdict::agrees(&format!("{shape:?}"), &chord(true, 12), (expected, 0.0), 0.02 * expected, 12);
        verdict::rejects(&format!("{shape:?}, negative control"), &chord(false, 13), expected, 13);
    }
    // Of a sphere also the second moment: chords have density L / (2 a^2), so that <L^2> = 2 a^2.
    let ball = sphere(DVec3::ZERO, 0.7);
    let square = numbers(1 << 18, 14, |s| {
        let (p, outward, _) = ball.sample_boundary(Face::Top, glam::DVec2::ZERO, s.triple());
        let dir = Frame::new(-outward).to_world(warp::square_to_cosine_hemisphere(s.pair()));
        ball.hit(&Ray::new(p, dir), Some(0)).map_or(0.0, |h| h.t * h.t)
    });
    verdict::agrees("<L^2> of a sphere", &square, (2.0 * 0.49, 0.0), 0.02 * 0.98, 14);
}

/// Points inside are uniform: their mean distance from the centre squared is 3/5 a^2 in a ball, and their position
/// fills a box evenly.
#[test]
fn points_inside_are_uniform() {
    let ball = sphere(DVec3::new(1.0, -2.0, 0.5), 2.0);
    let second = numbers(1 << 16, 15, |s| {
        ball.sample_inside(glam::DVec2::ZERO, s.triple()).0.distance_squared(DVec3::new(1.0, -2.0, 0.5))
    });
    verdict::agrees("<r^2> in a ball", &second, (2.4, 0.0), 0.05, 15);
    let low = DVec3::new(-1.0, 0.0, 3.0);
    let block = cuboid(low, low + DVec3::new(1.0, 2.0, 3.0));
    for axis in 0..3 {
        let mean =
            numbers(1 << 16, 16, |s| (block.sample_inside(glam::DVec2::ZERO, s.triple()).0 - low)[axis]);
        let edge = (axis + 1) as f64;
        verdict::agrees(&format!("axis {axis} of a box"), &mean, (0.5 * edge, 0.0), 0.01 * edge, 16);
        let square = numbers(1 << 16, 17, |s| {
            (block.sample_inside(glam::DVec2::ZERO, s.triple()).0 - low)[axis].powi(2)
        });
        verdict::agrees(
            &format!("axis {axis} squared"),
            &square,
            (edge * edge / 3.0, 0.0),
            0.02 * edge * edge,
            17,
        );
    }
}
