//! The interface rule: which medium and which index of refraction a point has.
//!
//! Space outside every dielectric is the *surroundings*, of index 1, where the regions lie: convex, index-matched, the
//! later one counts. A dielectric surface names the interior on its inner side, against its outward normal, and the
//! one on its outer side. An interior has one index everywhere, and at most one medium, which fills it wherever it
//! reaches; regions do not count inside it. Whoever travels carries the number of the interior that it is in.

use super::place::{dielectrics, side_seen, spread};
use super::{Interior, Object, Region, SURROUNDINGS, Scene, SceneParts};
use crate::error::{Error, Result};
use crate::geometry::{Face, Shape};
use crate::light::Light;
use crate::math::Index;
use crate::medium::Medium;
use crate::surface::{Dielectric, Surface};
use glam::{DVec2, DVec3};

/// Media by number, regions first, then interiors that are filled; and for each interior the number of its medium.
pub(super) fn numbered(regions: &[Region], interiors: &[Interior]) -> (Vec<Medium>, Vec<Option<usize>>) {
    let mut media: Vec<Medium> = regions.iter().map(|r| r.medium.clone()).collect();
    let mut filling = Vec::with_capacity(interiors.len());
    for interior in interiors {
        filling.push(interior.medium.as_ref().map(|_| media.len()));
        media.extend(interior.medium.clone());
    }
    (media, filling)
}

/// Tells each dielectric surface whether the indices on its two sides are equal.
pub(super) fn match_indices(parts: &mut SceneParts) {
    for object in &mut parts.objects {
        if let Surface::Dielectric(boundary) = &mut object.surface {
            let index = |number: usize| parts.interiors[number].index;
            *boundary = boundary.between((index(boundary.inside()), index(boundary.outside())));
        }
    }
}

/// For each light the interior that it is in, where it is in one; none where that is to be asked point by point, as for a
/// body that could cross the boundary of an interior.
pub(super) fn of_lights(scene: &Scene) -> Vec<Option<usize>> {
    let one = |light: &Light| {
        if !scene.plan().has_dielectrics || light.needs_cell() {
            return Some(SURROUNDINGS);
        }
        let is_clear = |shape: &&Shape| {
            let mut boundaries = dielectrics(scene.objects());
            shape.bounds().is_some_and(|ball| boundaries.all(|o| is_clear_of(ball, &o.shape)))
        };
        let on_body = |shape: &Shape| shape.sample_boundary(Face::Top, DVec2::ZERO, [0.5; 3]).0;
        let place = light.apex().or_else(|| light.body().filter(is_clear).map(on_body));
        place.map(|p| scene.interior_at(p))
    };
    scene.lights().iter().map(one).collect()
}

/// Whether a ball keeps clear of a surface; where it cannot be told, it does not.
pub(super) fn is_clear_of((center, radius): (DVec3, f64), shape: &Shape) -> bool {
    match shape {
        // Outside a cuboid the room is minus at most the distance.
        Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Slab(_) => shape.room(center).abs() > radius,
        Shape::Rectangle(r) => libm::hypot(r.height(center), r.inside(center).min(0.0)) > radius,
        Shape::Mesh(_) | Shape::Revolution(_) => {
            shape.bounds().is_some_and(|(other, reach)| center.distance(other) > radius + reach)
        }
    }
}

/// Whether interiors and the surfaces that name them fit together.
pub(super) fn check(parts: &SceneParts) -> Result<()> {
    for (number, interior) in parts.interiors.iter().enumerate() {
        let (name, index) = (&interior.name, interior.index);
        Index::new(&format!("index of refraction of interior {name}"), index)?;
        if number == SURROUNDINGS {
            continue;
        }
        if parts.interiors[..number].iter().any(|other| other.name == *name) {
            return Err(Error::Scene(format!(
                "two interiors are called {name}; allowed: one, and not that of the surroundings"
            )));
        }
        let names_it = |o: &&Object| matches!(&o.surface, Surface::Dielectric(d) if d.inside() == number || d.outside() == number);
        if parts.objects.iter().find(names_it).is_none() {
            return Err(Error::Scene(format!(
                "interior {name} has no boundary: allowed: at least one object with a dielectric surface that names it"
            )));
        }
    }
    for (index, object) in parts.objects.iter().enumerate() {
        if let Surface::Dielectric(dielectric) = &object.surface {
            check_sides(parts, index, dielectric)?;
        }
    }
    Ok(())
}

/// Points of a surface at which its neighbours are asked whether they agree.
const ASKED: u32 = 16;

