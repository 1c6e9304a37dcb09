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
    /// Indices in the list.
    number: f64x2,
}

impl Pair {
    fn new(first: usize, members: &[Rectangle]) -> Self {
        let lanes = |part: fn(&Rectangle) -> DVec3| {
            Vectors::new(std::array::from_fn(|i| members.get(i).map_or(DVec3::NAN, part)))
        };
        let (u, v) = (lanes(Rectangle::u), lanes(Rectangle::v));
        Pair {
            corner: lanes(Rectangle::corner),
            normal: lanes(Rectangle::normal),
            u,
            v,
            u_squared: u.dot(u),
            v_squared: v.dot(v),
            number: f64x2::new(std::array::from_fn(|i| (first + i) as f64)),
        }
    }

    /// Distances \[L\], and which lanes are met there, ahead and nearer than `bound`.
    #[inline(always)]
    fn meet(&self, origin: Vectors, dir: Vectors, bound: f64x2) -> (f64x2, f64x2) {
        let t = self.corner.minus(origin).dot(self.normal) / dir.dot(self.normal);
        let p = origin.moved(dir, t).minus(self.corner);
        let (a, b, zero) = (p.dot(self.u), p.dot(self.v), f64x2::ZERO);
        let inside =
            a.simd_ge(zero) & a.simd_le(self.u_squared) & b.simd_ge(zero) & b.simd_le(self.v_squared);
        (t, inside & t.simd_gt(zero) & t.simd_lt(bound))
    }
}

/// A list of rectangles that answers what each of them would, bit for bit.
///
/// Nothing branches on what single rectangles answer: which of them a ray meets is as good as random, and a branch
/// foretold wrongly costs as much as a pair of rectangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rectangles {
    members: Vec<Rectangle>,
    pairs: Vec<Pair>,
}

/// An index in the list as a number in every lane; -1, which none has, for none.
fn lanes_of(index: Option<usize>) -> f64x2 {
    f64x2::splat(index.map_or(-1.0, |index| index as f64))
}

impl Rectangles {
    /// The list of these.
    pub fn new(members: Vec<Rectangle>) -> Self {
        let pairs = members.chunks(LANES).enumerate().map(|(i, chunk)| Pair::new(LANES * i, chunk)).collect();
        Rectangles { members, pairs }
    }

    /// The nearest one ahead but `except`: its index and where the ray meets it; the first in the list of those at
    /// the same distance.
    pub fn nearest(&self, ray: &Ray, except: Option<usize>) -> Option<(usize, Hit)> {
        let (origin, dir) = (Vectors::splat(ray.origin), Vectors::splat(ray.dir));
        let except = lanes_of(except);
        let (mut nearest, mut number) = (f64x2::splat(f64::INFINITY), lanes_of(None));
        for pair in &self.pairs {
            let (t, met) = pair.meet(origin, dir, nearest);
            let is_nearer = met & pair.number.simd_ne(except);
            nearest = is_nearer.select(t, nearest);
            number = is_nearer.select(pair.number, number);
        }
        let ([a, b], [i, j]) = (nearest.to_array(), number.to_array());
        let (t, index) = if a < b || a == b && i < j { (a, i) } else { (b, j) };
        (t < f64::INFINITY).then(|| (index as usize, self.members[index as usize].hit_at(ray, t)))
    }

    /// Whether the ray meets one of them nearer than `end` \[L\], apart from these two.
    pub fn block(&self, ray: &Ray, except: [Option<usize>; 2], end: f64) -> bool {
        let (origin, dir) = (Vectors::splat(ray.origin), Vectors::splat(ray.dir));
        let ([one, other], end) = (except.map(lanes_of), f64x2::splat(end));
        self.pairs.iter().any(|pair| {
            let (_, met) = pair.meet(origin, dir, end);
            (met & pair.number.simd_ne(one) & pair.number.simd_ne(other)).any()
        })
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
