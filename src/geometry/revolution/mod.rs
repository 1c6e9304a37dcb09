//! A surface of revolution.

mod line;
mod profile;
mod tree;

use line::Line;
pub use profile::smooth;

use super::{ASLANT, Hit, remainder};
use crate::error::{Error, Result};
use crate::math::{Frame, Ray, atan2, sin_cos};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use tree::Tree;

/// The surface that a profile sweeps out as it turns about an axis: frusta of cones, cylinders and rings, round in
/// azimuth, met exactly.
///
/// The profile is a line of points (radius, height). **Outwards is to its right**, seen with the radius to the right and
/// the height upwards: a profile that rises has its outer side away from the axis. A closed body starts on the axis below,
/// runs outwards along the underside, up the outer wall and back to the axis, or ends where it began.
#[derive(Debug, Clone)]
pub struct Revolution {
    base: DVec3,
    frame: Frame,
    rings: Vec<DVec2>,
    tree: Tree,
    /// Sum of the areas up to and with each frustum [L^2].
    areas: Vec<f64>,
    /// Radius and half-height of the profile's box, and the height of its middle \[L\].
    size: DVec3,
}

impl PartialEq for Revolution {
    fn eq(&self, other: &Revolution) -> bool {
        (self.base, self.frame, &self.rings) == (other.base, other.frame, &other.rings)
    }
}

/// Far beyond every distance, so that its square is still finite.
const FAR: f64 = 1e150;

impl Line {
    fn new(lathe: &Revolution, ray: &Ray) -> Self {
        let (p, d) = (lathe.frame.to_local(ray.origin - lathe.base), lathe.frame.to_local(ray.dir));
        let shift = -(p - DVec3::Z * lathe.size.z).dot(d);
        let origin = p + d * shift;
        Line { origin, dir: d, shift, a: d.truncate().length_squared() }
    }

    /// Squared distance from the axis.
    fn axial(&self, t: f64) -> f64 {
        self.across(t).length_squared()
    }

    /// The position across the axis.
    fn across(&self, t: f64) -> DVec2 {
        self.origin.truncate() + self.dir.truncate() * t
    }

    /// Where the line passes a height. A level line counts as rising by less than anything.
    fn at_height(&self, z: f64) -> f64 {
        let rise = if self.dir.z == 0.0 { f64::MIN_POSITIVE } else { self.dir.z };
        ((z - self.origin.z) / rise).clamp(-FAR, FAR)
    }
}

/// Part of the body's size within which a crossing may be the one that the ray starts from: a ray that grazes the surface
/// at the angle at which rounding hides it, 1e-8, crosses it within 1e-8 of the size.
const NEAR: f64 = 1.0 / (1u64 << 20) as f64;

impl Revolution {
    /// Whether two surfaces are one but for a part of their size and of their distance from the origin.
    pub fn nearly(&self, other: &Revolution, part: f64) -> bool {
        let least = part * (self.size.abs().max_element() + self.base.abs().max_element());
        self.rings.len() == other.rings.len()
            && (self.base - other.base).length() <= least
            && (self.frame.z - other.frame.z).length() <= part
            && self.rings.iter().zip(&other.rings).all(|(a, b)| a.distance(*b) <= least)
    }

    /// Where its axis begins \[L\].
    pub fn base(&self) -> DVec3 {
        self.base
    }

    /// Unit directions: two across the axis, and that of the axis.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The profile: points (radius, height) \[L\].
    pub fn profile(&self) -> &[DVec2] {
        &self.rings
    }

    /// The flat parts: middle, normal, inner and outer radius \[L\].
    pub fn discs(&self) -> impl Iterator<Item = (DVec3, DVec3, [f64; 2])> {
        let flat = self.rings.windows(2).filter(|pair| pair[0].y == pair[1].y && pair[0].x != pair[1].x);
        flat.map(|pair| {
            let radii = [pair[0].x.min(pair[1].x), pair[0].x.max(pair[1].x)];
            (self.base + self.frame.z * pair[0].y, self.frame.z, radii)
        })
    }

