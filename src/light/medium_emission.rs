//! The light that a medium sends out by itself: where the photons of an emitting medium start.

use super::{Emission, PeriodicCell, PrimarySample};
use crate::Spectrum;
use crate::faults::{Fault, planted};
use crate::geometry::{Cuboid, Face, Shape, remainder};
use crate::math::{FOUR_PI, Interval, Ray, warp};
use crate::medium::Medium;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Boxes along an axis that starts are chosen from, where emission varies or the medium is only part of its box.
const BOXES: usize = 16;

/// Emission of a medium in all directions, wherever it is the medium that counts.
///
/// A start is chosen in proportion to an upper bound of the emission, and a photon leaves with the *chance* that the
/// emission there is of its bound, none where the medium is not: so all that leave have the same power, and what the
/// bound has too much costs no more than a look-up. Photons are right whatever the power is taken to be.
#[derive(Debug, Clone, PartialEq)]
pub struct MediumEmission {
    number: usize,
    interior: usize,
    medium: Medium,
    places: Places,
    power_bound: Spectrum,
    power: Spectrum,
    is_certain: bool,
}

/// Where starts are looked for.
#[derive(Debug, Clone, PartialEq)]
enum Places {
    /// Uniform in a solid shape, which the medium fills evenly.
    Inside(Shape),
    /// In boxes, in proportion to the bounds of what they emit.
    Boxes(Arc<Boxes>),
}

#[derive(Debug, Clone, PartialEq)]
struct Boxes {
    low: DVec3,
    edge: DVec3,
    count: [usize; 3],
    /// Whether they are the part over the cell of a medium without end.
    is_endless: bool,
    /// Bound of the density in each box \[1\], x fastest.
    high: Vec<f64>,
    /// Sums over boxes of bounds of the emitted power.
    cumulated: Vec<f64>,
}

/// A box along the axes about a shape, of a slab over its cell; none for one without end.
fn around(shape: &Shape, periodic_cell: Option<&PeriodicCell>) -> Option<(DVec3, DVec3)> {
    match shape {
        Shape::Cuboid(c) => Some((c.min(), c.max())),
        Shape::Mesh(m) => Some(m.bounds()),
        Shape::Slab(s) => {
            let side = periodic_cell?.side;
            Some((DVec3::new(0.0, 0.0, s.top()), DVec3::new(side.x, side.y, s.face(Face::Bottom))))
        }
        Shape::Sphere(_) | Shape::Rectangle(_) | Shape::Revolution(_) => {
            let (center, radius) = shape.bounds()?;
            Some((center - DVec3::splat(radius), center + DVec3::splat(radius)))
        }
    }
}

