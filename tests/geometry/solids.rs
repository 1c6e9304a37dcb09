//! Meshes to test on, and random lines.

use crate::support::unit_vector;
use glam::DVec3;
use turbid::geometry::Mesh;
use turbid::math::Ray;
use turbid::rng::{Purpose, Stream};

pub fn stream(seed: u64) -> Stream {
    Stream::new(seed, Purpose::Synthetic, 7, 0)
}

pub fn direction(s: &mut Stream) -> DVec3 {
    let [u, v] = s.pair();
    unit_vector(2.0 * u - 1.0, std::f64::consts::TAU * v)
}

/// Uniform in the cube [-1, 1]^3.
pub fn point(s: &mut Stream) -> DVec3 {
    DVec3::from_array(s.triple()) * 2.0 - 1.0
}

/// The cube [-1, 1]^3, moved and scaled: corners, and triangles that run counter-clockwise seen from outside.
pub fn cube(place: impl Fn(DVec3) -> DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0;
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    ((0..8).map(|i| place(corner(i))).collect(), triangles)
}

/// The unit sphere as `20 4^levels` triangles, corners on the sphere.
pub fn icosphere(levels: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut corners: Vec<DVec3> = [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ]
    .iter()
    .map(|p| DVec3::from_array(*p).normalize())
    .collect();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (corners, triangles)
}

pub fn mesh((corners, triangles): &(Vec<DVec3>, Vec<[u32; 3]>), place: impl Fn(DVec3) -> DVec3) -> Mesh {
    let corners: Vec<DVec3> = corners.iter().map(|p| place(*p)).collect();
    Mesh::new(&corners, triangles, None).unwrap()
}

/// Follows a line through a closed surface until nothing is ahead: each crossing leads to the other side.
/// Returns the number of crossings.
pub fn crossings(
    ray: &Ray,
    starts_inside: bool,
    hit: impl Fn(&Ray, Option<u32>) -> Option<turbid::geometry::Hit>,
) -> usize {
    let (mut ray, mut from, mut is_inside, mut count) = (*ray, None, starts_inside, 0);
    while let Some(found) = hit(&ray, from) {
        let leaves = found.normal.dot(ray.dir) > 0.0;
        assert_eq!(leaves, is_inside, "crossing {count} of {ray:?}: {found:?}");
        is_inside = !leaves;
        ray = Ray::new(ray.at(found.t), ray.dir);
        from = Some(found.primitive);
        count += 1;
        assert!(count < 100, "{ray:?}");
    }
    assert!(!is_inside, "light is lost after {count} crossings: {ray:?}");
    count
}
