//! Many rectangles, tried two at a time.

use super::Rectangle;
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
pub struct Rectangles(Vec<Pair>);

impl Rectangles {
    /// The list of these.
    pub fn new(rectangles: &[Rectangle]) -> Self {
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
        Rectangles(rectangles.chunks(LANES).map(pair).collect())
    }

    /// Calls `found` with the index and the distance \[L\] of each rectangle but `except` that the ray meets nearer
    /// than the bound, which starts at `end`; `found` returns the next bound.
    #[inline(always)]
    fn visit(&self, ray: &Ray, except: Option<usize>, end: f64, mut found: impl FnMut(usize, f64) -> f64) {
        let (origin, dir) = (Vectors::splat(ray.origin), Vectors::splat(ray.dir));
        let (zero, mut bound) = (f64x2::ZERO, end);
        for (index, pair) in self.0.iter().enumerate() {
            let t = pair.corner.minus(origin).dot(pair.normal) / dir.dot(pair.normal);
            let p = origin.moved(dir, t).minus(pair.corner);
            let (a, b) = (p.dot(pair.u), p.dot(pair.v));
            let inside =
                a.simd_ge(zero) & a.simd_le(pair.u_squared) & b.simd_ge(zero) & b.simd_le(pair.v_squared);
            let mut mask = (inside & t.simd_gt(zero)).to_bitmask();
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let (index, t) = (LANES * index + lane, t.as_array()[lane]);
                if t < bound && except != Some(index) {
                    bound = found(index, t);
                }
            }
        }
    }

    /// Index and distance \[L\] of the nearest one ahead but `except`, if it is nearer than `end`; the first in the
    /// list of those at the same distance.
    pub fn nearest(&self, ray: &Ray, except: Option<usize>, end: f64) -> Option<(usize, f64)> {
        let mut nearest = None;
        self.visit(ray, except, end, |index, t| {
            nearest = Some((index, t));
            t
        });
        nearest
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
        let list = Rectangles::new(&rectangles);
        let mut hits = 0;
        for i in 0..20_000 {
            let dir = match i % 4 {
                0 => DVec3::AXES[i / 4 % 3],
                _ => warp::square_to_sphere(stream.pair()),
            };
            let origin = if i % 5 == 0 { rectangles[i % 23].corner() } else { point(&mut stream) };
            let ray = Ray::new(origin, dir);
            let except = (i % 2 == 0).then_some(i % 23);
            let end = if i % 7 == 0 { 1.0 } else { f64::INFINITY };
            let mut expected: Option<(usize, f64)> = None;
            for (index, rectangle) in rectangles.iter().enumerate() {
                if let Some(hit) = rectangle.hit(&ray, except == Some(index))
                    && hit.t < expected.map_or(end, |(_, t)| t)
                {
                    expected = Some((index, hit.t));
                }
            }
            let found = list.nearest(&ray, except, end);
            assert_eq!(found.map(|(i, t)| (i, t.to_bits())), expected.map(|(i, t)| (i, t.to_bits())), "{ray:?}");
            hits += usize::from(found.is_some());
        }
        assert!(hits > 5_000, "{hits}");
        assert_eq!(Rectangles::default().nearest(&Ray::new(DVec3::ZERO, DVec3::X), None, 1.0), None);
    }
}
