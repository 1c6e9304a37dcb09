//! Where each medium is, as far as the balls of volume estimates need to know.
//!
//! The faces of a region, and of an interior that one sphere, cuboid or slab encloses, are known in closed form. Every
//! other surface that reaches into a medium may part it, whatever its shape: walls, lamps, glass, filters, levels of
//! water. Near them an estimate asks what its point sees. A surface on the medium's own faces, or beyond them, parts
//! nothing.

use crate::estimators::boundary::Boundary;
use crate::geometry::{Face, Shape};
use crate::scene::Scene;
use crate::surface::{Dielectric, Surface};
use glam::DVec3;

/// Where one medium is.
#[derive(Debug)]
pub struct MediumExtent {
    /// The boundary, where it is known.
    shape: Option<Shape>,
    /// Regions in it that count instead of it.
    later: Vec<Shape>,
    /// Surfaces that reach into it.
    bodies: Vec<Shape>,
    /// Whether there is no other medium.
    is_only: bool,
}

/// The extents of the media of a scene by their numbers.
pub fn medium_extents(scene: &Scene) -> Vec<MediumExtent> {
    let objects = scene.objects().iter().map(|object| &object.shape);
    let surfaces: Vec<&Shape> =
        objects.chain(scene.lights().iter().filter_map(|light| light.body())).collect();
    let is_only = scene.media().len() < 2;
    let extent = |shape: Option<Shape>, later: Vec<Shape>| {
        let is_met = |body: &&&Shape| shape.as_ref().is_none_or(|medium| enters(body, medium));
        let bodies = surfaces.iter().filter(is_met).map(|body| (*body).clone()).collect();
        MediumExtent { shape, later, bodies, is_only }
    };
    let mut extents = Vec::with_capacity(scene.media().len());
    for (number, region) in scene.regions().iter().enumerate() {
        let later = scene.regions()[number + 1..].iter().map(|later| &later.shape);
        // One that holds the whole region leaves nothing of it.
        let later = later.filter(|later| enters(later, &region.shape)).cloned().collect();
        extents.push(extent(Some(region.shape.clone()), later));
    }
    for interior in (0..scene.interiors().len()).filter(|interior| scene.filling(*interior).is_some()) {
        extents.push(extent(enclosing(scene, interior), Vec::new()));
    }
    extents
}

/// The shape that encloses an interior, where that is one solid.
fn enclosing(scene: &Scene, interior: usize) -> Option<Shape> {
    let is_around = |d: &Dielectric| d.inside() == interior;
    let mut around = scene
        .objects()
        .iter()
        .filter(|object| matches!(&object.surface, Surface::Dielectric(dielectric) if is_around(dielectric)));
    match (around.next(), around.next()) {
        (Some(object), None) if object.shape.is_solid() => Some(object.shape.clone()),
        _ => None,
    }
}

/// Numbers in a scene file are rounded: a surface this near to a face, in parts of the medium's size, lies on it.
const ON_FACE: f64 = 1e-9;

/// Whether a surface reaches into the inside of a solid, as far as boxes around it tell: one that does not parts nothing.
fn enters(body: &Shape, solid: &Shape) -> bool {
    let (low, high) = match solid {
        Shape::Sphere(ball) => {
            let radius = ball.radius() * (1.0 - ON_FACE);
            return body.distance(ball.center(), radius) < radius;
        }
        Shape::Cuboid(cuboid) => (cuboid.min(), cuboid.max()),
        Shape::Slab(slab) => {
            let far = f64::INFINITY;
            (DVec3::new(-far, -far, slab.top()), DVec3::new(far, far, slab.face(Face::Bottom)))
        }
        Shape::Rectangle(_) | Shape::Mesh(_) | Shape::Revolution(_) => return true,
    };
    let margin = ON_FACE * solid.shortest_extent();
    let (low, high) = (low + margin, high - margin);
    let meets = |min: DVec3, max: DVec3| min.cmplt(high).all() && max.cmpgt(low).all();
    let meets_points = |points: &[DVec3]| {
        let (min, max) =
            points.iter().fold((points[0], points[0]), |(min, max), p| (min.min(*p), max.max(*p)));
        meets(min, max)
    };
    match body {
        Shape::Sphere(ball) => {
            let (center, radius) = (ball.center(), ball.radius());
            let nearest = center.clamp(low, high);
            let farthest = DVec3::select((center - low).cmpgt(high - center), low, high);
            center.distance(nearest) < radius && center.distance(farthest) > radius
        }
        Shape::Rectangle(r) => {
            meets_points(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|at| r.sample(at)))
        }
        Shape::Slab(slab) => [slab.top(), slab.face(Face::Bottom)].iter().any(|z| low.z < *z && *z < high.z),
        Shape::Cuboid(c) => (0..3).any(|axis| {
            [c.min()[axis], c.max()[axis]].iter().any(|face| {
                let (mut min, mut max) = (c.min(), c.max());
                (min[axis], max[axis]) = (*face, *face);
                meets(min, max)
            })
        }),
        Shape::Mesh(mesh) => (0..mesh.len()).any(|index| meets_points(&mesh.triangle(index as u32))),
        Shape::Revolution(lathe) => {
            let (center, radius) = lathe.bounds();
            center.distance(center.clamp(low, high)) < radius
        }
    }
}