/// Whether a dielectric surface and its neighbours name the same interior for the space between them, where a ray along
/// the normal meets a neighbour, at most points.
fn check_sides(parts: &SceneParts, index: usize, dielectric: &Dielectric) -> Result<()> {
    let name = |number: usize| parts.interiors.get(number).map(|i| i.name.as_str());
    let (Some(inside), Some(outside)) = (name(dielectric.inside()), name(dielectric.outside())) else {
        return Err(Error::Scene(format!("object {index} names an interior that is not there")));
    };
    if dielectric.inside() == dielectric.outside() {
        return Err(Error::Scene(format!(
            "object {index} has {inside} on both sides; allowed: two interiors"
        )));
    }
    let shape = &parts.objects[index].shape;
    // Far from the surface by nothing that a neighbour could hide in, and by more than rounding.
    let step = 1e-7 * shape.bounds().map_or(shape.shortest_extent(), |(_, radius)| radius);
    let (mut asked, mut wrong, mut other) = (0, 0, "");
    for i in 0..ASKED {
        let (p, normal, _) = shape.sample_boundary(Face::Top, DVec2::ONE, spread(i));
        for (dir, named) in [(normal, dielectric.outside()), (-normal, dielectric.inside())] {
            if let Some(seen) = side_seen(parts, p + dir * step, dir, false) {
                asked += 1;
                if seen != named {
                    wrong += 1;
                    other = name(seen).unwrap_or_default();
                }
            }
        }
    }
    if 2 * wrong > asked {
        return Err(Error::Scene(format!(
            "object {index} has {inside} inside and {outside} outside, but the next dielectric surface has {other} on the side towards it; allowed: the same on both"
        )));
    }
    Ok(())
}

impl Scene {
    /// Every interior by its number; 0 is the surroundings.
    pub fn interiors(&self) -> &[Interior] {
        &self.parts.interiors
    }

    /// Every medium by its number: those of the regions, then those that fill interiors.
    pub fn media(&self) -> &[Medium] {
        &self.media
    }

    /// The medium of a number.
    ///
    /// # Panics
    /// If no medium has this number.
    pub fn medium(&self, number: usize) -> &Medium {
        &self.media[number]
    }

    /// Number of the medium that fills an interior, if one does; none for the surroundings, of which regions say it.
    pub fn filling(&self, interior: usize) -> Option<usize> {
        self.filling[interior]
    }

    /// Number of the interior in which light starts from `origin` by the light of this index.
    pub fn interior_of_light(&self, index: usize, origin: DVec3) -> usize {
        match self.light_within[index] {
            Some(interior) => interior,
            None => self.interior_at(origin),
        }
    }

    /// Number of the medium that counts at a point; none in vacuum.
    pub fn medium_number_at(&self, p: DVec3) -> Option<usize> {
        match self.interior_at(p) {
            SURROUNDINGS => match &self.region_tree {
                Some(tree) => tree.last_at(self.regions(), p),
                None => self.regions().iter().rposition(|r| r.shape.contains(p)),
            },
            interior => self.filling(interior),
        }
    }

    /// The shapes that media which collide are in, those of regions and closed bodies that one fills.
    pub fn colliding_shapes(&self) -> impl Iterator<Item = &Shape> {
        let collides = |number: usize| self.medium(number).is_colliding();
        let regions =
            self.regions().iter().filter(|region| region.medium.is_colliding()).map(|region| &region.shape);
        let is_filled = move |object: &&Object| {
            let Surface::Dielectric(boundary) = &object.surface else { return false };
            object.shape.is_closed() && self.filling(boundary.inside()).is_some_and(collides)
        };
        regions.chain(self.objects().iter().filter(is_filled).map(|object| &object.shape))
    }

    /// Distance from a point to the boundary of the medium that it is in, as far as solid shapes tell \[L\]; 0 in vacuum.
    pub fn room(&self, p: DVec3) -> f64 {
        let Some(number) = self.medium_number_at(p) else { return 0.0 };
        match self.regions().get(number) {
            Some(region) => region.shape.room(p),
            None => {
                let known = dielectrics(self.objects()).filter(|o| o.shape.is_solid());
                known.map(|o| o.shape.room(p).abs()).reduce(f64::min).unwrap_or(0.0)
            }
        }
    }

    /// The medium at a point; none in vacuum.
    pub fn medium_at(&self, p: DVec3) -> Option<&Medium> {
        self.medium_number_at(p).map(|number| self.medium(number))
    }
}
