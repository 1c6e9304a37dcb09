//! The interface rule: which medium and which index of refraction a point has.
//!
//! Space outside every dielectric is the *surroundings*, of index 1, where the regions lie: convex, index-matched, the
//! later one counts. A dielectric surface names the interior on its inner side, against its outward normal, and the
//! one on its outer side. An interior has one index everywhere, and at most one medium, which fills it wherever it
//! reaches; regions do not count inside it. Whoever travels carries the number of the interior that it is in.

use super::{Interior, Object, Region, SURROUNDINGS, Scene, SceneHit, SceneParts, Target};
use crate::error::{Error, Result};
use crate::geometry::{ASLANT, Face, Hit, Shape};
use crate::light::Light;
use crate::math::{Index, Ray, warp};
use crate::medium::Medium;
use crate::rng::{Purpose, Stream};
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

/// Where to look for boundaries that are not met aslant: up and down first since water is level.
const DIRECTIONS: [DVec3; 6] = [DVec3::Z, DVec3::NEG_Z, DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::NEG_X];

/// The objects that are boundaries of interiors.
pub(super) fn dielectrics(objects: &[Object]) -> impl Iterator<Item = &Object> {
    objects.iter().filter(|o| matches!(o.surface, Surface::Dielectric(_)))
}

/// The interior on the near side of the first dielectric surface in a direction from a point; `is_outside` of all closed ones.
fn side_seen(parts: &SceneParts, p: DVec3, dir: DVec3, is_outside: bool) -> Option<usize> {
    let ray = Ray::new(p, dir);
    let boundaries = parts.objects.iter().filter_map(|object| {
        let Surface::Dielectric(dielectric) = &object.surface else { return None };
        Some((object.shape.hit(&ray, None)?, &object.shape, dielectric))
    });
    let (hit, shape, dielectric) = boundaries.min_by(|(a, ..), (b, ..)| a.t.total_cmp(&b.t))?;
    Some(near_side((&hit, shape, dielectric), dir, is_outside))
}

/// The interior on the near side of a surface that was hit.
fn near_side((hit, shape, dielectric): (&Hit, &Shape, &Dielectric), dir: DVec3, is_outside: bool) -> usize {
    if is_outside && shape.is_closed() {
        // Where the ray touches an edge, it may have met the back. Normals that point inwards enclose less than nothing.
        return if shape.volume() < 0.0 { dielectric.inside() } else { dielectric.outside() };
    }
    dielectric.sides(dir, hit.normal).0
}

/// What a ray meets first.
enum Ahead<'a> {
    /// A dielectric surface.
    Boundary(SceneHit, &'a Dielectric),
    /// Another body.
    Body,
    /// None.
    Nothing,
}

/// Filters that a ray is followed through: where more seem to lie, they are in one place.
const FILTERS: u32 = 64;

/// Boundaries that are looked at from afar, and rays towards each.
const LOOKED_AT: usize = 16;
const LOOKS: u64 = 64;
/// What fewer than one in so many of these rays meet are gaps.
const GAP: usize = 32;

/// Places on boundaries, to look at from where bodies stand all about.
const MARKS: usize = 16;

/// The places to look at.
pub(super) fn marks(scene: &Scene) -> Vec<DVec3> {
    let boundaries: Vec<&Shape> = dielectrics(scene.objects()).map(|object| &object.shape).collect();
    let mark = |n: usize| {
        let shape = boundaries[n * boundaries.len() / MARKS];
        shape.sample_boundary(Face::Top, DVec2::ONE, spread(n as u32)).0
    };
    (0..if boundaries.is_empty() { 0 } else { MARKS }).map(mark).collect()
}

/// A rank-1 lattice by the plastic number: points that share no line.
fn spread(n: u32) -> [f64; 3] {
    [0.754_877_666, 0.569_840_291, 0.430_159_709].map(|a| (f64::from(n) * a + 0.5).fract())
}

