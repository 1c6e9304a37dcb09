//! Where each medium is, as far as the balls of volume estimates need to know.
//!
//! The faces of a region, and of an interior that one sphere, cuboid or slab of glass encloses, are known in closed form,
//! and so are the solid bodies that stand in them: glass, blocks, lamps. Boxes made of rectangles are none. Where another
//! shape bounds an interior (a lathe, a mesh, a height field, a rectangle such as the level of water) its faces are left
//! untreated: estimates read low there, up to half on the face itself. Photons of other media are told apart everywhere.

use crate::estimators::boundary::{Boundary, Treatment};
use crate::geometry::Shape;
use crate::scene::{SURROUNDINGS, Scene};
use crate::surface::{Dielectric, Surface};

/// Where one medium is.
#[derive(Debug)]
pub(super) struct Home {
    /// The boundary, where it is known.
    shape: Option<Shape>,
    /// Solid shapes in it that are not of it; none where there are none and nothing else has photons.
    others: Option<Vec<Shape>>,
    /// Whether there is no other medium.
    is_only: bool,
    /// Whether photons of other media can be told apart only by asking where each of them lies.
    is_asked: bool,
}

/// The homes of the media of a scene by their numbers.
pub(super) fn of(scene: &Scene) -> Vec<Home> {
    let is_alone = scene.media().len() < 2;
    let glass = || {
        scene.objects().iter().filter_map(|object| match &object.surface {
            Surface::Dielectric(dielectric) => Some((&object.shape, dielectric)),
            _ => None,
        })
    };
    // What stands in the interior of a number, and whether all of it is solid.
    let standing = |within: usize| {
        let outside = |d: &Dielectric| d.outside() == within;
        let shapes = || glass().filter(move |(_, d)| outside(d)).map(|(shape, _)| shape);
        let solid: Vec<Shape> = shapes().filter(|shape| shape.is_solid()).cloned().collect();
        (solid, shapes().all(Shape::is_solid))
    };
    let opaque =
        scene.objects().iter().filter(|o| !matches!(o.surface, Surface::Dielectric(_) | Surface::Filter(_)));
    let lamps = scene.lights().iter().filter_map(|light| light.body());
    let bodies: Vec<Shape> =
        opaque.map(|o| &o.shape).chain(lamps).filter(|s| s.is_solid()).cloned().collect();
    let home = |shape: Option<Shape>, mut others: Vec<Shape>, is_known: bool| {
        if shape.is_some() {
            others.extend(bodies.iter().cloned());
        }
        let others = (!is_alone || !others.is_empty()).then_some(others);
        Home { shape, others, is_only: is_alone, is_asked: !is_alone && !is_known }
    };
    let mut homes = Vec::with_capacity(scene.media().len());
    for (number, region) in scene.regions().iter().enumerate() {
        let (mut others, is_known) = standing(SURROUNDINGS);
        others.extend(scene.regions()[number + 1..].iter().map(|later| later.shape.clone()));
        homes.push(home(Some(region.shape.clone()), others, is_known));
    }
    for within in (0..scene.interiors().len()).filter(|within| scene.filling(*within).is_some()) {
        let (others, is_known) = standing(within);
        let around: Vec<&Shape> =
            glass().filter(|(_, d)| d.inside() == within).map(|(shape, _)| shape).collect();
        let shape = match around[..] {
            [shape] if shape.is_solid() => Some(shape.clone()),
            _ => None,
        };
        let is_known = is_known && shape.is_some();
        homes.push(home(shape, others, is_known));
    }
    homes
}

/// Names of the interiors whose medium scatters, and whose faces no treatment of volume estimates knows.
pub fn untreated(scene: &Scene) -> Vec<&str> {
    let homes = of(scene);
    let interiors = scene.interiors().iter().enumerate();
    let is_untreated = |within: usize| {
        scene.filling(within).is_some_and(|number| {
            let medium = scene.medium(number);
            homes[number].shape.is_none() && medium.is_colliding() && !medium.matter().albedo().is_black()
        })
    };
    interiors
        .filter(|(within, _)| is_untreated(*within))
        .map(|(_, interior)| interior.name.as_str())
        .collect()
}

impl Home {
    /// What an estimate in the medium of this number does at its boundary.
    pub fn boundary<'a>(&'a self, scene: &'a Scene, number: usize, treatment: Treatment) -> Boundary<'a> {
        let known = self.shape.as_ref().and_then(|shape| Boundary::of(shape, treatment));
        let boundary = known.unwrap_or_else(|| Boundary::unknown(treatment));
        let boundary = match &self.others {
            Some(others) if self.is_only => boundary.about(others),
            Some(others) => boundary.among(others),
            None => boundary,
        };
        if self.is_asked { boundary.owned_by(scene, number) } else { boundary }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneFile;

    fn homes(file: &str) -> Vec<Home> {
        let file: SceneFile = toml::from_str(file).unwrap();
        of(&file.scene(std::path::Path::new(".")).unwrap())
    }

    /// Fog with a ball of milk in it, milk in a box of glass, and water under a level.
    #[test]
    fn solid_boundaries_are_known() {
        let light = "[[lights]]\npoint = { position = [0, 0, 9], power = 1 }\n";
        let medium = "sigma_t = 1\nalbedo = 0.5\ng = 0\n";
        let fog = format!(
            "[[regions]]\nshape = {{ cuboid = {{ min = [-5, -5, -5], max = [5, 5, 5] }} }}\n{medium}"
        );
        let milk = format!("[[interiors]]\nname = \"milk\"\nindex = 1.3\n{medium}");
        let object = |shape: &str| {
            format!(
                "[[objects]]\nshape = {{ {shape} }}\nsurface = {{ dielectric = {{ inside = \"milk\" }} }}\n"
            )
        };
        let ball = object("sphere = { center = [0, 0, 0], radius = 1 }");
        let level = object("rectangle = { corner = [-9, -9, 0], u = [18, 0, 0], v = [0, 18, 0] }");
        let [fogged, in_ball] = &homes(&format!("{fog}{milk}{ball}{light}"))[..] else { panic!() };
        assert!(!fogged.is_asked && fogged.others.as_ref().is_some_and(|others| others.len() == 1));
        assert!(!in_ball.is_asked && matches!(in_ball.shape, Some(Shape::Sphere(_))));
        assert!(in_ball.others.as_ref().is_some_and(Vec::is_empty));
        let block =
            "[[objects]]\nshape = { cuboid = { min = [2, 2, 2], max = [3, 3, 3] } }\nsurface = \"black\"\n";
        let [about] = &homes(&format!("{fog}{block}{light}"))[..] else { panic!() };
        assert!(about.is_only && about.others.as_ref().is_some_and(|others| others.len() == 1));
        let [alone] = &homes(&format!("{milk}{ball}{light}"))[..] else { panic!() };
        assert!(!alone.is_asked && alone.others.is_none() && alone.shape.is_some());
        let [water] = &homes(&format!("{milk}{level}{light}"))[..] else { panic!() };
        assert!(!water.is_asked && water.others.is_none() && water.shape.is_none());
        assert!(homes(&format!("{fog}{milk}{level}{light}")).iter().all(|home| home.is_asked));
    }
}
