//! Where the flat matt surfaces of a scene end, for discs that reach beyond.

use crate::estimators::{Kernel, disc_share};
use crate::geometry::{Rectangle, Shape};
use crate::scene::{Scene, SceneHit, Target};
use crate::surface::Surface;
use glam::DVec3;

/// Planes count as one if their normals differ by less than this, and their places by less than this part of a diagonal:
/// what rounding of a scene's numbers leaves.
const SAME: f64 = 1e-6;

/// One flat face of a body.
#[derive(Debug, Clone, Copy)]
struct Face {
    rectangle: Rectangle,
    /// Whether light falls on its front alone, as on a box.
    is_one_sided: bool,
}

/// For each body, for each of its flat faces, the matt faces in the same plane, itself among them.
#[derive(Debug)]
pub(super) struct Flats(Vec<Vec<Vec<Face>>>);

impl Flats {
    pub fn new(scene: &Scene) -> Self {
        let is_matt = |surface: &Surface| matches!(surface, Surface::Lambertian(_));
        let bodies: Vec<Vec<Face>> = scene
            .objects()
            .iter()
            .map(|object| if is_matt(&object.surface) { faces(&object.shape) } else { Vec::new() })
            .collect();
        let beside = |face: &Face| {
            let others = bodies.iter().flatten();
            others.filter(|other| is_same_plane(&face.rectangle, &other.rectangle)).copied().collect()
        };
        Flats(bodies.iter().map(|faces| faces.iter().map(beside).collect()).collect())
    }

    /// Whether a surface is flat where it was hit.
    pub fn is_flat(&self, found: &SceneHit) -> bool {
        matches!(found.target, Target::Object(index) if !self.0[index].is_empty())
    }

    /// The part of a kernel's disc at a hit that lies on the surface; 1 where the surface is not flat.
    ///
    /// # Arguments
    /// `normal` unit, on the side where light arrives
    pub fn share(&self, found: &SceneHit, normal: DVec3, point: DVec3, kernel: Kernel, radius: f64) -> f64 {
        let Target::Object(index) = found.target else { return 1.0 };
        let body = &self.0[index];
        let beside = match body.len() {
            0 => return 1.0,
            1 => &body[0],
            _ => &body[side(found.hit.normal)],
        };
        let lit =
            beside.iter().filter(|face| !face.is_one_sided || face.rectangle.normal().dot(normal) > 0.0);
        // A whole disc on its own face needs no other.
        let sum = lit.fold(0.0, |sum: f64, face| {
            if sum < 1.0 { sum + disc_share(kernel, &face.rectangle, point, radius) } else { sum }
        });
        sum.min(1.0)
    }
}

/// The flat faces of a shape, of a box in the order of [`side`].
fn faces(shape: &Shape) -> Vec<Face> {
    match shape {
        Shape::Rectangle(rectangle) => vec![Face { rectangle: *rectangle, is_one_sided: false }],
        Shape::Cuboid(cuboid) => {
            let (min, max) = (cuboid.min(), cuboid.max());
            let edge = |axis: usize| DVec3::AXES[axis] * (max - min)[axis];
            (0..6)
                .filter_map(|side| {
                    let (axis, is_high) = (side / 2, side % 2 == 1);
                    let [a, b] = [edge((axis + 1) % 3), edge((axis + 2) % 3)];
                    let rectangle = match is_high {
                        true => Rectangle::new(min + edge(axis), a, b),
                        false => Rectangle::new(min, b, a),
                    };
                    Some(Face { rectangle: rectangle.ok()?, is_one_sided: true })
                })
                .collect()
        }
        Shape::Sphere(_) | Shape::Slab(_) | Shape::Mesh(_) | Shape::Lathe(_) => Vec::new(),
    }
}

/// Which face of a box has this outward normal.
fn side(normal: DVec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] > 0.0)
}

fn is_same_plane(a: &Rectangle, b: &Rectangle) -> bool {
    let is_parallel = a.normal().cross(b.normal()).length() < SAME;
    is_parallel && a.height(b.sample([0.5; 2])).abs() < SAME * a.diagonal().max(b.diagonal())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_a_box() {
        let shape =
            Shape::Cuboid(crate::geometry::Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).unwrap());
        let faces = faces(&shape);
        assert_eq!(faces.len(), 6);
        for (index, face) in faces.iter().enumerate() {
            let normal = face.rectangle.normal();
            assert_eq!(side(normal), index);
            // Outwards: the box's middle lies behind.
            assert!(face.rectangle.height(DVec3::new(0.5, 1.0, 1.5)) < 0.0);
            assert!(face.rectangle.inside(DVec3::new(0.5, 1.0, 1.5)) >= 0.5 - 1e-12);
        }
    }
}
