//! Meshes: against exact shapes and brute force, without gaps, at all sizes.

use super::solids::{crossings, cube, direction, icosphere, mesh, point, stream};
use crate::support::scenes::octahedron;
use crate::support::verdict;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use turbid::geometry::{Cuboid, Mesh, Revolution, Shape};
use turbid::math::{Ray, sin_cos};

/// Where meshes are put: a scale and an offset.
const PLACES: [(f64, f64); 6] = [(1.0, 0.0), (1.0, 1e6), (1e-6, 0.0), (1e-6, 1.0), (1e30, 0.0), (1e-60, 0.0)];

/// What a coordinate at a place is rounded to, in units of the shape: a few units in the last place of the largest.
fn rounding(scale: f64, offset: f64) -> f64 {
    16.0 * f64::EPSILON * (4.0 + offset / scale)
}

/// A mesh of a box is met where the box is, along axes, diagonals and anything between.
#[test]
fn a_box_of_triangles_is_the_box() {
    for (scale, offset) in PLACES {
        let offset = DVec3::new(offset, -offset, offset);
        let place = |p: DVec3| p * scale + offset;
        let solid = mesh(&cube(|p| p), place);
        let exact = Shape::Cuboid(Cuboid::new(place(-DVec3::ONE), place(DVec3::ONE)).unwrap());
        let mut s = stream(1);
        let allowed = rounding(scale, offset.x) * scale;
        for i in 0..2000 {
            let origin = place(point(&mut s) * 3.0);
            let dir = match i % 4 {
                0 => DVec3::AXES[i / 4 % 3] * if i % 8 == 0 { 1.0 } else { -1.0 },
                1 => DVec3::new(1.0, -1.0, 0.0).normalize() * if i % 8 == 1 { 1.0 } else { -1.0 },
                _ => direction(&mut s),
            };
            let ray = Ray::new(origin, dir);
            let (found, expected) = (solid.hit(&ray, None), exact.hit(&ray, None));
            assert_eq!(found.is_some(), expected.is_some(), "{ray:?} at {scale} {offset}");
            if let (Some(found), Some(expected)) = (found, expected) {
                // A grazing line turns rounding across the face into distance along the line.
                let cosine = found.normal.dot(dir).abs();
                assert!((found.t - expected.t).abs() * cosine <= allowed, "{} {}", found.t, expected.t);
                assert!(found.normal.distance(expected.normal) < 1e-6, "{found:?} {expected:?}");
                assert!(found.uv.min_element() >= 0.0 && found.uv.max_element() <= 1.0);
            }
        }
    }
}

/// The negative control's way: every triangle in turn, by the textbook's determinants (Moller and Trumbore 1997).
fn brute_force(solid: &Mesh, ray: &Ray) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for i in 0..solid.len() {
        let [a, b, c] = solid.triangle(i as u32);
        let (e1, e2, s) = (b - a, c - a, ray.origin - a);
        let h = ray.dir.cross(e2);
        let determinant = e1.dot(h);
        let (u, q) = (s.dot(h) / determinant, s.cross(e1));
        let (v, t) = (ray.dir.dot(q) / determinant, e2.dot(q) / determinant);
        let inside = u.min(v).min(1.0 - u - v);
        if inside >= 0.0 && t > 0.0 && best.is_none_or(|(nearest, _)| t < nearest) {
            best = Some((t, inside));
        }
    }
    best
}

