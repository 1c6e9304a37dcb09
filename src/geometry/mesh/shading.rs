//! Normals at the corners of a triangle, and between them.

use glam::DVec3;

/// What becomes of a normal of a file, whose length does not matter.
pub(super) type Turn<'a> = &'a dyn Fn(DVec3) -> DVec3;

/// The normals of a triangle that is flat.
pub(super) const FLAT: [DVec3; 3] = [DVec3::ZERO; 3];

/// Unit normals at the corners of a triangle, all less than a right angle from its `own`, from those given; [`FLAT`] where
/// that cannot be.
pub(super) fn at_corners(own: DVec3, given: [DVec3; 3]) -> [DVec3; 3] {
    let units = given.map(unit);
    let sides = units.map(|normal| normal.map_or(0.0, |normal| normal.dot(own)));
    // Of a mesh whose corners and normals disagree about the outer side the corners are right.
    let sign = if sides.iter().all(|side| *side < 0.0) { -1.0 } else { 1.0 };
    if sides.iter().any(|side| sign * side <= 0.0) {
        return FLAT;
    }
    units.map(|normal| sign * normal.unwrap_or(own))
}

/// A unit vector, none of one that is 0 or not finite. It is scaled first, so that no size underflows.
fn unit(normal: DVec3) -> Option<DVec3> {
    let size = normal.abs().max_element();
    if size > 0.0 { (normal / size).try_normalize() } else { None }
}

/// The normal between corners of these weights; on a flat triangle its own.
pub(super) fn interpolated(normals: &[DVec3; 3], weights: [f64; 3], own: DVec3) -> DVec3 {
    if *normals == FLAT {
        return own;
    }
    let sum = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
    sum.try_normalize().unwrap_or(own)
}