impl MediumEmission {
    /// The light of the medium of this number, in the interior `within`, that lies inside `shapes`, or in some of it; none
    /// if they have no end and there is no cell.
    ///
    /// # Arguments
    /// `is_certain` whether the medium fills the one shape there is, so that nobody need be asked where it is
    pub(crate) fn new(
        (number, interior): (usize, usize),
        medium: &Medium,
        shapes: &[&Shape],
        periodic_cell: Option<&PeriodicCell>,
        is_certain: bool,
    ) -> Option<Self> {
        let (low, high) = shapes
            .iter()
            .map(|shape| around(shape, periodic_cell))
            .try_fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), shape| {
                shape.map(|(a, b)| (low.min(a), high.max(b)))
            })?;
        let (places, power_bound) = match (shapes, medium) {
            ([shape], Medium::Homogeneous(medium)) if shape.is_solid() => {
                let (_, volume) = shape.sample_inside(PeriodicCell::side(periodic_cell), [0.0; 3]);
                (Places::Inside((*shape).clone()), medium.emission() * (FOUR_PI * volume))
            }
            _ => {
                let is_endless = shapes.iter().any(|shape| matches!(shape, Shape::Slab(_)));
                let (boxes, power_bound) = Boxes::new(medium, (low, high), is_endless);
                (Places::Boxes(Arc::new(boxes)), power_bound)
            }
        };
        let is_certain = is_certain && matches!(places, Places::Inside(_));
        Some(MediumEmission {
            number,
            interior,
            medium: medium.clone(),
            places,
            power_bound,
            power: power_bound,
            is_certain,
        })
    }

    /// The same with this power \[W\].
    pub(crate) fn with_power(self, power: Spectrum) -> Self {
        MediumEmission { power, ..self }
    }

    /// The corners of a box that holds all starts.
    pub(crate) fn extent(&self, periodic_cell: Option<&PeriodicCell>) -> Option<(DVec3, DVec3)> {
        match &self.places {
            Places::Inside(shape) => around(shape, periodic_cell),
            Places::Boxes(boxes) => Some((boxes.low, boxes.high_corner())),
        }
    }

    /// Number of the medium.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Number of the interior that it is in.
    pub fn interior(&self) -> usize {
        self.interior
    }

    /// Whether every start is one, so that nobody need be asked whether the medium is there.
    pub fn is_certain(&self) -> bool {
        self.is_certain
    }

    pub(super) fn power(&self) -> Spectrum {
        self.power
    }

    pub(super) fn power_bound(&self) -> Spectrum {
        self.power_bound
    }

    pub(super) fn is_grey(&self) -> bool {
        self.power_bound.is_grey()
    }

    /// A ball that holds all starts, as far as there is one.
    pub fn ball(&self) -> Option<(DVec3, f64)> {
        match &self.places {
            Places::Inside(shape) => shape.bounds(),
            Places::Boxes(boxes) => {
                let half = 0.5 * boxes.edge * DVec3::from_array(boxes.count.map(|n| n as f64));
                Some((boxes.low + half, half.length()))
            }
        }
    }

    /// Whether directions can be chosen towards it: not where it fills a slab, which has no end.
    pub fn has_direction(&self) -> bool {
        match &self.places {
            Places::Inside(shape) => shape.bounds().is_some(),
            Places::Boxes(boxes) => !boxes.is_endless && boxes.cumulated.last().is_some_and(|sum| *sum > 0.0),
        }
    }

    /// About the irradiance that it may bring to `p` where nothing absorbs it [W/L^2]: power over the squared distance. 0 if
    /// directions cannot be chosen towards it, and inside, where every direction meets it: there a second ray costs more than it brings.
    pub fn brightness_at(&self, p: DVec3) -> f64 {
        let is_inside = match &self.places {
            Places::Inside(shape) => shape.contains(p),
            Places::Boxes(boxes) => (p.cmpge(boxes.low) & p.cmple(boxes.high_corner())).all(),
        };
        match self.ball().filter(|_| !is_inside && self.has_direction()) {
            Some((center, _)) => self.power_bound.sum() / p.distance_squared(center),
            None => 0.0,
        }
    }

    /// A direction from `p` towards a place where a photon could start; only if it [has one](MediumEmission::has_direction).
    pub fn sample(&self, p: DVec3, u: [f64; 3]) -> Option<DVec3> {
        let start = match &self.places {
            Places::Inside(shape) => shape.sample_inside(DVec2::ZERO, u).0,
            Places::Boxes(boxes) => boxes.place(u).0,
        };
        (start - p).try_normalize()
    }

    /// Density with which [`MediumEmission::sample`] chooses the direction of a ray [1/sr].
    pub fn pdf_solid_angle(&self, ray: &Ray) -> f64 {
        match &self.places {
            Places::Inside(shape) => shape.pdf_towards_inside(ray),
            Places::Boxes(boxes) => boxes.pdf_solid_angle(ray),
        }
    }

    pub(super) fn emit_at(&self, periodic_cell: Option<&PeriodicCell>, numbers: &PrimarySample) -> Emission {
        let dir = warp::square_to_sphere(numbers.direction).normalize();
        let (origin, power, chance) = match &self.places {
            Places::Inside(shape) => {
                let (origin, _) = shape.sample_inside(PeriodicCell::side(periodic_cell), numbers.position);
                (origin, self.power_bound, 1.0)
            }
            Places::Boxes(boxes) => {
                let (origin, high) = boxes.place(numbers.position);
                let (here, bound) = (self.medium.emission(origin), emission_of(&self.medium, high));
                let chance = (here.sum() / bound.sum()).min(1.0);
                let color = if here.is_black() { Spectrum::ZERO } else { here / here.sum() };
                let power = if planted(Fault::GlowColorOfAll) {
                    self.power_bound
                } else {
                    color * self.power_bound.sum()
                };
                (origin, power, chance)
            }
        };
        Emission { ray: Ray::new(origin, dir), primitive: 0, power, chance }
    }
}

