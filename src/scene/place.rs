//! Which interior a place is in: what a straight look from it meets first says it.

use super::{Object, SURROUNDINGS, Scene, SceneHit, SceneParts, Target};
use crate::geometry::{ASLANT, Face, Hit, Shape};
use crate::math::{Ray, warp};
use crate::rng::{Purpose, Stream};
use crate::surface::{Dielectric, Surface};
use glam::{DVec2, DVec3};

/// Where to look for boundaries that are not met aslant: up and down first since water is level.
const DIRECTIONS: [DVec3; 6] = [DVec3::Z, DVec3::NEG_Z, DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::NEG_X];

/// The objects that are boundaries of interiors.
pub(super) fn dielectrics(objects: &[Object]) -> impl Iterator<Item = &Object> {
    objects.iter().filter(|o| matches!(o.surface, Surface::Dielectric(_)))
}

/// The interior on the near side of the first dielectric surface in a direction from a point; `is_outside` of all closed ones.
pub(super) fn side_seen(parts: &SceneParts, p: DVec3, dir: DVec3, is_outside: bool) -> Option<usize> {
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
pub(super) fn spread(n: u32) -> [f64; 3] {
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

impl Scene {
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
}
