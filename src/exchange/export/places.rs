//! Which medium lies on either side of a boundary: Mitsuba asks it of every one, where a scene says it by the order of regions.

use super::writer::refuse;
use crate::error::Result;
use crate::geometry::{Cuboid, Shape};
use crate::light::Light;
use crate::medium::Medium;
use crate::scene::Scene;
use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// Whether it collides with anything.
pub(super) fn is_there(medium: &Medium) -> bool {
    !medium.highest_sigma_t().is_black()
}

/// Where a body lies, as seen from a convex shape.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Relation {
    /// Wholly outside.
    Apart,
    /// Wholly inside.
    Inside,
    /// Around all of it.
    Around,
    /// Neither, or not known.
    Crossing,
}

/// Regions as they are written.
pub(super) struct Places {
    /// Shape of each region; none of one that later ones or interiors cover.
    shapes: Vec<Option<Shape>>,
    /// The region around each, if there is one.
    outer: Vec<Option<usize>>,
    /// Whether each has something to collide with.
    is_there: Vec<bool>,
    notes: Vec<String>,
    nearest: f64,
}

/// Points whose hull holds a bounded shape; of a sphere the corners of its box.
pub(super) fn hull(shape: &Shape) -> Vec<DVec3> {
    let corners = |min: DVec3, max: DVec3| {
        (0..8)
            .map(move |i| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min))
            .collect()
    };
    match shape {
        Shape::Rectangle(rectangle) => rectangle.corners().to_vec(),
        Shape::Cuboid(cuboid) => corners(cuboid.min(), cuboid.max()),
        Shape::Mesh(mesh) => (0..mesh.len() as u32).flat_map(|i| mesh.triangle(i)).collect(),
        Shape::Revolution(body) => {
            let rings = body.profile();
            let low = rings.iter().copied().reduce(DVec2::min).unwrap_or_default();
            let high = rings.iter().copied().reduce(DVec2::max).unwrap_or_default();
            // A square about the widest ring, at both ends.
            let ends = corners(DVec3::new(-high.x, -high.x, low.y), DVec3::new(high.x, high.x, high.y));
            let place = |p: DVec3| body.base() + body.frame().to_world(p);
            let ends: Vec<DVec3> = ends;
            ends.into_iter().map(place).collect()
        }
        Shape::Sphere(_) | Shape::Slab(_) => {
            shape.corners().map_or_else(Vec::new, |(min, max)| corners(min, max))
        }
    }
}

/// Where `body` lies, as seen from a sphere or cuboid, with at least `gap` between their surfaces.
fn relation(solid: &Shape, body: &Shape, gap: f64) -> Relation {
    let is_inside = |solid: &Shape, body: &Shape| match body {
        Shape::Sphere(ball) => solid.room(ball.center()) > ball.radius() + gap,
        _ => hull(body).iter().all(|p| solid.room(*p) > gap),
    };
    if is_inside(solid, body) {
        return Relation::Inside;
    }
    let is_around = match (body.is_solid(), solid.bounds()) {
        (true, _) => is_inside(body, solid),
        (false, Some((center, radius))) => {
            body.is_closed() && body.contains(center) && body.distance(center, f64::MAX) > radius + gap
        }
        (false, None) => false,
    };
    if is_around {
        return Relation::Around;
    }
    let boxes_part = match (solid.corners(), body.corners()) {
        (Some((a, b)), Some((c, d))) => (b + gap).cmplt(c).any() || (d + gap).cmplt(a).any(),
        _ => false,
    };
    let balls_part = |ball: &Shape, other: &Shape| match ball {
        Shape::Sphere(ball) => {
            let (center, reach) = (ball.center(), ball.radius() + gap);
            !other.contains(center) && other.distance(center, f64::MAX) > reach
        }
        _ => false,
    };
    if boxes_part || balls_part(solid, body) || balls_part(body, solid) {
        return Relation::Apart;
    }
    Relation::Crossing
}

/// Points of a body that are held against others, at most.
const MOST_POINTS: usize = 1 << 14;

