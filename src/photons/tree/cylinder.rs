//! A stretch of a ray with a radius about it, as boxes are asked about it.

use super::block::{BLOCK, Row, cross, dot};
use super::boxes::Boxes;
use super::units::Units;
use super::within::bits;
use crate::math::{Interval, Ray};
use wide::f32x8;

/// Boxes and blocks are looked through in single precision, and let in if they come nearer than the radius and this many units:
/// some roundings of numbers up to [`FAR`].
const MARGIN: f64 = 1e-5;

/// Triple products of unit vectors with a vector are wrong by less than this part of its length: some thirty roundings.
const ROUNDED: f32 = 2e-6;

/// How far from the middle of the map a ray, or how large a radius, may be for that \[units\].
const FAR: f64 = 16.0;

/// Directions of rays have no smaller part: a box is then left at a finite distance.
const LEAST: f64 = 1e-12;

/// A stretch of a ray with a radius about it, in the tree's units.
pub(in crate::photons) struct Cylinder {
    /// The ray's point nearest the middle of the map, from which distances along it count.
    origin: [f32; 3],
    dir: [f32; 3],
    inverse: [f32; 3],
    span: [f32; 2],
    radius: f32,
    /// How far from the ray's own origin distances along it count.
    middle: f64,
}

/// A distance along a ray \[L\] from its point nearest the middle of the map, `middle` along it \[units\]: feet lie no farther from there
/// than the corners of the map do from its middle.
fn along(units: &Units, middle: f64, t: f64) -> f64 {
    (units.shrink(t) - middle).clamp(-2.0, 2.0)
}

impl Cylinder {
    /// The stretch as boxes are asked about it; none where single precision does not tell.
    pub(in crate::photons) fn new(units: &Units, ray: &Ray, span: Interval, radius: f64) -> Option<Self> {
        let origin = units.relative(ray.origin);
        let middle = -origin.dot(ray.dir);
        let nearest = origin + ray.dir * middle;
        let radius = units.shrink(radius);
        if !(nearest.length() <= FAR && radius <= FAR) {
            return None;
        }
        let along = |t: f64| along(units, middle, t);
        let dir = ray.dir.to_array().map(|d| if d.abs() < LEAST { LEAST.copysign(d) } else { d });
        Some(Cylinder {
            origin: nearest.as_vec3().to_array(),
            dir: ray.dir.as_vec3().to_array(),
            inverse: dir.map(|d| (1.0 / d) as f32),
            span: [(along(span.start) - MARGIN) as f32, (along(span.end) + MARGIN) as f32],
            radius: (radius + MARGIN) as f32,
            middle,
        })
    }

    /// The square of the radius \[units^2\].
    pub(super) fn squared_radius(&self) -> f32 {
        self.radius * self.radius
    }

    /// Visits the place of every box of the lowest level, finest first in `levels`, that the cylinder touches with all above it.
    pub(in crate::photons) fn each_touched(&self, levels: &[Vec<Boxes>], mut visit: impl FnMut(usize)) {
        let (mut touched, mut parents) = (vec![0u32], Vec::new());
        for (height, level) in levels.iter().enumerate().rev() {
            std::mem::swap(&mut touched, &mut parents);
            touched.clear();
            for &node in &parents {
                let first = node as usize * BLOCK;
                let inside = bits(self.touched(&level[node as usize])).map(|lane| first + lane);
                if height > 0 {
                    touched.extend(inside.map(|child| child as u32));
                } else {
                    inside.for_each(&mut visit);
                }
            }
        }
    }

    /// The square of another radius, at most its own \[units^2\], in all lanes.
    pub(super) fn squared_reach(&self, radius: f32) -> f32x8 {
        let radius = radius + MARGIN as f32;
        f32x8::splat(radius * radius)
    }

    /// The boxes that the ray meets if they are widened by the radius on all sides, a bit each.
    pub(super) fn touched(&self, boxes: &Boxes) -> u32 {
        self.met(boxes, &[f32x8::splat(self.radius); 2])
    }

    /// The same with a radius for each box, at most its own \[units\].
    pub(super) fn touched_within(&self, boxes: &Boxes, radii: &[f32x8; 2]) -> u32 {
        self.met(boxes, &radii.map(|radius| radius + f32x8::splat(MARGIN as f32)))
    }

