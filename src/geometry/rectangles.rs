//! Many rectangles, tried as many at a time as the machine's registers hold.

use super::{Hit, Rectangle};
use crate::math::Ray;
use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};

/// Rectangles a block: as many as the widest registers hold; others take a block in several goes.
const WIDTH: usize = 8;

/// One number of each rectangle of a block.
type Column = [f64; WIDTH];

/// Some rectangles; a place without one has a corner that is not a number, so that nothing meets it.
#[derive(Debug, Clone, Copy)]
struct Block {
    corner: [Column; 3],
    normal: [Column; 3],
    u: [Column; 3],
    v: [Column; 3],
    u_squared: Column,
    v_squared: Column,
    /// Indices in the list.
    number: Column,
    /// Index of the first one of those that lie in one place.
    place: Column,
}

impl Block {
    fn new(first: usize, members: &[Rectangle], places: &[usize]) -> Self {
        let number_of = |part: fn(&Rectangle) -> f64| -> Column {
            std::array::from_fn(|i| members.get(i).map_or(f64::NAN, part))
        };
        let columns = |part: fn(&Rectangle) -> DVec3| -> [Column; 3] {
            let places: [DVec3; WIDTH] = std::array::from_fn(|i| members.get(i).map_or(DVec3::NAN, part));
            std::array::from_fn(|axis| places.map(|v| v[axis]))
        };
        Block {
            corner: columns(Rectangle::corner),
            normal: columns(Rectangle::normal),
            u: columns(Rectangle::u),
            v: columns(Rectangle::v),
            u_squared: number_of(|r| r.u().length_squared()),
            v_squared: number_of(|r| r.v().length_squared()),
            number: std::array::from_fn(|i| (first + i) as f64),
            place: std::array::from_fn(|i| places.get(i).map_or(f64::NAN, |place| *place as f64)),
        }
    }
}

/// A vector a lane.
type Vectors<S> = [<S as Simd>::f64s; 3];

// Written out, without closures and iterators: only functions that are always inlined run in the registers chosen.

#[inline(always)]
fn splat<S: Simd>(simd: S, v: DVec3) -> Vectors<S> {
    [simd.splat_f64s(v.x), simd.splat_f64s(v.y), simd.splat_f64s(v.z)]
}

#[inline(always)]
fn load<S: Simd>(columns: &[Column; 3], go: usize) -> Vectors<S> {
    let [x, y, z] = columns;
    [lanes::<S>(x, go), lanes::<S>(y, go), lanes::<S>(z, go)]
}

/// The numbers of a block that one register holds.
#[inline(always)]
fn lanes<S: Simd>(column: &Column, go: usize) -> S::f64s {
    S::as_simd_f64s(column).0[go]
}

/// In the order in which glam adds.
#[inline(always)]
fn dot<S: Simd>(simd: S, [ax, ay, az]: Vectors<S>, [bx, by, bz]: Vectors<S>) -> S::f64s {
    simd.add_f64s(simd.add_f64s(simd.mul_f64s(ax, bx), simd.mul_f64s(ay, by)), simd.mul_f64s(az, bz))
}

#[inline(always)]
fn minus<S: Simd>(simd: S, [ax, ay, az]: Vectors<S>, [bx, by, bz]: Vectors<S>) -> Vectors<S> {
    [simd.sub_f64s(ax, bx), simd.sub_f64s(ay, by), simd.sub_f64s(az, bz)]
}

/// Whether 0 <= x <= end.
#[inline(always)]
fn within<S: Simd>(simd: S, x: S::f64s, end: S::f64s) -> S::m64s {
    let is_positive = simd.greater_than_or_equal_f64s(x, simd.splat_f64s(0.0));
    simd.and_m64s(is_positive, simd.less_than_or_equal_f64s(x, end))
}

/// A ray in every lane.
#[derive(Clone, Copy)]
struct Rays<S: Simd> {
    simd: S,
    origin: Vectors<S>,
    dir: Vectors<S>,
}