/// Whether the surfaces of two bodies come nearer to each other than a gap somewhere without crossing, as far as corners and
/// middles of balls tell.
fn is_near(a: &Shape, b: &Shape, gap: f64) -> bool {
    let comes_near = |a: &Shape, b: &Shape| match b {
        Shape::Sphere(ball) => {
            (a.distance(ball.center(), 2.0 * ball.radius() + gap) - ball.radius()).abs() < gap
        }
        Shape::Rectangle(_) | Shape::Cuboid(_) | Shape::Mesh(_) => {
            let points = hull(b);
            points.len() <= MOST_POINTS && points.iter().any(|p| a.distance(*p, 2.0 * gap) < gap)
        }
        Shape::Slab(_) | Shape::Revolution(_) => false,
    };
    comes_near(a, b) || comes_near(b, a)
}

/// Notes of dielectric surfaces that lie so near to other bodies that Mitsuba's rays pass between.
pub(super) fn near_glass(scene: &Scene, gap: f64) -> Vec<String> {
    let objects = scene.objects();
    let is_glass = |i: usize| matches!(&objects[i].surface, Surface::Dielectric(_));
    let mut notes = Vec::new();
    for i in 0..objects.len() {
        let near = (0..i)
            .find(|j| (is_glass(i) || is_glass(*j)) && is_near(&objects[i].shape, &objects[*j].shape, gap));
        if let Some(j) = near {
            notes.push(format!(
                "objects[{j}] and objects[{i}] touch or nearly do: rays of Mitsuba, which leave surfaces by up to {gap:.1e}, may miss one of them there"
            ));
        }
    }
    notes
}

/// The flat parts of opaque bodies and lamps, by their corners.
fn facets(scene: &Scene) -> Vec<Vec<DVec3>> {
    let lamps = scene.named_lights().iter().filter_map(Light::body);
    let walls =
        scene.objects().iter().filter(|o| !matches!(o.surface, Surface::Dielectric(_))).map(|o| &o.shape);
    let of = |shape: &Shape| -> Vec<Vec<DVec3>> {
        match shape {
            Shape::Rectangle(rectangle) => vec![rectangle.corners().to_vec()],
            Shape::Cuboid(cuboid) => cuboid.faces().iter().map(|face| face.corners().to_vec()).collect(),
            Shape::Mesh(mesh) => (0..mesh.len() as u32).map(|i| mesh.triangle(i).to_vec()).collect(),
            Shape::Sphere(_) | Shape::Slab(_) | Shape::Revolution(_) => Vec::new(),
        }
    };
    walls.chain(lamps).flat_map(of).collect()
}

/// A cuboid whose faces that lie in walls are moved behind them; and whether any is.
fn behind_walls(cuboid: &Cuboid, facets: &[Vec<DVec3>], nearest: f64) -> Result<(Cuboid, bool)> {
    let (mut min, mut max) = (cuboid.min(), cuboid.max());
    for axis in 0..3 {
        for (plane, is_high) in [(cuboid.min()[axis], false), (cuboid.max()[axis], true)] {
            let meets = |facet: &&Vec<DVec3>| {
                let ends = |axis: usize| {
                    let at = facet.iter().map(|p| p[axis]);
                    at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
                };
                (0..3).all(|other| {
                    let (low, high) = ends(other);
                    if other == axis {
                        (low - plane).abs() <= nearest && (high - plane).abs() <= nearest
                    } else {
                        low < cuboid.max()[other] && high > cuboid.min()[other]
                    }
                })
            };
            if facets.iter().any(|facet| meets(&facet)) {
                let (end, sign) = if is_high { (&mut max, 1.0) } else { (&mut min, -1.0) };
                end[axis] += sign * 2.0 * nearest;
            }
        }
    }
    Ok((Cuboid::new(min, max)?, min != cuboid.min() || max != cuboid.max()))
}