/// Random triangles of all sizes, slivers among them: the tree finds what brute force finds.
#[test]
fn the_tree_finds_what_brute_force_finds() {
    for (seed, count, longest) in [(1u64, 1, 1.0), (2, 2, 1.0), (3, 9, 2.0), (4, 100, 0.5), (5, 400, 0.2)] {
        let mut s = stream(seed);
        let mut corners = Vec::new();
        for i in 0..count {
            let (a, size) = (point(&mut s), longest * libm::pow(10.0, -3.0 * s.unit()));
            let b = a + direction(&mut s) * size;
            let c = if i % 5 == 4 {
                b + (a - b) * 0.5 + direction(&mut s) * (1e-6 * size)
            } else {
                a + point(&mut s) * size
            };
            corners.extend([a, b, c]);
        }
        let triangles: Vec<[u32; 3]> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let soup = Mesh::new(&corners, &triangles, None).unwrap();
        let (mut hits, mut misses) = (0, 0);
        for i in 0..2000 {
            let k = i % count * 3;
            let [u, v] = s.pair();
            let target = corners[k] + (corners[k + 1] - corners[k]) * u + (corners[k + 2] - corners[k]) * v;
            let origin = point(&mut s) * if i % 7 == 0 { 1e4 } else { 2.0 };
            let ray = Ray::new(origin, (target - origin).normalize());
            let (found, expected) = (soup.hit(&ray, None), brute_force(&soup, &ray));
            let end = 3.0 * s.unit();
            assert_eq!(soup.blocks(&ray, None, end), found.is_some_and(|f| f.t < end), "{ray:?} {end}");
            match (found, expected) {
                (Some(found), Some((t, _))) if (found.t - t).abs() <= 1e-7 * (1.0 + t) => hits += 1,
                (None, None) => misses += 1,
                // The two decide differently within rounding of an edge, and nowhere else.
                (found, Some((t, inside))) => {
                    assert!(
                        inside < 1e-6 || found.is_some_and(|f| f.t < t),
                        "{found:?} {t} {inside} {ray:?}"
                    );
                }
                (Some(found), None) => {
                    let [a, b, c] = soup.triangle(found.primitive);
                    let p = ray.at(found.t);
                    let sum = (b - a).cross(c - a).length();
                    let parts = [(a, b), (b, c), (c, a)].map(|(x, y)| (x - p).cross(y - p).length());
                    assert!((parts.iter().sum::<f64>() - sum).abs() < 1e-6 * (a - b).length(), "{found:?}");
                }
            }
        }
        assert!(hits >= 20 && hits + misses >= 1990, "{hits} {misses} of {count}");
    }
}

/// Lines through a closed mesh, aimed anywhere, at edges and at corners exactly, from inside and outside: they cross it
/// inwards and outwards by turns and end outside, at every size and place.
#[test]
fn closed_meshes_have_no_gaps() {
    let ball = icosphere(3);
    for (scale, offset) in PLACES {
        let offset = DVec3::new(offset, offset, -offset);
        let place = |p: DVec3| p * scale + offset;
        let solid = mesh(&ball, place);
        assert!(solid.is_closed());
        let mut s = stream(2);
        for i in 0..3000usize {
            let triangle = ball.1[i * 7 % ball.1.len()].map(|k| ball.0[k as usize]);
            let target = match i % 3 {
                0 => triangle[0],
                1 => triangle[0] + (triangle[1] - triangle[0]) * s.unit(),
                _ => point(&mut s),
            };
            let is_inside = i % 2 == 0;
            let origin =
                if is_inside { point(&mut s) * 0.5 } else { direction(&mut s) * (1.5 + 100.0 * s.unit()) };
            let ray = Ray::new(place(origin), ((place(target) - place(origin)) / scale).normalize());
            if i % 3 < 2 && target.normalize().dot(ray.dir).abs() < 0.3 {
                // A line that touches an edge of the outline is inside for no length.
                continue;
            }
            let count = crossings(&ray, is_inside, |ray, from| solid.hit(ray, from));
            assert!(count % 2 == usize::from(is_inside) && count <= 2, "{count}");
        }
    }
}