/// Emission where the density is known [W/(L^3 sr)].
fn emission_of(medium: &Medium, density: f64) -> Spectrum {
    match medium {
        Medium::Homogeneous(medium) => medium.emission(),
        Medium::Heterogeneous(medium) => medium.emission_of(density),
    }
}

impl Boxes {
    /// Boxes between two corners, and the bound of the power that they send out \[W\].
    fn new(medium: &Medium, (low, high): (DVec3, DVec3), is_endless: bool) -> (Self, Spectrum) {
        let along = |axis| if medium.is_layered() && axis < 2 { 1 } else { BOXES };
        let count = [0, 1, 2].map(along);
        let edge = (high - low) / DVec3::from_array(count.map(|n| n as f64));
        let volume = FOUR_PI * edge.element_product();
        let (mut bounds, mut cumulated, mut power_bound) = (Vec::new(), Vec::new(), Spectrum::ZERO);
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let corner = low + edge * DVec3::new(x as f64, y as f64, z as f64);
                    let bound = medium.density().map_or(1.0, |d| d.high_in(corner, corner + edge));
                    bounds.push(bound);
                    power_bound += emission_of(medium, bound) * volume;
                    cumulated.push(power_bound.sum());
                }
            }
        }
        (Boxes { low, edge, count, is_endless, high: bounds, cumulated }, power_bound)
    }

    fn high_corner(&self) -> DVec3 {
        self.low + self.edge * DVec3::from_array(self.count.map(|n| n as f64))
    }

    /// A start, and the bound of the density in its box.
    fn place(&self, u: [f64; 3]) -> (DVec3, f64) {
        let total = self.cumulated.last().copied().unwrap_or(0.0);
        let target = u[0] * total;
        // The first box whose sum exceeds the target: one that emits nothing is never it.
        let index = self.cumulated.partition_point(|sum| *sum <= target).min(self.high.len() - 1);
        let [nx, ny, _] = self.count;
        let corner = DVec3::new((index % nx) as f64, (index / nx % ny) as f64, (index / nx / ny) as f64);
        let interior = DVec3::new(remainder(&self.cumulated, index, target), u[1], u[2]);
        (self.low + self.edge * (corner + interior), self.high[index])
    }
    /// Density of the direction to a start [1/sr]: over each box that the ray crosses, int t^2 dt times the density of starts.
    fn pdf_solid_angle(&self, ray: &Ray) -> f64 {
        let total = self.cumulated.last().copied().unwrap_or(0.0);
        let Some(inside) =
            Cuboid::new(self.low, self.high_corner()).ok().and_then(|c| Shape::Cuboid(c).interval(ray))
        else {
            return 0.0;
        };
        let entry = (ray.at(inside.start) - self.low) / self.edge;
        let mut at = [0, 1, 2].map(|i| (entry[i] as usize).min(self.count[i] - 1));
        // Where the ray leaves its box along an axis.
        let leaves = |at: [usize; 3], i: usize| match ray.dir[i] {
            d if d > 0.0 => (self.low[i] + self.edge[i] * (at[i] + 1) as f64 - ray.origin[i]) / d,
            d if d < 0.0 => (self.low[i] + self.edge[i] * at[i] as f64 - ray.origin[i]) / d,
            _ => f64::INFINITY,
        };
        let (mut sum, mut start) = (0.0, inside.start);
        loop {
            let ends = DVec3::from_array([0, 1, 2].map(|i| leaves(at, i)));
            let axis = ends.min_position();
            let end = ends[axis].clamp(start, inside.end);
            let index = (at[2] * self.count[1] + at[1]) * self.count[0] + at[0];
            let before = if index > 0 { self.cumulated[index - 1] } else { 0.0 };
            sum += (self.cumulated[index] - before) * Interval { start, end }.squared_distances();
            let is_last = if ray.dir[axis] > 0.0 { at[axis] + 1 == self.count[axis] } else { at[axis] == 0 };
            if is_last || end >= inside.end {
                return sum / (total * self.edge.element_product());
            }
            at[axis] = if ray.dir[axis] > 0.0 { at[axis] + 1 } else { at[axis] - 1 };
            start = end;
        }
    }
}
