//! Mirror images.

use super::moments::inward_normal;
use crate::geometry::{Face, Shape};
use glam::DVec3;

/// The mirror images of a point whose balls of radius `radius` reach into the body.
///
/// A photon's image is as far from the point as the photon is from the point's image, so that the point is mirrored and
/// not the photons. Flat faces: one image a face, one an edge, one a corner. Sphere: in the
/// plane that touches it nearest to the point.
pub(super) fn images(body: &Shape, point: DVec3, radius: f64) -> Vec<DVec3> {
    let (low, high) = match body {
        Shape::Slab(slab) => {
            let far = f64::INFINITY;
            (DVec3::new(-far, -far, slab.top()), DVec3::new(far, far, slab.face(Face::Bottom)))
        }
        Shape::Cuboid(cuboid) => (cuboid.min(), cuboid.max()),
        Shape::Sphere(_) => {
            let room = body.room(point);
            let image = point - inward_normal(body, point) * (2.0 * room);
            return if room < radius { vec![image] } else { Vec::new() };
        }
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => return Vec::new(),
    };
    // Each axis in turn mirrors what there is; the sum of squares is the squared distance of an image from the body.
    let mut found = vec![(point, 0.0)];
    for axis in 0..3 {
        for index in 0..found.len() {
            let (from, squared) = found[index];
            for face in [low[axis], high[axis]] {
                let distance = point[axis] - face;
                let squared = squared + distance * distance;
                if squared < radius * radius {
                    let mut image = from;
                    image[axis] = 2.0 * face - point[axis];
                    found.push((image, squared));
                }
            }
        }
    }
    found.into_iter().skip(1).map(|(image, _)| image).collect()
}