impl Places {
    pub(super) fn of(scene: &Scene, nearest: f64) -> Result<Self> {
        let regions = scene.regions();
        let is_there: Vec<bool> = regions.iter().map(|region| is_there(&region.medium)).collect();
        let (mut shapes, mut notes) = (Vec::new(), Vec::new());
        let facets = if regions.is_empty() { Vec::new() } else { facets(scene) };
        for (index, region) in regions.iter().enumerate() {
            shapes.push(Some(match &region.shape {
                Shape::Slab(_) => {
                    return refuse(format!(
                        "regions[{index}]: a slab has no lateral end, and Mitsuba no such shape; allowed: a cuboid or a sphere"
                    ));
                }
                Shape::Cuboid(cuboid) => {
                    let (cuboid, is_moved) = behind_walls(cuboid, &facets, nearest)?;
                    if is_moved {
                        notes.push(format!(
                            "regions[{index}] ends in surfaces: its faces there are written {:.1e} behind them",
                            2.0 * nearest
                        ));
                    }
                    Shape::Cuboid(cuboid)
                }
                shape => shape.clone(),
            }));
        }
        let mut places = Places { outer: vec![None; regions.len()], shapes, is_there, notes, nearest };
        places.nest()?;
        places.hide_in_interiors(scene)?;
        Ok(places)
    }