impl<S: Simd> Rays<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray) -> Self {
        Rays { simd, origin: splat(simd, ray.origin), dir: splat(simd, ray.dir) }
    }

    /// Distances \[L\], and which lanes are met there, ahead and nearer than `bound`. What [`Rectangle::hit`] does, number
    /// by number.
    #[inline(always)]
    fn meet(&self, block: &Block, go: usize, bound: S::f64s) -> (S::f64s, S::m64s) {
        let Rays { simd, origin, dir } = *self;
        let (corner, normal) = (load::<S>(&block.corner, go), load::<S>(&block.normal, go));
        let height = dot(simd, minus(simd, corner, origin), normal);
        let t = simd.div_f64s(height, dot(simd, dir, normal));
        let at = [
            simd.add_f64s(origin[0], simd.mul_f64s(dir[0], t)),
            simd.add_f64s(origin[1], simd.mul_f64s(dir[1], t)),
            simd.add_f64s(origin[2], simd.mul_f64s(dir[2], t)),
        ];
        let p = minus(simd, at, corner);
        let a = dot(simd, p, load::<S>(&block.u, go));
        let b = dot(simd, p, load::<S>(&block.v, go));
        let inside = simd.and_m64s(
            within(simd, a, lanes::<S>(&block.u_squared, go)),
            within(simd, b, lanes::<S>(&block.v_squared, go)),
        );
        let is_ahead = simd.greater_than_f64s(t, simd.splat_f64s(0.0));
        (t, simd.and_m64s(inside, simd.and_m64s(is_ahead, simd.less_than_f64s(t, bound))))
    }
}

/// A list of rectangles that answers what each of them would, bit for bit.
///
/// Those that lie in one plane and overlap are in one *place*: a ray that starts on one of them meets none of the others
/// there, and of those that it meets at a point the first one counts, whatever rounding says.
///
/// Nothing branches on what single rectangles answer: which of them a ray meets is as good as random, and a branch
/// foretold wrongly costs as much as a register full of rectangles.
#[derive(Debug, Clone, Default)]
pub struct Rectangles {
    members: Vec<Rectangle>,
    /// For each the first one of its place, and whether there are others.
    places: Vec<(usize, bool)>,
    blocks: Vec<Block>,
    arch: Arch,
}

impl PartialEq for Rectangles {
    fn eq(&self, other: &Self) -> bool {
        self.members == other.members && self.places == other.places
    }
}

/// An index in the list as a number; -1, which none has, for none.
fn number(index: Option<usize>) -> f64 {
    index.map_or(-1.0, |index| index as f64)
}

struct Nearest<'a> {
    list: &'a Rectangles,
    ray: &'a Ray,
    except: f64,
}

impl WithSimd for Nearest<'_> {
    type Output = (f64, f64);

    /// The distance of the nearest, infinite if there is none, and its number.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (f64, f64) {
        let rays = Rays::new(simd, self.ray);
        let except = simd.splat_f64s(self.except);
        let infinite = simd.splat_f64s(f64::INFINITY);
        let (mut nearest, mut number) = (infinite, infinite);
        let goes = WIDTH / S::F64_LANES;
        for i in 0..self.list.members.len().div_ceil(S::F64_LANES) {
            let (block, go) = (&self.list.blocks[i / goes], i % goes);
            let (t, met) = rays.meet(block, go, nearest);
            let numbers = lanes::<S>(&block.number, go);
            let places = lanes::<S>(&block.place, go);
            let is_nearer = simd.and_m64s(met, simd.not_m64s(simd.equal_f64s(places, except)));
            nearest = simd.select_f64s(is_nearer, t, nearest);
            number = simd.select_f64s(is_nearer, numbers, number);
        }
        let t = simd.reduce_min_f64s(nearest);
        let is_at = simd.equal_f64s(nearest, simd.splat_f64s(t));
        (t, simd.reduce_min_f64s(simd.select_f64s(is_at, number, infinite)))
    }
}

struct Blocks<'a> {
    list: &'a Rectangles,
    ray: &'a Ray,
    except: [f64; 2],
    end: f64,
}

impl WithSimd for Blocks<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let rays = Rays::new(simd, self.ray);
        let (one, other) = (simd.splat_f64s(self.except[0]), simd.splat_f64s(self.except[1]));
        let end = simd.splat_f64s(self.end);
        let goes = WIDTH / S::F64_LANES;
        for i in 0..self.list.members.len().div_ceil(S::F64_LANES) {
            let (block, go) = (&self.list.blocks[i / goes], i % goes);
            let (_, met) = rays.meet(block, go, end);
            let places = lanes::<S>(&block.place, go);
            let is_excepted = simd.or_m64s(simd.equal_f64s(places, one), simd.equal_f64s(places, other));
            if simd.first_true_m64s(simd.and_m64s(met, simd.not_m64s(is_excepted))) < S::F64_LANES {
                return true;
            }
        }
        false
    }
}

