//! Many rectangles, tried two at a time.

use super::{Hit, Rectangle};
use crate::math::Ray;
use glam::DVec3;
use wide::f64x2;

const LANES: usize = 2;

/// A vector a lane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Vectors {
    x: f64x2,
    y: f64x2,
    z: f64x2,
}

impl Vectors {
    fn new(lanes: [DVec3; LANES]) -> Self {
        let component = |axis: usize| f64x2::new(lanes.map(|v| v[axis]));
        Vectors { x: component(0), y: component(1), z: component(2) }
    }

    fn splat(v: DVec3) -> Self {
        Vectors::new([v; LANES])
    }

    /// In the order in which glam adds.
    #[inline(always)]
    fn dot(self, other: Self) -> f64x2 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Vectors { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    fn moved(self, dir: Self, t: f64x2) -> Self {
        Vectors { x: self.x + dir.x * t, y: self.y + dir.y * t, z: self.z + dir.z * t }
    }
}

/// Two rectangles; a lane without one has a corner that is no number, so that nothing meets it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair {
    corner: Vectors,
    normal: Vectors,
    u: Vectors,
    v: Vectors,
    u_squared: f64x2,
    v_squared: f64x2,
}

/// A list of rectangles that answers what each of them would, bit for bit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rectangles {
    members: Vec<Rectangle>,
    pairs: Vec<Pair>,
}

impl Rectangles {
    /// The list of these.
    pub fn new(members: Vec<Rectangle>) -> Self {
        let pair = |chunk: &[Rectangle]| {
            let lanes = |part: fn(&Rectangle) -> DVec3| {
                Vectors::new(std::array::from_fn(|i| chunk.get(i).map_or(DVec3::NAN, part)))
            };
            let (u, v) = (lanes(Rectangle::u), lanes(Rectangle::v));
            Pair {
                corner: lanes(Rectangle::corner),
                normal: lanes(Rectangle::normal),
                u,
                v,
                u_squared: u.dot(u),
                v_squared: v.dot(v),
            }
        };
        let pairs = members.chunks(LANES).map(pair).collect();
        Rectangles { members, pairs }
    }

    /// Calls `found` with the index and the distance \[L\] of each rectangle that the ray meets, ahead and nearer than
    /// the bound, which starts at `end`, or as near as the other one of its pair; `found` returns the next bound, none to
    /// stop.
    #[inline(always)]
    fn visit(&self, ray: &Ray, end: f64, mut found: impl FnMut(usize, f64) -> Option<f64>) {
        let (origin, dir) = (Vectors::splat(ray.origin), Vectors::splat(ray.dir));
        let (zero, mut bound) = (f64x2::ZERO, f64x2::splat(end));
        for (index, pair) in self.pairs.iter().enumerate() {
            let t = pair.corner.minus(origin).dot(pair.normal) / dir.dot(pair.normal);
            let p = origin.moved(dir, t).minus(pair.corner);
            let (a, b) = (p.dot(pair.u), p.dot(pair.v));
            let inside =
                a.simd_ge(zero) & a.simd_le(pair.u_squared) & b.simd_ge(zero) & b.simd_le(pair.v_squared);
            let mut mask = (inside & t.simd_gt(zero) & t.simd_lt(bound)).to_bitmask();
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let Some(next) = found(LANES * index + lane, t.as_array()[lane]) else { return };
                bound = f64x2::splat(next);
            }
        }
    }

    /// The nearest one ahead but `except`: its index and where the ray meets it; the first in the list of those at
    /// the same distance.
    pub fn nearest(&self, ray: &Ray, except: Option<usize>) -> Option<(usize, Hit)> {
        let (mut nearest, mut bound) = (None, f64::INFINITY);
        self.visit(ray, bound, |index, t| {
            if except != Some(index) && t < bound {
                (nearest, bound) = (Some((index, t)), t);
            }
            Some(bound)
        });
        nearest.map(|(index, t)| (index, self.members[index].hit_at(ray, t)))
    }

    /// Whether the ray meets one of them nearer than `end` \[L\], apart from these two.
    pub fn block(&self, ray: &Ray, except: [Option<usize>; 2], end: f64) -> bool {
        let mut is_blocked = false;
        self.visit(ray, end, |index, _| {
            is_blocked = !except.contains(&Some(index));
            (!is_blocked).then_some(end)
        });
        is_blocked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, warp};
    use crate::rng::{Purpose, Stream};

    /// Among 23 rectangles, some along the axes so that rays in their planes occur, the list finds what the
    /// rectangles find one by one, to the last bit.
    #[test]
    fn the_list_finds_what_its_members_find() {
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        let point = |stream: &mut Stream| DVec3::from(stream.triple()) * 4.0 - 2.0;
        let rectangles: Vec<Rectangle> = (0..23)
            .map(|i| {
                let frame = match i % 3 {
                    0 => Frame { x: DVec3::X, y: DVec3::Y, z: DVec3::Z },
                    1 => Frame { x: DVec3::Y, y: DVec3::Z, z: DVec3::X },
                    _ => Frame::new(warp::square_to_sphere(stream.pair())),
                };
                let [a, b] = stream.pair().map(|x| 0.1 + 3.0 * x);
                Rectangle::new(point(&mut stream), frame.x * a, frame.y * b).unwrap()
            })
            .collect();
        let list = Rectangles::new(rectangles.clone());
        let mut hits = 0;
        for i in 0..20_000 {
            let dir = match i % 4 {
                0 => DVec3::AXES[i / 4 % 3],
                _ => warp::square_to_sphere(stream.pair()),
            };
            let origin = if i % 5 == 0 { rectangles[i % 23].corner() } else { point(&mut stream) };
            let ray = Ray::new(origin, dir);
            let except = (i % 2 == 0).then_some(i % 23);
            let mut expected: Option<(usize, Hit)> = None;
            for (index, rectangle) in rectangles.iter().enumerate() {
                if let Some(hit) = rectangle.hit(&ray, except == Some(index))
                    && expected.is_none_or(|(_, nearest)| hit.t < nearest.t)
                {
                    expected = Some((index, hit));
                }
            }
            let found = list.nearest(&ray, except);
            assert_eq!(found, expected, "{ray:?}");
            let end = 3.0 * stream.unit();
            let is_blocked = expected.is_some_and(|(_, hit)| hit.t < end);
            assert_eq!(list.block(&ray, [None, except], end), is_blocked, "{ray:?}");
            hits += usize::from(found.is_some());
        }
        assert!(hits > 5_000, "{hits}");
        assert_eq!(Rectangles::default().nearest(&Ray::new(DVec3::ZERO, DVec3::X), None), None);
    }
}