    /// Finds the region about each, and leaves out those that later ones cover.
    fn nest(&mut self) -> Result<()> {
        let count = self.shapes.len();
        let mut inside: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (later, around) in inside.iter_mut().enumerate() {
            for earlier in 0..later {
                let (Some(a), Some(b)) = (&self.shapes[earlier], &self.shapes[later]) else { continue };
                match relation(a, b, self.nearest) {
                    Relation::Apart => {}
                    Relation::Inside => around.push(earlier),
                    Relation::Around => self.shapes[earlier] = None,
                    Relation::Crossing if a == b => self.shapes[earlier] = None,
                    Relation::Crossing => {
                        return refuse(format!(
                            "regions[{earlier}] and regions[{later}] touch or cross; allowed for Mitsuba: one within the other or apart, by {:.1e} or more",
                            self.nearest
                        ));
                    }
                }
            }
        }
        for (later, around) in inside.into_iter().enumerate() {
            let volume = |index: &usize| self.shapes[*index].as_ref().map(Shape::volume);
            self.outer[later] = around
                .into_iter()
                .filter_map(|index| Some((index, volume(&index)?)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(index, _)| index);
        }
        Ok(())
    }

    /// Leaves out regions that lie in an interior, where they do not count.
    fn hide_in_interiors(&mut self, scene: &Scene) -> Result<()> {
        for (number, object) in scene.objects().iter().enumerate() {
            let Surface::Dielectric(boundary) = &object.surface else { continue };
            for index in 0..self.shapes.len() {
                let Some(shape) = &self.shapes[index] else { continue };
                match relation(shape, &object.shape, self.nearest) {
                    Relation::Apart | Relation::Inside => {}
                    Relation::Around if boundary.inside() != 0 => self.shapes[index] = None,
                    Relation::Around => {}
                    Relation::Crossing => {
                        return refuse(format!(
                            "regions[{index}] and objects[{number}], a dielectric surface, touch or cross; allowed for Mitsuba: one within the other or apart, by {:.1e} or more",
                            self.nearest
                        ));
                    }
                }
            }
        }
        Ok(())
    }

    /// What is not quite the same.
    pub(super) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Regions that are written, with their shapes.
    pub(super) fn regions(&self) -> impl Iterator<Item = (usize, &Shape)> {
        self.shapes.iter().enumerate().filter_map(|(index, shape)| Some((index, shape.as_ref()?)))
    }

    /// The shape of a region as it is written.
    pub(super) fn shape(&self, region: usize) -> Option<&Shape> {
        self.shapes.get(region)?.as_ref()
    }

    /// The medium within a region, and the one around it.
    pub(super) fn sides(&self, region: usize) -> [Option<usize>; 2] {
        [Some(region), self.outer[region]].map(|number| number.filter(|number| self.is_there[*number]))
    }

    /// The medium of the surroundings in which a surface lies; of one that meets no surroundings none.
    pub(super) fn region_about(&self, shape: &Shape, is_met: bool) -> Result<Option<usize>> {
        if !is_met {
            return Ok(None);
        }
        let around =
            self.regions().filter(|(_, region)| relation(region, shape, self.nearest) == Relation::Inside);
        let innermost = around.min_by(|(_, a), (_, b)| a.volume().total_cmp(&b.volume()));
        Ok(innermost.map(|(index, _)| index).filter(|index| self.is_there[*index]))
    }

    /// The medium that is written at a point.
    pub(super) fn medium_at(&self, scene: &Scene, p: DVec3) -> Option<usize> {
        let number = scene.medium_number_at(p)?;
        is_there(scene.medium(number)).then_some(number)
    }

    /// The numbers of the media that are written.
    pub(super) fn used(&self, scene: &Scene) -> Vec<usize> {
        let regions = self.regions().map(|(index, _)| index).filter(|index| self.is_there[*index]);
        let filled = (0..scene.interiors().len()).filter_map(|interior| scene.filling(interior));
        regions.chain(filled.filter(|number| is_there(scene.medium(*number)))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Sphere;

    fn cuboid(low: f64, high: f64) -> Shape {
        Shape::Cuboid(Cuboid::new(DVec3::splat(low), DVec3::splat(high)).unwrap())
    }

    fn ball(x: f64, radius: f64) -> Shape {
        Shape::Sphere(Sphere::new(DVec3::new(x, 0.0, 0.0), radius).unwrap())
    }

    #[test]
    fn surfaces_touch_or_not() {
        let table = Shape::Rectangle(
            crate::geometry::Rectangle::new(DVec3::new(-3.0, -1.0, 3.0), 6.0 * DVec3::X, -6.0 * DVec3::Z)
                .unwrap(),
        );
        let cases = [
            (table.clone(), ball(0.0, 1.0), true),
            (table.clone(), ball(0.0, 0.9), false),
            (table.clone(), ball(0.0, 1.1), false),
            (table.clone(), cuboid(-1.0, 1.0), true),
            (table.clone(), cuboid(-0.99, 1.0), false),
            (ball(0.0, 1.0), ball(2.0, 1.0), true),
            (ball(0.0, 1.0), ball(0.5, 0.5), true),
            (ball(0.0, 1.0), ball(0.4, 0.5), false),
        ];
        for (a, b, expected) in cases {
            assert_eq!(is_near(&a, &b, 1e-4), expected, "{a:?} {b:?}");
            assert_eq!(is_near(&b, &a, 1e-4), expected, "{b:?} {a:?}");
        }
    }

    #[test]
    fn bodies_lie_apart_or_in_each_other() {
        let cases = [
            (cuboid(-1.0, 1.0), cuboid(-0.5, 0.5), Relation::Inside),
            (cuboid(-0.5, 0.5), cuboid(-1.0, 1.0), Relation::Around),
            (cuboid(-1.0, 1.0), cuboid(1.0, 2.0), Relation::Crossing),
            (cuboid(-1.0, 1.0), cuboid(1.1, 2.0), Relation::Apart),
            (cuboid(-1.0, 1.0), ball(0.0, 0.99), Relation::Inside),
            (cuboid(-1.0, 1.0), ball(0.0, 1.0), Relation::Crossing),
            (cuboid(-1.0, 1.0), ball(0.0, 1.75), Relation::Around),
            (cuboid(-1.0, 1.0), ball(2.1, 1.0), Relation::Apart),
            (ball(0.0, 1.0), ball(2.1, 1.0), Relation::Apart),
            (ball(0.0, 1.0), ball(2.0, 1.0), Relation::Crossing),
            (ball(0.0, 1.0), cuboid(0.7, 2.0), Relation::Apart),
            (ball(0.0, 1.0), cuboid(-0.5, 0.5), Relation::Inside),
        ];
        for (solid, body, expected) in cases {
            assert_eq!(relation(&solid, &body, 1e-4), expected, "{solid:?} {body:?}");
        }
    }
}