    /// A surface about the axis that starts at `base` \[L\] and runs along `axis`, of any length but 0, from points
    /// (radius, height) \[L\] in their order; points that repeat the one before are left out.
    ///
    /// # Errors     `Error::Scene` or `Error::OutOfRange` for numbers that are not finite, a negative radius, or fewer
    /// than two points with a surface between them
    pub fn new(base: DVec3, axis: DVec3, profile: &[DVec2]) -> Result<Self> {
        let Some(axis) = axis.try_normalize().filter(|_| base.is_finite()) else {
            return Err(Error::Scene("a lathe needs a finite base and an axis other than 0 0 0".into()));
        };
        for point in profile {
            if !(point.x >= 0.0 && point.x < 1e100) {
                return Err(Error::out_of_range("radius of a profile", point.x, "finite and at least 0"));
            }
            if point.y.is_nan() || point.y.abs() >= 1e100 {
                return Err(Error::out_of_range("height of a profile", point.y, "finite"));
            }
        }
        let mut rings = profile.to_vec();
        rings.dedup();
        if rings.windows(2).all(|pair| pair[0].x + pair[1].x == 0.0) {
            return Err(Error::Scene("a profile needs two points that are not both on the axis".into()));
        }
        let mut sum = 0.0;
        let areas = rings
            .windows(2)
            .map(|pair| {
                sum += PI * (pair[0].x + pair[1].x) * pair[0].distance(pair[1]);
                sum
            })
            .collect();
        let low = rings.iter().copied().reduce(DVec2::min).unwrap_or_default();
        let high = rings.iter().copied().reduce(DVec2::max).unwrap_or_default();
        let size = DVec3::new(high.x, 0.5 * (high.y - low.y), 0.5 * (high.y + low.y));
        let tree = Tree::new(&rings);
        Ok(Revolution { base, frame: Frame::new(axis), rings, tree, areas, size })
    }

    /// Every crossing of the line with frustum `k`: `found` gets its distance along the line.
    ///
    /// On which side of each ring the line passes is decided once, alike for the frusta on both sides of it, and says how
    /// often a frustum is crossed: so lines find no gap between frusta.
    fn cross(&self, line: &Line, k: usize, mut found: impl FnMut(f64)) {
        let (from, to) = (self.rings[k], self.rings[k + 1]);
        let (t_from, t_to) = (line.at_height(from.y), line.at_height(to.y));
        // A ring on the axis has no inside, whatever rounding says.
        let is_outside = |t: f64, radius: f64| radius == 0.0 || line.axial(t) >= radius * radius;
        let (out_from, out_to) = (is_outside(t_from, from.x), is_outside(t_to, to.x));
        if from.y == to.y {
            if out_from != out_to {
                found(t_from);
            }
            return;
        }
        let is_forward = t_from <= t_to;
        let (low, high) = if is_forward { (t_from, t_to) } else { (t_to, t_from) };
        let (enters, leaves) = if is_forward { (out_from, out_to) } else { (out_to, out_from) };
        if !enters && !leaves {
            return;
        }
        // From the narrower ring, where a tip would lose the most digits, unless the line passes it far away: squared
        // distance from the axis less the squared radius there, a t^2 + 2 b t + c.
        let slope = (to.x - from.x) / (to.y - from.y);
        let ring = if from.x <= to.x { (t_from, from.x) } else { (t_to, to.x) };
        let (start, radius) = if ring.0.abs() <= 8.0 * (self.size.x + self.size.y) {
            ring
        } else {
            let nearest = 0f64.clamp(low, high);
            (nearest, from.x + slope * (line.origin.z + nearest * line.dir.z - from.y))
        };
        let (low, high) = (low - start, high - start);
        let widening = slope * line.dir.z;
        let a = line.a - widening * widening;
        let b = line.across(start).dot(line.dir.truncate()) - radius * widening;
        let c = line.axial(start) - radius * radius;
        let discriminant = b * b - a * c;
        if enters && leaves && !(a > 0.0 && discriminant > 0.0 && low < -b / a && -b / a < high) {
            return;
        }
        let root = discriminant.max(0.0).sqrt();
        let q = -(b + root.copysign(b));
        // Where the value falls, and where it rises.
        let (falling, rising) = if discriminant <= 0.0 {
            (-b / a, -b / a)
        } else if b.is_sign_positive() {
            (q / a, c / q)
        } else {
            (c / q, q / a)
        };
        let within = |t: f64| start + if t.is_nan() { 0.0 } else { t }.clamp(low, high);
        if enters {
            found(within(falling));
        }
        if leaves {
            found(within(rising));
        }
    }

    /// The first crossing ahead; `from` is the frustum that the ray starts on: then the crossing nearest to the start is
    /// the start.
    pub fn hit(&self, ray: &Ray, from: Option<u32>) -> Option<Hit> {
        let line = Line::new(self, ray);
        let reach = NEAR * (self.size.x + self.size.y);
        let (mut start, mut best) = ((f64::INFINITY, 0), (f64::INFINITY, 0));
        let is_start = |t: f64| from.is_some() && t.abs() <= reach;
        self.tree.search(&line, |k, _| {
            self.cross(&line, k, |t| {
                let mut crossing = (t + line.shift, k);
                if is_start(crossing.0) && crossing.0.abs() < start.0.abs() {
                    std::mem::swap(&mut crossing, &mut start);
                }
                if crossing.0 > 0.0 && crossing.0 < best.0 {
                    best = crossing;
                }
            });
            best.0 - line.shift
        });
        let (t, k) = best;
        t.is_finite().then(|| self.hit_at(ray, t, k))
    }

