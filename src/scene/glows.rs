//! Media that emit, as lights: their photons start in them.

use super::{Parts, SURROUNDINGS, Scene};
use crate::geometry::Shape;
use crate::light::{Glow, Light};
use crate::surface::Surface;

/// Points of the quadrature of a medium's power: by a lattice it is good to about a thousandth.
const POINTS: u32 = 1 << 14;

/// The lights that the media of a scene are, those of regions first; and whether that is all of them: a medium without
/// end, where no cell stands for it, sends out no photon that could be followed.
pub(super) fn of(scene: &Scene) -> (Vec<Light>, bool) {
    let (mut lights, mut is_all) = (Vec::new(), true);
    if !scene.media().iter().any(|medium| medium.is_emitting()) {
        return (lights, is_all);
    }
    let parts = &scene.parts;
    let ball = scene.bounds().map(|ball| Shape::Sphere(*ball));
    let mut add = |number: usize, within: usize, shapes: &[&Shape], is_certain: bool| {
        let medium = scene.medium(number);
        if !medium.is_emitting() {
            return;
        }
        let stage = scene.stage();
        let glow = match shapes {
            [] => None,
            _ => Glow::new((number, within), medium, shapes, stage, is_certain),
        };
        match glow {
            Some(glow) => {
                let owns = |p| scene.medium_number_at(p) == Some(number);
                lights.push(Light::Glow(glow.measured(stage, POINTS, owns)));
            }
            None => is_all = false,
        }
    };
    for (number, region) in parts.regions.iter().enumerate() {
        let is_alone = number + 1 == parts.regions.len() && !scene.plan().has_dielectrics;
        add(number, SURROUNDINGS, &[&region.shape], is_alone);
    }
    for within in 0..parts.interiors.len() {
        if let Some(number) = scene.filling(within) {
            let shapes = enclosing(parts, within).unwrap_or(ball.iter().collect());
            add(number, within, &shapes, false);
        }
    }
    (lights, is_all)
}

/// The shapes that an interior lies in, if its boundary encloses it; it may lie in a part of them only.
fn enclosing(parts: &Parts, within: usize) -> Option<Vec<&Shape>> {
    let names_it = |surface: &Surface| matches!(surface, Surface::Dielectric(d) if d.inside() == within);
    let shapes: Vec<&Shape> =
        parts.objects.iter().filter(|o| names_it(&o.surface)).map(|o| &o.shape).collect();
    (!shapes.is_empty() && shapes.iter().all(|shape| shape.is_closed())).then_some(shapes)
}