/// A star has ridges and hollows, and is crossed many times: rays that start on it, everywhere and in all directions,
/// nearly along it too, end outside.
#[test]
fn rays_that_start_on_a_mesh_stay_on_their_side() {
    let (mut corners, triangles) = icosphere(2);
    corners[..12].iter_mut().for_each(|p| *p *= 2.0);
    for (scale, offset) in PLACES {
        let star = mesh(&(corners.clone(), triangles.clone()), |p| p * scale + DVec3::splat(offset));
        let mut s = stream(3);
        for i in 0..2000 {
            let (mut p, normal, primitive) = star.sample_surface(s.pair());
            let [a, b, _] = star.triangle(primitive);
            if i % 2 == 0 {
                // As near the edge as can be.
                p = a + (b - a) * s.unit();
            }
            let mut dir = direction(&mut s);
            if i % 8 < 2 {
                dir = (dir - normal * (dir.dot(normal) * 0.999)).normalize();
            }
            // Of a direction between the planes of both neighbours of an edge the side is not that of the start.
            let beside = beside(&star, primitive, [a, b]);
            let sides = [normal, beside].map(|n| n.dot(dir));
            if sides[0].abs() < 1e-9 || (i % 2 == 0 && sides[0] * sides[1] <= 1e-9) {
                continue;
            }
            let ray = Ray::new(p, dir);
            crossings(&ray, sides[0] < 0.0, |ray, from| star.hit(ray, from.or(Some(primitive))));
        }
    }
}

/// Normal of the other triangle at an edge.
fn beside(solid: &Mesh, primitive: u32, edge: [DVec3; 2]) -> DVec3 {
    let shares = |i: &u32| *i != primitive && edge.iter().all(|p| solid.triangle(*i).contains(p));
    let other = (0..solid.len() as u32).find(shares).unwrap();
    let [a, b, c] = solid.triangle(other);
    (b - a).normalize().cross((c - a).normalize()).normalize()
}

/// The first hit from a convex mesh: none outwards, one inwards.
#[test]
fn a_convex_mesh_is_not_met_from_its_outside() {
    let solid = mesh(&icosphere(2), |p| p * 3.0 + 1e3);
    let mut s = stream(4);
    for _ in 0..20_000 {
        let (p, normal, primitive) = solid.sample_surface(s.pair());
        let dir = direction(&mut s);
        let found = solid.hit(&Ray::new(p, dir), Some(primitive));
        if dir.dot(normal) > 0.0 {
            assert!(found.is_none(), "{found:?}");
        } else {
            assert!(found.unwrap().normal.dot(dir) > 0.0, "{found:?}");
        }
    }
}

/// Areas and volumes tend to the sphere's from below, in proportion to the square of the edges: a mean square chord sagitta
/// leaves 1 - A / (4 pi) = (h^2) (const), so that two levels extrapolate to the sphere's.
#[test]
fn areas_and_volumes() {
    use std::f64::consts::PI;
    let at = |levels: u32| {
        let solid = mesh(&icosphere(levels), |p| p * 2.0 + 5.0);
        (solid.area(), solid.volume())
    };
    let ((a3, v3), (a4, v4)) = (at(4), at(5));
    let (area, volume) = (a4 + (a4 - a3) / 3.0, v4 + (v4 - v3) / 3.0);
    assert!(a3 < a4 && a4 < 16.0 * PI && (area / (16.0 * PI) - 1.0).abs() < 1e-5, "{area}");
    assert!(v3 < v4 && (volume / (32.0 * PI / 3.0) - 1.0).abs() < 1e-5, "{volume}");
    let block = mesh(&cube(|p| p), |p| p * DVec3::new(0.5, 1.0, 1.5));
    assert!((block.volume() - 6.0).abs() < 1e-14 && (block.area() - 22.0).abs() < 1e-13);
    assert_eq!((block.shortest_extent(), block.len(), block.dropped()), (1.0, 12, 0));
    let inside = stream_points(&block);
    assert!((inside - 6.0 / 64.0).abs() < 5.0 * (6.0f64 / 64.0 / 20_000.0).sqrt(), "{inside}");
    let open = Mesh::new(&cube(|p| p).0, &cube(|p| p).1[1..], None).unwrap();
    assert!(block.is_closed() && !open.is_closed());
}

