//! The distance from a point to a surface, against the nearest of many points of it.

use glam::{DVec2, DVec3};
use std::sync::Arc;
use turbid::geometry::{Cuboid, Ground, Lathe, Rectangle, Shape, Slab, Sphere, Up, height_field};
use turbid::rng::{Purpose, Stream};

fn shapes() -> Vec<Shape> {
    let ground = Ground { corner: DVec2::splat(-1.0), size: DVec2::splat(2.0), cells: [9, 7] };
    let hills =
        height_field(&ground, Up::Z, None, |p| 0.2 * libm::sin(5.0 * p.x) * libm::cos(4.0 * p.y)).unwrap();
    let profile = [[0.0, -0.5], [0.4, -0.5], [0.6, 0.1], [0.2, 0.3], [0.3, 0.6], [0.0, 0.7]].map(DVec2::from);
    let lathe = Lathe::new(DVec3::new(0.1, 0.2, 0.0), DVec3::new(1.0, 2.0, 3.0), &profile).unwrap();
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
        Shape::Lathe(Arc::new(lathe)),
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
