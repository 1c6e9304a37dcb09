//! The distance from a point to a surface, against the nearest of many points of it.

use glam::{DVec2, DVec3};
use std::sync::Arc;
use turbid::geometry::{Cuboid, Ground, Rectangle, Revolution, Shape, Slab, Sphere, Up, height_field};
use turbid::math::{Ray, warp::square_to_sphere};
use turbid::rng::{Purpose, Stream};

fn shapes() -> Vec<Shape> {
    let ground = Ground { corner: DVec2::splat(-1.0), size: DVec2::splat(2.0), cells: [9, 7] };
    let hills =
        height_field(&ground, Up::Z, None, |p| 0.2 * libm::sin(5.0 * p.x) * libm::cos(4.0 * p.y)).unwrap();
    let profile = [[0.0, -0.5], [0.4, -0.5], [0.6, 0.1], [0.2, 0.3], [0.3, 0.6], [0.0, 0.7]].map(DVec2::from);
    let lathe = Revolution::new(DVec3::new(0.1, 0.2, 0.0), DVec3::new(1.0, 2.0, 3.0), &profile).unwrap();
    let tilted = Rectangle::new(
        DVec3::new(-0.3, 0.1, 0.2),
        DVec3::new(0.6, 0.8, 0.0),
        DVec3::new(-0.8, 0.6, 0.5).cross(DVec3::new(0.6, 0.8, 0.0)),
    );
    vec![
        Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.0, -0.2), 0.7).unwrap()),
        Shape::Rectangle(tilted.unwrap()),
        Shape::Cuboid(Cuboid::new(DVec3::new(-0.4, -0.6, -0.2), DVec3::new(0.5, 0.3, 0.7)).unwrap()),
        Shape::Mesh(Arc::new(hills)),
        Shape::Revolution(Arc::new(lathe)),
    ]
}

#[test]
fn distances_by_points_of_the_surface() {
    const POINTS: u32 = 20_000;
    for shape in shapes() {
        let mut stream = Stream::new(7, Purpose::Synthetic, 0, 0);
        let on: Vec<DVec3> = (0..POINTS).map(|_| shape.sample_surface(stream.triple()).0).collect();
        // No point of the surface is farther from one of these but with a probability of e^-15, an edge or a corner
        // counted as a quarter of a disc.
        let gap = (60.0 * shape.area() / std::f64::consts::PI / f64::from(POINTS)).sqrt();
        for _ in 0..200 {
            let p = DVec3::from(stream.triple()) * 3.0 - 1.5;
            let nearest = on.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            let found = shape.distance(p, f64::INFINITY);
            assert!(found <= nearest * (1.0 + 1e-12), "{shape:?} at {p}: {found}, not {nearest}");
            assert!(found >= nearest - gap, "{shape:?} at {p}: {found}, not {nearest}");
            // A limit is what is answered beyond it, and nothing else changes.
            assert_eq!(shape.distance(p, 0.5 * found), 0.5 * found);
            assert_eq!(shape.distance(p, 2.0 * found), found);
        }
        for q in &on[..100] {
            assert!(shape.distance(*q, 1.0) < 1e-12, "{shape:?} at {q}");
        }
    }
    let slab = Shape::Slab(Slab::new(1.0, 2.0).unwrap());
    for (z, expected) in [(0.5, 0.5), (1.0, 0.0), (1.7, 0.7), (2.5, 0.5), (4.0, 1.0)] {
        assert_eq!(slab.distance(DVec3::new(3.0, -7.0, z), 9.0), expected);
    }
}

/// Where a ray has room about it, place by place: of solid shapes from inside and outside, and nowhere of others.
#[test]
fn rays_with_room() {
    let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
    let mut counts = [0; 2];
    for shape in shapes().into_iter().chain([Shape::Slab(Slab::new(-0.5, 1.0).unwrap())]) {
        for _ in 0..300 {
            let ray = Ray::new(DVec3::from(stream.triple()) * 3.0 - 1.5, square_to_sphere(stream.pair()));
            let least = 0.4 * stream.unit();
            let found = shape.interval_with_room(&ray, least);
            for _ in 0..20 {
                let t = 4.0 * stream.unit();
                let is_roomy = shape.room(ray.at(t)) >= least;
                counts[usize::from(is_roomy)] += 1;
                assert_eq!(
                    found.is_some_and(|part| part.start <= t && t <= part.end),
                    is_roomy,
                    "{shape:?} {t}"
                );
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 500), "{counts:?}");
}

/// What is between two points, where a ray ends, and what lies behind the front, by hits and points of the surface.
#[test]
fn ways_by_hits() {
    for shape in shapes() {
        let mut stream = Stream::new(8, Purpose::Synthetic, 0, 0);
        let on: Vec<DVec3> = (0..500).map(|_| shape.sample_surface(stream.triple()).0).collect();
        let (mut crossed, mut fronts) = (0, 0);
        for _ in 0..2000 {
            let [a, b] = [0; 2].map(|_| DVec3::from(stream.triple()) * 3.0 - 1.5);
            let ray = Ray::new(a, (b - a).normalize());
            let end = a.distance(b);
            let hit = shape.hit(&ray, None).map_or(f64::INFINITY, |hit| hit.t);
            assert_eq!(shape.is_between(a, b), hit < end, "{shape:?} from {a} to {b}");
            assert!((shape.until(&ray, end) - hit.min(end)).abs() < 1e-14, "{shape:?} from {a} to {b}");
            crossed += usize::from(hit < end);
            if let Some(front) = shape.front(a) {
                fronts += 1;
                assert!(front.normal.is_normalized() && front.distance > 0.0);
                assert!(front.distance <= shape.distance(a, f64::INFINITY) * (1.0 + 1e-12));
                assert!(on.iter().all(|p| front.height(*p - a) < 1e-12), "{shape:?} from {a}");
                assert!(
                    shape.is_behind(a, &front, 1e-12)
                        || matches!(shape, Shape::Sphere(_) | Shape::Revolution(_) | Shape::Mesh(_))
                );
            }
        }
        assert!(crossed > 50 && fronts > 200, "{shape:?}: {crossed} {fronts}");
    }
}

/// A ball is parted by a face where points of it beside the face's plane are parted by the shape.
#[test]
fn balls_parted_by_a_face() {
    for shape in shapes() {
        let mut stream = Stream::new(9, Purpose::Synthetic, 0, 0);
        let mut parted = 0;
        for _ in 0..4000 {
            let p = DVec3::from(stream.triple()) * 2.0 - 1.0;
            let radius = 0.5 * stream.unit();
            if !shape.parts_ball(p, radius) {
                continue;
            }
            parted += 1;
            let front = shape.front(p).unwrap();
            for _ in 0..20 {
                let way = square_to_sphere(stream.pair()) * (radius * stream.unit());
                if front.height(way) < 0.0 {
                    assert!(shape.is_between(p, p + way), "{shape:?} from {p} by {way}");
                }
            }
        }
        let is_flat = matches!(shape, Shape::Rectangle(_) | Shape::Cuboid(_));
        assert_eq!(parted > 20, is_flat, "{shape:?}: {parted}");
    }
}