/// Share of points of a cube of side 4 that the mesh contains; each as the exact box says.
fn stream_points(block: &Mesh) -> f64 {
    let mut s = stream(5);
    let exact = Cuboid::new(DVec3::new(-0.5, -1.0, -1.5), DVec3::new(0.5, 1.0, 1.5)).unwrap();
    let mut count = 0;
    for _ in 0..20_000 {
        let p = point(&mut s) * 2.0;
        assert_eq!(block.contains(p), Shape::Cuboid(exact).contains(p), "{p}");
        count += u32::from(block.contains(p));
    }
    f64::from(count) / 20_000.0
}

/// Inside and outside are told apart from every place of a lattice that bodies of round numbers share: an octahedron and a double
/// cone, whose edges and tips lie where rays in directions of rational ratios meet them.
#[test]
fn places_on_a_lattice_are_inside_or_outside() {
    let (corners, faces) = octahedron();
    let octahedron = Mesh::new(&corners, &faces, None).unwrap();
    assert!(octahedron.is_closed() && octahedron.volume() > 0.0);
    let profile = [DVec2::new(0.0, -1.0), DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)];
    let cones = Revolution::new(DVec3::ZERO, DVec3::Z, &profile).unwrap();
    for parts in [16, 25, 26] {
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(parts) - 2.0;
        let side = 4 * parts;
        for place in 0..side * side * side {
            let (i, j, k) = (place / (side * side), place / side % side, place % side);
            let p @ DVec3 { x, y, z } = DVec3::new(at(i), at(j), at(k));
            let (mesh, lathe) = (p.abs().element_sum() - 1.0, libm::hypot(x, y) + z.abs() - 1.0);
            // Rounding decides of places on a face.
            assert!(mesh.abs() < 1e-9 || octahedron.contains(p) == (mesh < 0.0), "octahedron, {p}");
            assert!(lathe.abs() < 1e-9 || cones.contains(p) == (lathe < 0.0), "cones, {p}");
        }
    }
}

/// Points fall on triangles in proportion to their areas, and evenly within them; the negative control takes triangles alike.
#[test]
fn points_are_uniform_over_the_area() {
    let corners: Vec<DVec3> =
        (0..12).map(|i| DVec3::new(f64::from(i), f64::from(i * i % 7), f64::from(i % 3))).collect();
    let triangles: Vec<[u32; 3]> = (0..10).map(|i| [i, i + 1, i + 2]).collect();
    let solid = Mesh::new(&corners, &triangles, None).unwrap();
    let n = 100_000;
    let mut s = stream(6);
    // Four cells a triangle: the three corners' and the middle one, all of a quarter of the area.
    let mut counts = vec![0.0; 4 * solid.len()];
    for _ in 0..n {
        let (p, normal, primitive) = solid.sample_surface(s.pair());
        let [a, b, c] = solid.triangle(primitive);
        let area = (b - a).cross(c - a);
        let part = |x: DVec3, y: DVec3| (x - p).cross(y - p).dot(area) / area.length_squared();
        let weights = [part(b, c), part(c, a), part(a, b)];
        assert!(weights.iter().all(|w| *w > -1e-12) && (p - a).dot(normal).abs() < 1e-12);
        let cell = weights.iter().position(|w| *w > 0.5).unwrap_or(3);
        counts[4 * primitive as usize + cell] += 1.0;
    }
    let share = |i: u32| {
        let [a, b, c] = solid.triangle(i);
        0.5 * (b - a).cross(c - a).length() / solid.area()
    };
    let expected = |share: &dyn Fn(u32) -> f64| -> Vec<f64> {
        (0..4 * solid.len() as u32).map(|cell| f64::from(n) * 0.25 * share(cell / 4)).collect()
    };
    verdict::fits("mesh points", verdict::counted(&counts, &expected(&share)), 0.05, 6);
    verdict::misfits("mesh points, alike", verdict::counted(&counts, &expected(&|_| 0.1)), 6);
}

