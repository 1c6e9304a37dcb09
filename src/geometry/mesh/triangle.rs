//! The meeting of a line and a triangle, without gaps between neighbours.

use crate::math::Ray;
use glam::DVec3;

/// A ray as axes: the longest component of its direction becomes z, and a shear makes the ray itself the z axis.
///
/// Seen along that axis, triangles that share an edge see the same two corners with the same bits, and each decides
/// on which side the axis passes by comparing the same two products: never do both say no.
///
/// # Source     Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection", here in double precision
pub struct Shear {
    origin: DVec3,
    axes: [usize; 3],
    shear: DVec3,
}

/// Where a line meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Distance along the line, negative behind its origin \[L\].
    pub t: f64,
    /// Weights of the three corners, which sum to 1.
    pub weights: [f64; 3],
}

impl Shear {
    /// The axes of a ray.
    pub fn new(ray: &Ray) -> Self {
        let size = ray.dir.abs();
        let z = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if ray.dir[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = DVec3::new(ray.dir[x], ray.dir[y], 1.0) / ray.dir[z];
        Shear { origin: ray.origin, axes: [x, y, z], shear }
    }

    /// Where the whole line, ahead and behind, meets the triangle, its edges included; none for a triangle seen
    /// exactly from the side.
    #[inline]
    pub fn meet(&self, corners: &[DVec3; 3]) -> Option<Meeting> {
        let [x, y, z] = self.axes;
        let seen = |corner: DVec3| {
            let p = (corner - self.origin).to_array();
            (p[x] - self.shear.x * p[z], p[y] - self.shear.y * p[z], p[z])
        };
        let [a, b, c] = [seen(corners[0]), seen(corners[1]), seen(corners[2])];
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let weights = [u / sum, v / sum, w / sum];
        let t = self.shear.z * (weights[0] * a.2 + weights[1] * b.2 + weights[2] * c.2);
        Some(Meeting { t, weights })
    }
}

/// The point of a triangle that is nearest to a point.
///
/// # Source     Ericson 2005, "Real-time collision detection", 5.1.5
pub fn closest([a, b, c]: &[DVec3; 3], p: DVec3) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let (from_a, from_b, from_c) = (p - a, p - b, p - c);
    let (d1, d2) = (u.dot(from_a), v.dot(from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let (d3, d4) = (u.dot(from_b), v.dot(from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let over_c = d1 * d4 - d3 * d2;
    if over_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + u * (d1 / (d1 - d3));
    }
    let (d5, d6) = (u.dot(from_c), v.dot(from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let over_b = d5 * d2 - d1 * d6;
    if over_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + v * (d2 / (d2 - d6));
    }
    let over_a = d3 * d6 - d5 * d4;
    if over_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = over_a + over_b + over_c;
    a + u * (over_b / sum) + v * (over_c / sum)
}
