//! Shapes, each with the media on its two sides.

use super::places::Places;
use super::writer::{Writer, refuse};
use crate::error::Result;
use crate::exchange::xml::{Xml, number, triple};
use crate::geometry::{Mesh, Revolution, Shape};
use crate::math::sin_cos;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Corners of a ring of a surface of revolution: cross-sections keep their area, and edges lie within 4e-5 of the radius.
const AROUND: usize = 256;

/// More triangles of a surface of revolution are refused.
const MOST_TRIANGLES: usize = 1 << 22;

impl Writer<'_> {
    /// A shape with the media inside and outside of it, and whatever else stands in its element.
    pub(super) fn shape(
        &mut self,
        name: &str,
        shape: &Shape,
        sides: [Option<usize>; 2],
        inside: impl FnOnce(&mut Xml),
    ) -> Result<()> {
        let media = sides.map(|side| side.map(|number| self.medium_name(number)));
        let kind = match shape {
            Shape::Sphere(_) => "sphere",
            Shape::Rectangle(_) => "rectangle",
            Shape::Cuboid(_) => "cube",
            Shape::Mesh(_) | Shape::Revolution(_) => "ply",
            Shape::Slab(_) => {
                return refuse("a slab has no lateral end, and Mitsuba no such shape; allowed: other shapes");
            }
        };
        let file = match shape {
            Shape::Mesh(mesh) => Some(self.beside(name, "ply", mesh.to_ply())),
            Shape::Revolution(body) => {
                let mesh = facets(body)?;
                self.notes.push(format!(
                    "{name} is written as a mesh of {} triangles, {AROUND} around",
                    mesh.len()
                ));
                Some(self.beside(name, "ply", mesh.to_ply()))
            }
            _ => None,
        };
        self.xml.within("shape", &[("type", kind), ("id", name)], |xml| {
            match shape {
                Shape::Sphere(sphere) => {
                    xml.element("point", &[("name", "center"), ("value", &triple(sphere.center()))]);
                    xml.float("radius", sphere.radius());
                }
                Shape::Rectangle(rectangle) => {
                    let [a, b, c, d] = rectangle.corners();
                    let (u, v) = (0.5 * (b - a), 0.5 * (d - a));
                    matrix(xml, [u, v, rectangle.normal(), 0.5 * (a + c)]);
                }
                Shape::Cuboid(cuboid) => {
                    let half = 0.5 * (cuboid.max() - cuboid.min());
                    let middle = 0.5 * (cuboid.max() + cuboid.min());
                    xml.within("transform", &[("name", "to_world")], |xml| {
                        xml.element("scale", &[("value", &triple(half))]);
                        xml.element("translate", &[("value", &triple(middle))]);
                    });
                }
                Shape::Mesh(_) | Shape::Revolution(_) | Shape::Slab(_) => {
                    xml.value("string", "filename", file.as_deref().unwrap_or_default());
                    let is_smooth = matches!(shape, Shape::Mesh(mesh) if mesh.is_smooth());
                    xml.value("boolean", "face_normals", if is_smooth { "false" } else { "true" });
                }
            }
            for (side, medium) in ["interior", "exterior"].iter().zip(&media) {
                if let Some(medium) = medium {
                    xml.element("ref", &[("name", side), ("id", medium)]);
                }
            }
            inside(xml);
        });
        Ok(())
    }

    /// The boundary of a region, which light passes straight on.
    pub(super) fn region(&mut self, index: usize, shape: &Shape, places: &Places) -> Result<()> {
        let sides = places.sides(index);
        if sides == [None, None] {
            return Ok(());
        }
        self.shape(&format!("boundary-{index}"), shape, sides, |xml| xml.element("bsdf", &[("type", "null")]))
    }
}

/// A transform by the images of the three axes and of the origin.
fn matrix(xml: &mut Xml, [x, y, z, origin]: [DVec3; 4]) {
    let row = |axis: usize| [x[axis], y[axis], z[axis], origin[axis]].map(number).join(" ");
    let rows = format!("{} {} {} 0 0 0 1", row(0), row(1), row(2));
    xml.within("transform", &[("name", "to_world")], |xml| xml.element("matrix", &[("value", &rows)]));
}

/// A surface of revolution in flat facets.
fn facets(body: &Revolution) -> Result<Mesh> {
    let rings: &[DVec2] = body.profile();
    if 2 * AROUND * rings.len() > MOST_TRIANGLES {
        return refuse(format!(
            "a surface of revolution of {} points; allowed for Mitsuba: {}",
            rings.len(),
            MOST_TRIANGLES / (2 * AROUND)
        ));
    }
    let step = TAU / AROUND as f64;
    // Polygons of the circles' areas: N r^2 sin(2 pi/N)/2 = pi R^2.
    let wide = (step / sin_cos(step).0).sqrt();
    let frame = body.frame();
    let mut positions = Vec::with_capacity(AROUND * rings.len());
    for ring in rings {
        for i in 0..AROUND {
            let (sin, cos) = sin_cos(step * i as f64);
            let p = DVec3::new(wide * ring.x * cos, wide * ring.x * sin, ring.y);
            positions.push(body.base() + frame.to_world(p));
        }
    }
    let mut triangles = Vec::with_capacity(2 * AROUND * rings.len());
    for k in 0..rings.len() - 1 {
        for i in 0..AROUND {
            let at = |ring: usize, i: usize| (ring * AROUND + i % AROUND) as u32;
            let [a, b, c, d] = [at(k, i), at(k, i + 1), at(k + 1, i + 1), at(k + 1, i)];
            // Outwards is to the right of the profile: azimuth first, then along it.
            if rings[k].x > 0.0 {
                triangles.push([a, b, c]);
            }
            if rings[k + 1].x > 0.0 {
                triangles.push([a, c, d]);
            }
        }
    }
    Mesh::new(&positions, &triangles, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cylinder, a cone and a double cone have the volumes of the bodies, and normals outwards.
    #[test]
    fn facets_keep_the_volume() {
        for profile in [
            vec![(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)],
            vec![(0.0, 0.0), (1.0, 0.0), (0.0, 2.0)],
            vec![(0.0, -1.0), (1.0, 0.0), (0.0, 2.0)],
        ] {
            let points: Vec<DVec2> = profile.into_iter().map(DVec2::from).collect();
            let body = Revolution::new(DVec3::ONE, DVec3::new(1.0, 2.0, 3.0), &points).unwrap();
            let mesh = facets(&body).unwrap();
            assert!(
                (mesh.volume() / body.volume() - 1.0).abs() < 1e-12,
                "{} {}",
                mesh.volume(),
                body.volume()
            );
        }
    }
}