    fn hit_at(&self, ray: &Ray, t: f64, k: usize) -> Hit {
        let p = self.frame.to_local(ray.at(t) - self.base);
        let (from, to) = (self.rings[k], self.rings[k + 1]);
        let along = (to - from) / from.distance(to);
        let part =
            ((DVec2::new(p.truncate().length(), p.z) - from).dot(along) / from.distance(to)).clamp(0.0, 1.0);
        let turn = 0.5 + atan2(-p.y, -p.x) / (2.0 * PI);
        let uv = DVec2::new(turn.clamp(0.0, 1.0), (k as f64 + part) / (self.rings.len() - 1) as f64);
        let normal = self.normal(p.truncate(), k);
        Hit { t, normal, shading: normal, uv, primitive: k as u32 }
    }

    /// Outward normal of frustum `k` above a point across the axis.
    fn normal(&self, across: DVec2, k: usize) -> DVec3 {
        let along = self.rings[k + 1] - self.rings[k];
        let radial = across.normalize_or_zero();
        self.frame.to_world((radial * along.y).extend(-along.x)).normalize()
    }

    /// Area [L^2] of the outer side.
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// A uniform point of the surface, the outward normal there and the number of its frustum, from two numbers in
    /// [0, 1).
    pub fn sample_surface(&self, [u, w]: [f64; 2]) -> (DVec3, DVec3, u32) {
        let target = u * self.area();
        let k = self.areas.partition_point(|&sum| sum <= target).min(self.areas.len() - 1);
        let v = remainder(&self.areas, k, target);
        let (from, to) = (self.rings[k], self.rings[k + 1]);
        // The area up to a part s of the way is in proportion to 2 r0 s + (r1 - r0) s^2.
        let (r0, r1) = (from.x, to.x);
        let part = v * (r0 + r1) / (r0 + (r0 * r0 + v * (r1 * r1 - r0 * r0)).sqrt());
        let ring = from + (to - from) * if part.is_finite() { part.min(1.0) } else { 0.0 };
        let (sin, cos) = sin_cos(2.0 * PI * w);
        let across = DVec2::new(cos, sin);
        let p = self.base + self.frame.to_world((across * ring.x).extend(ring.y));
        (p, self.normal(across, k), k as u32)
    }

    /// Whether the surface has an inside: both ends on the axis, or the end where it began.
    pub fn is_closed(&self) -> bool {
        let (first, last) = (self.rings[0], self.rings[self.rings.len() - 1]);
        first == last || (first.x == 0.0 && last.x == 0.0)
    }

    /// Whether a point lies inside a closed lathe: the first crossing of a ray from it tells.
    pub fn contains(&self, p: DVec3) -> bool {
        let ray = Ray::new(p, ASLANT);
        self.hit(&ray, None).is_some_and(|hit| hit.normal.dot(ray.dir) > 0.0)
    }

    /// Distance from a point to the surface, or `limit` where that is farther \[L\]: that to the profile, in the half
    /// plane of the axis and the point.
    pub fn distance(&self, p: DVec3, limit: f64) -> f64 {
        let p = self.frame.to_local(p - self.base);
        let p = DVec2::new(p.truncate().length(), p.z);
        let mut nearest = limit;
        self.tree.near(p, limit, |k, reach| {
            let (from, to) = (self.rings[k], self.rings[k + 1]);
            let along = to - from;
            let part = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min(p.distance(from + along * part));
            nearest.min(reach)
        });
        nearest
    }

    /// Middle and radius of a sphere about it \[L\].
    pub fn bounds(&self) -> (DVec3, f64) {
        let radius = DVec2::new(self.size.x, self.size.y).length();
        (self.base + self.frame.z * self.size.z, radius)
    }

    /// Volume that a closed surface encloses [L^3], by the frusta under the profile.
    pub fn volume(&self) -> f64 {
        let frustum = |pair: &[DVec2]| {
            let (r0, r1) = (pair[0].x, pair[1].x);
            PI / 3.0 * (r0 * r0 + r0 * r1 + r1 * r1) * (pair[1].y - pair[0].y)
        };
        self.rings.windows(2).map(frustum).sum()
    }

    /// Shortest of its diameter and its height \[L\].
    pub fn shortest_extent(&self) -> f64 {
        2.0 * self.size.x.min(self.size.y)
    }
}