    fn met(&self, boxes: &Boxes, radii: &[f32x8; 2]) -> u32 {
        let row = |[lower, upper]: &[Row; 2], radius: f32x8| {
            let mut start = f32x8::splat(self.span[0]);
            let mut end = f32x8::splat(self.span[1]);
            for axis in 0..3 {
                let at = f32x8::splat(self.origin[axis]);
                let inverse = f32x8::splat(self.inverse[axis]);
                let low = (lower[axis] - radius - at) * inverse;
                let high = (upper[axis] + radius - at) * inverse;
                start = start.fast_max(low.fast_min(high));
                end = end.fast_min(low.fast_max(high));
            }
            start.simd_le(end).to_bitmask()
        };
        row(&boxes.rows[0], radii[0]) | row(&boxes.rows[1], radii[1]) << 8
    }

    /// Which of eight stretches of lines, each from `half` before its middle to as far behind it, may come nearest to the ray within the
    /// radius, both nearest points on the stretch and in the span, a bit each: what rounding leaves open is let in, and with it
    /// what is all but parallel.
    ///
    /// With n = d x w and y the way from the ray's origin to the middle, s n^2 = (y x w).n, t n^2 = (y x d).n and u |n| = y.n.
    #[inline(always)]
    pub(in crate::photons) fn near_lines(&self, middles: &Row, dirs: &Row, halves: f32x8) -> u32 {
        let (way, dir) = (self.way(middles), self.dir());
        let across = cross(&dir, dirs);
        let squared = dot(&across, &across);
        let slack = f32x8::splat(ROUNDED) * (dot(&way, &way).sqrt() + f32x8::splat(2.0));
        let is_beside = dot(&way, &across).abs().simd_le(f32x8::splat(self.radius) * squared.sqrt() + slack);
        let along_ray = dot(&cross(&way, dirs), &across);
        let along_line = dot(&cross(&way, &dir), &across).abs();
        let (start, end) = (f32x8::splat(self.span[0]) * squared, f32x8::splat(self.span[1]) * squared);
        let is_in = along_ray.simd_ge(start - slack) & along_ray.simd_le(end + slack);
        (is_beside & is_in & along_line.simd_le(halves * squared + slack)).to_bitmask()
    }

    /// Which of eight stretches of lines may come within the radius of the ray, as [`Cylinder::near_lines`] but anywhere on them.
    #[inline(always)]
    pub(in crate::photons) fn touched_lines(&self, middles: &Row, dirs: &Row, halves: f32x8) -> u32 {
        let (way, dir) = (self.way(middles), self.dir());
        let across = cross(&dir, dirs);
        let slack = f32x8::splat(ROUNDED) * (dot(&way, &way).sqrt() + f32x8::splat(2.0));
        let radius = f32x8::splat(self.radius);
        let is_beside = dot(&way, &across).abs().simd_le(radius * dot(&across, &across).sqrt() + slack);
        let (away, reach) = (cross(&way, &dir), radius + halves);
        let is_near = dot(&away, &away).simd_le(reach * reach) & reach.simd_ge(f32x8::ZERO);
        (is_beside & is_near).to_bitmask()
    }

    /// A part of the ray from end to end, as [`Cylinder::feet`] count, in all lanes.
    pub(super) fn stretch(&self, units: &Units, part: &Interval) -> [f32x8; 2] {
        [part.start, part.end].map(|t| f32x8::splat(along(units, self.middle, t) as f32))
    }

    /// How far along the ray the feet of eight positions are.
    #[inline(always)]
    pub(super) fn feet(&self, positions: &Row) -> f32x8 {
        dot(&self.way(positions), &self.dir())
    }

    /// Which feet may be in the span, rounding allowed for.
    #[inline(always)]
    pub(super) fn holds(&self, feet: f32x8) -> f32x8 {
        feet.simd_ge(f32x8::splat(self.span[0])) & feet.simd_le(f32x8::splat(self.span[1]))
    }

    /// Squared distances of eight positions from the ray.
    #[inline(always)]
    pub(super) fn squared_distances(&self, positions: &Row) -> f32x8 {
        let across = cross(&self.way(positions), &self.dir());
        dot(&across, &across)
    }

    #[inline(always)]
    fn way(&self, to: &Row) -> Row {
        let [x, y, z] = self.origin;
        [to[0] - f32x8::splat(x), to[1] - f32x8::splat(y), to[2] - f32x8::splat(z)]
    }

    #[inline(always)]
    fn dir(&self) -> Row {
        [f32x8::splat(self.dir[0]), f32x8::splat(self.dir[1]), f32x8::splat(self.dir[2])]
    }
}
