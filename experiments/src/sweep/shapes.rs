//! Shapes as text, and small meshes.

use super::text::{SceneText, array, table};
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;
use toml::Value;

/// A sphere.
pub fn sphere(center: DVec3, radius: f64) -> Value {
    let keys = [("center", array(&center.to_array())), ("radius", Value::Float(radius))];
    table([("sphere", table(keys))])
}

/// A cuboid.
pub fn cuboid(min: [f64; 3], max: [f64; 3]) -> Value {
    table([("cuboid", table([("min", array(&min)), ("max", array(&max))]))])
}

/// A rectangle.
pub fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Value {
    table([("rectangle", table([("corner", array(&corner)), ("u", array(&u)), ("v", array(&v))]))])
}

/// A square of side 1.4 half about a point, across a normal.
pub fn tilted_rectangle(center: DVec3, normal: DVec3, half: f64) -> Value {
    let (u, v) = normal.any_orthonormal_pair();
    let side = 0.7 * half;
    let corner = center - (u + v) * side;
    rectangle(corner.to_array(), (u * 2.0 * side).to_array(), (v * 2.0 * side).to_array())
}

/// Vertices within the cube of half width 1, and triangles, counterclockwise from outside.
pub type Solid = (Vec<DVec3>, Vec<[usize; 3]>);

/// A cube.
pub fn block() -> Solid {
    let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
    let points = (0..8).map(|i| DVec3::new(sign(i & 1), sign(i >> 1 & 1), sign(i >> 2 & 1))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    (points, faces)
}

/// An octahedron.
pub fn octahedron() -> Solid {
    let points = vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    (points, faces)
}

/// A tetrahedron.
pub fn tetrahedron() -> Solid {
    let points = vec![
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];
    (points, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
}

/// A ball of triangles: an octahedron whose faces are cut into four so many times.
pub fn round(times: usize) -> Solid {
    let (mut points, mut faces) = octahedron();
    for _ in 0..times {
        let mut middles: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    points.push((points[i] + points[j]).normalize());
                    points.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    (points, faces)
}

/// The same turned, then about a slanting axis, then made to fit the cube again.
pub fn turned((points, faces): &Solid, frame: DMat3, tilt: Option<DVec3>) -> Solid {
    let tilt = tilt.map_or(DMat3::IDENTITY, |z| {
        let (x, y) = z.any_orthonormal_pair();
        DMat3::from_cols(x, y, x.cross(y))
    });
    let points: Vec<DVec3> = points.iter().map(|p| tilt * (frame * *p)).collect();
    let far = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    (points.iter().map(|p| *p / far).collect(), faces.clone())
}

/// A mesh of a solid about a point; its file goes beside the scene.
pub fn mesh(text: &mut SceneText, (points, faces): &Solid, center: DVec3, half: f64) -> Value {
    let mut obj = String::new();
    for p in points {
        obj.push_str(&format!("v {} {} {}\n", p.x, p.y, p.z));
    }
    for [a, b, c] in faces {
        obj.push_str(&format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    }
    let name = format!("mesh{}.obj", text.files.len());
    text.files.insert(name.clone(), obj.into_bytes());
    let keys =
        [("file", Value::String(name)), ("scale", Value::Float(half)), ("at", array(&center.to_array()))];
    table([("mesh", table(keys))])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every edge is walked once in each direction, and the volume is positive: closed, and outside is outside.
    #[test]
    fn solids_are_closed_and_face_outwards() {
        for (points, faces) in [block(), octahedron(), tetrahedron(), round(2)] {
            let mut edges: Vec<(usize, usize)> =
                faces.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]).collect();
            edges.sort_unstable();
            assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
            assert!(edges.iter().all(|(a, b)| edges.binary_search(&(*b, *a)).is_ok()));
            let volume: f64 =
                faces.iter().map(|[a, b, c]| points[*a].dot(points[*b].cross(points[*c]))).sum();
            assert!(volume > 0.0);
        }
    }
}