impl MediumExtent {
    /// The boundary of the medium, as an estimator is told of it.
    pub fn boundary(&self) -> Boundary<'_> {
        let known = self.shape.as_ref().and_then(|shape| Boundary::of(shape).ok());
        let boundary = known.unwrap_or(Boundary::UNKNOWN).about(&self.bodies);
        if self.is_only { boundary } else { boundary.among(&self.later) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneFile;

    fn extents(file: &str) -> Vec<MediumExtent> {
        let file = SceneFile::from_toml(file).unwrap();
        medium_extents(&file.scene(std::path::Path::new(".")).unwrap())
    }

    const LIGHT: &str = "[[lights]]\npoint = { position = [0, 0, 8.5], power = 1 }\n";
    const MEDIUM: &str = "sigma_t = 1\nalbedo = 0.5\ng = 0\n";

    fn fog() -> String {
        format!("[[regions]]\nshape = {{ cuboid = {{ min = [-5, -5, -5], max = [5, 5, 5] }} }}\n{MEDIUM}")
    }

    fn object(shape: &str, surface: &str) -> String {
        format!("[[objects]]\nshape = {{ {shape} }}\nsurface = {surface}\n")
    }

    /// Fog with a ball of milk in it, milk in a box of glass, and water under a level.
    #[test]
    fn boundaries_are_known_where_one_solid_is() {
        let (fog, glass) = (fog(), "{ dielectric = { inside = \"milk\" } }");
        let milk = format!("[[interiors]]\nname = \"milk\"\nindex = 1.3\n{MEDIUM}");
        let ball = object("sphere = { center = [0, 0, 0], radius = 1 }", glass);
        let level = object("rectangle = { corner = [-9, -9, 0], u = [18, 0, 0], v = [0, 18, 0] }", glass);
        let [fogged, in_ball] = &extents(&format!("{fog}{milk}{ball}{LIGHT}"))[..] else { panic!() };
        assert!(!fogged.is_only && fogged.bodies.len() == 1);
        assert!(matches!(in_ball.shape, Some(Shape::Sphere(_))) && in_ball.bodies.is_empty());
        let [alone] = &extents(&format!("{milk}{ball}{LIGHT}"))[..] else { panic!() };
        assert!(alone.is_only && alone.shape.is_some() && alone.bodies.is_empty());
        let [water] = &extents(&format!("{milk}{level}{LIGHT}"))[..] else { panic!() };
        assert!(water.is_only && water.shape.is_none() && water.bodies.len() == 1);
    }

    /// What reaches into the fog counts; what lies on its faces, outside them or all around it parts nothing.
    #[test]
    fn surfaces_on_faces_part_nothing() {
        for (shape, parts) in [
            ("rectangle = { corner = [-5, -5, 5], u = [10, 0, 0], v = [0, 10, 0] }", false),
            ("rectangle = { corner = [-9, -9, -5], u = [20, 0, 0], v = [0, 20, 0] }", false),
            ("rectangle = { corner = [-5, -5, 4.99], u = [10, 0, 0], v = [0, 10, 0] }", true),
            ("rectangle = { corner = [6, -5, -5], u = [0, 10, 0], v = [0, 0, 10] }", false),
            ("cuboid = { min = [-5, -5, -5], max = [5, 5, 5] }", false),
            ("cuboid = { min = [-5, -5, -5], max = [5, 5, 4] }", true),
            ("cuboid = { min = [2, 2, 2], max = [3, 3, 3] }", true),
            ("cuboid = { min = [5, -5, -5], max = [6, 5, 5] }", false),
            ("sphere = { center = [0, 0, 0], radius = 9 }", false),
            ("sphere = { center = [0, 0, 0], radius = 8 }", true),
            ("sphere = { center = [0, 0, 7], radius = 2 }", false),
            ("lathe = { base = [0, 0, 8], profile = [[0, 0], [1, 0], [1, 1], [0, 1]] }", false),
            ("lathe = { base = [0, 0, 2], profile = [[0, 0], [1, 0], [1, 1], [0, 1]] }", true),
        ] {
            let [fogged] = &extents(&format!("{}{}{LIGHT}", fog(), object(shape, "\"black\"")))[..] else {
                panic!()
            };
            assert_eq!(!fogged.bodies.is_empty(), parts, "{shape}");
        }
    }
}