/// Surface parameters run linearly over a triangle, from the file's `vt`.
#[test]
fn surface_parameters_are_interpolated() {
    let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0];
    let uvs = [[DVec2::new(0.25, 0.5), DVec2::new(0.75, 0.5), DVec2::new(0.25, 1.0)]];
    let solid = Mesh::new(&corners, &[[0, 1, 2]], Some(&uvs)).unwrap();
    let found = solid.hit(&Ray::new(DVec3::new(0.5, 1.0, 3.0), DVec3::NEG_Z), None).unwrap();
    assert!(
        (found.uv - DVec2::new(0.375, 0.75)).length() < 1e-15 && found.t == 3.0 && found.normal == DVec3::Z
    );
}

/// What is no mesh is refused, and triangles without area are counted.
#[test]
fn bad_meshes_are_refused() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
    let say = |corners: &[DVec3], triangles: &[[u32; 3]]| {
        Mesh::new(corners, triangles, None).unwrap_err().to_string()
    };
    assert_eq!(say(&corners, &[[0, 1, 4]]), "a triangle names corner 4; allowed: 0 to 3");
    assert_eq!(say(&corners, &[]), "a mesh needs a triangle with an area; here none of 0");
    assert_eq!(say(&corners, &[[0, 1, 3]]), "a mesh needs a triangle with an area; here none of 1");
    assert_eq!(say(&[DVec3::NAN, DVec3::X, DVec3::Y], &[[0, 1, 2]]), "corner 1 of a mesh is not finite");
    assert!(
        say(&corners.map(|p| p * 1e120), &[[0, 1, 2]]).starts_with("half the extent of all triangles is")
    );
    let solid = Mesh::new(&corners, &[[0, 1, 2], [0, 1, 3], [1, 1, 2]], None).unwrap();
    assert_eq!((solid.len(), solid.dropped()), (1, 2));
    // Many in one place are one, however their corners are named.
    let mut named = [[0, 1, 2], [1, 2, 0], [2, 1, 0], [4, 1, 2]].repeat(30_000);
    named.push([0, 1, 5]);
    let [a, b, c, _] = corners;
    let same = Mesh::new(&[a, b, c, a, a * -1.0, a + b + c], &named, None).unwrap();
    let found = same.hit(&Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z), None).unwrap();
    assert!((found.t - 1.0).abs() < 1e-15 && (same.len(), same.dropped()) == (2, 119_999));
    // Many alike, with nothing that single precision tells apart.
    let alike: Vec<DVec3> =
        (1..=10_000).map(|i| a + DVec3::X * (1e-300 * f64::from(i))).chain([b, c]).collect();
    let fan = |count: u32| (0..count).map(|i| [i, 10_000, 10_001]).collect::<Vec<_>>();
    assert_eq!(Mesh::new(&alike, &fan(30), None).unwrap().len(), 30);
    assert!(say(&alike, &fan(10_000)).contains("nested too deeply"));
    // A fine ball is none of those, however small it is beside the rest.
    let mut corners = vec![DVec3::new(-3.0, 0.0, 0.0), DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
    let mut triangles = vec![[0, 1, 2]];
    for (i, j) in (0..=30).flat_map(|i| (0..60).map(move |j| (i, j))) {
        let ((s, c), (t, u)) = (sin_cos(PI * f64::from(i) / 30.0), sin_cos(TAU * f64::from(j) / 60.0));
        corners.push(DVec3::new(1.5, 0.3123, 0.2017) + 1e-6 * DVec3::new(s * u, s * t, c));
        if i < 30 {
            let [a, b] = [j, (j + 1) % 60].map(|j| 3 + 60 * i + j);
            triangles.extend([[a, a + 60, b], [b, a + 60, b + 60]]);
        }
    }
    assert_eq!(Mesh::new(&corners, &triangles, None).unwrap().len(), 1 + 2 * 29 * 60);
}