/// The interiors that reach out of the scene, by rays from afar towards boundaries: the one about all closed bodies, or both sides of
/// a surface that encloses nothing. None where no ray meets a boundary first, and that is the surroundings then.
pub(super) fn far(scene: &Scene) -> Vec<usize> {
    let boundaries: Vec<&Shape> = dielectrics(scene.objects()).map(|object| &object.shape).collect();
    if boundaries.is_empty() {
        return Vec::new();
    }
    let slabs = || {
        boundaries.iter().filter_map(|shape| match shape {
            Shape::Slab(slab) => Some(slab),
            _ => None,
        })
    };
    let all = scene.bounds_of_bounded();
    let (center, size) = all.map_or((DVec3::ZERO, 1.0), |all| (all.center(), all.radius()));
    let deep = slabs().map(|slab| {
        let [top, bottom] = [slab.top(), slab.face(Face::Bottom)].map(|z| (z - center.z).abs());
        top.max(bottom)
    });
    let reach = 4.0 * deep.fold(size, f64::max);
    let mut met = vec![0; scene.interiors().len()];
    for (number, shape) in boundaries.iter().step_by(boundaries.len().div_ceil(LOOKED_AT)).enumerate() {
        for look in 0..LOOKS {
            let mut stream = Stream::new(0, Purpose::Ends, number as u64, look);
            let start = center + warp::square_to_sphere(stream.pair()) * reach;
            let (on, ..) = shape.sample_boundary(Face::Top, DVec2::splat(size), stream.triple());
            if slabs().any(|slab| slab.top() <= start.z && start.z <= slab.face(Face::Bottom)) {
                continue;
            }
            let Some(dir) = (on - start).try_normalize() else { continue };
            if let Ahead::Boundary(found, dielectric) = scene.ahead(start, dir) {
                met[dielectric.sides(dir, found.hit.normal).0] += 1;
            }
        }
    }
    let all: usize = met.iter().sum();
    (0..met.len()).filter(|interior| met[*interior] * GAP > all).collect()
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

    /// Number of the interior that a point is in: the first body on a ray from there says it if its surface is dielectric, and a ray that meets
    /// none that this is what lies about the scene. Where neither is found in any of a few directions, nor from places aside, bodies of other
    /// surfaces are looked through.
    pub fn interior_at(&self, p: DVec3) -> usize {
        if !self.plan().has_dielectrics {
            return SURROUNDINGS;
        }
        let about = match self.far.as_slice() {
            [only] => Some(*only),
            _ => None,
        };
        let aside = || {
            let half_way = |dir: DVec3| Some(p + dir * (0.5 * self.hit(&Ray::new(p, dir), None)?.hit.t));
            DIRECTIONS.into_iter().filter_map(half_way).find_map(|place| self.seen_from(place, about))
        };
        // Inside a closed body its boundary lies in every direction.
        let through = || {
            let aslant = side_seen(&self.parts, p, ASLANT, false);
            let side = |dir: &DVec3| side_seen(&self.parts, p, *dir, true);
            aslant.or_else(|| DIRECTIONS.iter().find_map(side))
        };
        self.seen_from(p, about).or_else(aside).or_else(through).or(about).unwrap_or(SURROUNDINGS)
    }

    /// The interior that a ray from a place tells, `about` the scene, where that is one: aslant, along the axes, or towards boundaries.
    fn seen_from(&self, p: DVec3, about: Option<usize>) -> Option<usize> {
        let side = |dir: DVec3, found: &SceneHit, dielectric: &Dielectric, is_outside: bool| {
            let Target::Object(index) = found.target else { return SURROUNDINGS };
            near_side((&found.hit, &self.objects()[index].shape, dielectric), dir, is_outside)
        };
        match self.ahead(p, ASLANT) {
            Ahead::Boundary(found, dielectric) => return Some(side(ASLANT, &found, dielectric, false)),
            Ahead::Nothing if about.is_some() => return about,
            _ => {}
        }
        // Of all closed bodies, whose boundaries lie in every direction from inside them.
        let is_outside = side_seen(&self.parts, p, ASLANT, false).is_none();
        for dir in DIRECTIONS {
            match self.ahead(p, dir) {
                Ahead::Boundary(found, dielectric) => return Some(side(dir, &found, dielectric, is_outside)),
                Ahead::Nothing if about.is_some() => return about,
                _ => {}
            }
        }
        self.marks.iter().filter_map(|mark| (mark - p).try_normalize()).find_map(|dir| {
            match self.ahead(p, dir) {
                Ahead::Boundary(found, dielectric) => Some(side(dir, &found, dielectric, is_outside)),
                _ => None,
            }
        })
    }

    /// What a ray from a point meets first, filters apart.
    fn ahead(&self, p: DVec3, dir: DVec3) -> Ahead<'_> {
        let (mut ray, mut start) = (Ray::new(p, dir), None);
        for _ in 0..FILTERS {
            let Some(found) = self.hit(&ray, start) else { return Ahead::Nothing };
            let surface = match found.target {
                Target::Object(index) => &self.objects()[index].surface,
                Target::Light(_) => return Ahead::Body,
            };
            match surface {
                Surface::Dielectric(dielectric) => return Ahead::Boundary(found, dielectric),
                Surface::Filter(_) => {}
                _ => return Ahead::Body,
            }
            ray = Ray::new(ray.at(found.hit.t), dir);
            start = Some(found.start());
        }
        Ahead::Body
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