impl Rectangles {
    /// The list of these.
    pub fn new(members: Vec<Rectangle>) -> Self {
        let mut firsts: Vec<usize> = (0..members.len()).collect();
        for (i, rectangle) in members.iter().enumerate() {
            for j in 0..i {
                if firsts[j] != firsts[i] && rectangle.overlaps(&members[j]) {
                    let (low, high) = (firsts[i].min(firsts[j]), firsts[i].max(firsts[j]));
                    firsts[..=i].iter_mut().filter(|first| **first == high).for_each(|first| *first = low);
                }
            }
        }
        let chunks = members.chunks(WIDTH).zip(firsts.chunks(WIDTH)).enumerate();
        let blocks = chunks.map(|(i, (chunk, places))| Block::new(WIDTH * i, chunk, places)).collect();
        let is_shared = |first: &usize| firsts.iter().filter(|other| *other == first).count() > 1;
        let places = firsts.iter().map(|first| (*first, is_shared(first))).collect();
        Rectangles { members, places, blocks, arch: Arch::new() }
    }

    /// The number of a rectangle's place.
    fn place(&self, index: Option<usize>) -> f64 {
        number(index.map(|index| self.places[index].0))
    }

    /// The nearest one ahead that is not in one place with `except`: its index and where the ray meets it; the first in
    /// the list of those at the same distance.
    pub fn nearest(&self, ray: &Ray, except: Option<usize>) -> Option<(usize, Hit)> {
        let (t, index) = self.arch.dispatch(Nearest { list: self, ray, except: self.place(except) });
        if t == f64::INFINITY {
            return None;
        }
        let mut index = index as usize;
        if let (first, true) = self.places[index] {
            let p = ray.at(t);
            let mut here = (first..index).filter(|i| self.places[*i].0 == first);
            index = here.find(|i| self.members[*i].covers(p)).unwrap_or(index);
        }
        Some((index, self.members[index].hit_at(ray, t)))
    }

    /// Whether the ray meets one of them nearer than `end` \[L\], apart from those in one place with these two.
    pub fn block(&self, ray: &Ray, except: [Option<usize>; 2], end: f64) -> bool {
        self.arch.dispatch(Blocks { list: self, ray, except: except.map(|index| self.place(index)), end })
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
        assert!(list.places.iter().all(|(_, is_shared)| !is_shared));
        assert_eq!(Rectangles::default().nearest(&Ray::new(DVec3::ZERO, DVec3::X), None), None);
    }

    /// A picture on a tilted wall, whose planes differ by rounding: it is met, the wall beside it, and no ray that starts on
    /// either meets the other.
    #[test]
    fn the_first_of_those_in_one_place_counts() {
        let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
        let frame = Frame::new(warp::square_to_sphere(stream.pair()));
        let at = |a: f64, b: f64| DVec3::splat(0.1) + frame.x * a + frame.y * b;
        let rectangle =
            |low: f64, side: f64| Rectangle::new(at(low, low), frame.x * side, frame.y * side).unwrap();
        let elsewhere = Rectangle::new(at(0.0, 0.0) - frame.z, frame.x, frame.y).unwrap();
        let list = Rectangles::new(vec![rectangle(0.37, 0.2), elsewhere, rectangle(-1.0, 3.0)]);
        assert_eq!(list.places, [(0, true), (1, false), (0, true)]);
        for _ in 0..10_000 {
            let [a, b] = stream.pair();
            let eye = at(0.3, 0.4) + frame.z * (0.5 + stream.unit());
            let ray = Ray::new(eye, (at(a, b) - eye).normalize());
            let (index, hit) = list.nearest(&ray, None).unwrap();
            let is_on_picture = (0.37..=0.57).contains(&a) && (0.37..=0.57).contains(&b);
            assert_eq!(index, if is_on_picture { 0 } else { 2 }, "{a} {b}");
            let away = Ray::new(ray.at(hit.t), warp::square_to_sphere(stream.pair()).normalize());
            let met = list.nearest(&away, Some(index));
            assert!(met.is_none_or(|(other, _)| other == 1), "{met:?}");
            // Towards the picture nothing of its place stands before it.
            assert!(!list.block(&ray, [None, Some(0)], hit.t * (1.0 + 1e-15)));
        }
    }
}
