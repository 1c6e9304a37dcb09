//! What is beside a stretch of a ray, as rows of photons about it are asked: eight at a time, in single precision.

use super::beside::Beside;
use super::sheets::Sheets;
use super::visible::{ACROSS, DiscShare};
use crate::estimators::Kernel;
use crate::geometry::Rectangle;
use crate::math::{Interval, Ray};
use crate::photons::PhotonTree;
use crate::photons::tree::{Neighbors, bits};
use glam::DVec3;
use wide::f32x8;

/// A share is the mean over a stretch of this part of the radius, by which a uniform source is right however the share changes in it.
const STRETCH: f64 = 0.25;

/// Of shares that differ by less than this part at the ends of a stretch, or in the middle from what the ends say, no more are asked.
const EVEN: f64 = 0.03;

/// Of others so many, evenly spread.
const PLACES: usize = 4;

/// So many stretches are told of by the shares at their ends alone, where the parabola through the first, the middle and the last of these is
/// off by less than that part at the others.
const TOGETHER: usize = 4;

/// Stretches that a ray is parted in at least, where discs are larger than what they are in.
const LEAST: f64 = 32.0;

/// Where they would be more, there are not so many photons that each could not be asked by itself.
const MOST: f64 = 1024.0;

/// Feet of photons are no farther than this from the place of the ray nearest the middle of their map \[units\].
const FARTHEST: f64 = 2.0;

/// Where directions tell the share, a photon is divided by no less than this of its squared distance over the radius: what one direction
/// brings that sees as far as it.
const ONE_DIRECTION: f32 = 1.0 / ACROSS as f32;

/// What is beside a stretch of a ray. Feet are told from the ray's place nearest the middle of the photons' map, in the map's units.
pub(in crate::estimators) struct BesideRows<'a> {
    parts: Vec<Interval>,
    /// Where nothing is to be asked.
    clear: Vec<[f32; 2]>,
    origin: [f32; 3],
    dir: [f32; 3],
    bodies: Vec<FlatBody>,
    shares: Option<Shares<'a>>,
}

impl<'a> BesideRows<'a> {
    /// What is beside the stretch of a ray that `beside` knows, for photons within a radius \[L\].
    pub fn new(
        beside: &'a Beside<'a>,
        (tree, ray, span): (&PhotonTree, &Ray, Interval),
        (kernel, radius, is_clipped): (Kernel, f64, bool),
        salt: u64,
    ) -> Self {
        let (unit, middle) = (tree.unit(), tree.middle_of(ray));
        let feet = |part: &Interval| [part.start, part.end].map(|t| ((t - middle) / unit) as f32);
        let clear = beside.clear_parts(span, radius, is_clipped);
        let reach = FARTHEST * unit;
        let all = span.intersection(Interval { start: middle - reach, end: middle + reach });
        let count = |all: Interval| if is_clipped { Shares::count(all, radius) } else { Some(0) };
        let walled = all.and_then(|all| Some((beside.flat_parts(all)?, count(all)?, all)));
        let place = tree.relative(ray.at(middle));
        let mut of = BesideRows {
            clear: clear.iter().map(feet).collect(),
            parts: clear,
            origin: place.as_vec3().to_array(),
            dir: ray.dir.as_vec3().to_array(),
            bodies: Vec::new(),
            shares: None,
        };
        if let Some((parts, count, all)) = walled {
            let occluder = |rectangle: Rectangle| Occluder::new(&rectangle, (tree, place, ray.dir));
            let flat = |(part, rectangles): (Interval, Vec<Rectangle>)| FlatBody {
                beside: feet(&part),
                sides: rectangles.into_iter().map(occluder).collect(),
            };
            of.bodies = beside.flat_bodies().map(flat).collect();
            of.parts = parts;
            of.shares =
                is_clipped.then(|| Shares::new(beside, (unit, middle, all), (kernel, radius, salt), count));
        }
        of
    }

    /// The parts of the stretch that are told of by rows, in order and apart.
    pub fn parts(&self) -> &[Interval] {
        &self.parts
    }

    /// Which photons of a row count, and the share of the disc across the ray, about its foot, that each is divided by; nothing of those that do not.
    #[inline(always)]
    pub fn kept(&mut self, row: &Neighbors<'_>, feet: f32x8) -> (f32x8, f32x8) {
        let inside = row.inside();
        let is_in =
            |[start, end]: &[f32; 2]| feet.simd_ge(f32x8::splat(*start)) & feet.simd_lt(f32x8::splat(*end));
        let clear = self.clear.iter().map(is_in).fold(f32x8::ZERO, |all, part| all | part);
        if !(inside & !clear).any() {
            return (inside, f32x8::ONE);
        }
        let hidden = self.hidden(row, feet);
        let kept = inside & !hidden;
        let shares = match &mut self.shares {
            Some(shares) => {
                let shares = shares.at(kept, feet);
                let is_sampled = shares.simd_lt(f32x8::ZERO);
                shares.abs().fast_max(is_sampled & (row.u2() * f32x8::splat(ONE_DIRECTION)))
            }
            None => f32x8::ONE,
        };
        (kept, shares)
    }

    /// Which photons of a row are hidden from their feet.
    #[inline(always)]
    fn hidden(&self, row: &Neighbors<'_>, feet: f32x8) -> f32x8 {
        let positions = row.positions();
        let hidden = |FlatBody { beside: [start, end], sides }: &FlatBody| {
            let near = row.inside() & feet.simd_ge(f32x8::splat(*start)) & feet.simd_le(f32x8::splat(*end));
            if !near.any() {
                return f32x8::ZERO;
            }
            let away: [f32x8; 3] = std::array::from_fn(|i| {
                positions[i] - f32x8::splat(self.origin[i]) - feet * f32x8::splat(self.dir[i])
            });
            let is_between = |all, side: &Occluder| all | side.is_between(feet, &away);
            near & sides.iter().fold(f32x8::ZERO, is_between)
        };
        self.bodies.iter().map(hidden).fold(f32x8::ZERO, |all, one| all | one)
    }
}

/// A body of rectangles beside the ray.
struct FlatBody {
    /// Feet whose photons it may hide.
    beside: [f32; 2],
    sides: Vec<Occluder>,
}

/// An axis, and how much farther along it each unit along the ray is.
#[derive(Clone, Copy)]
struct Axis {
    axis: [f32; 3],
    slope: f32,
}

impl Axis {
    fn new(axis: DVec3, dir: DVec3) -> Self {
        Axis { axis: axis.as_vec3().to_array(), slope: dir.dot(axis) as f32 }
    }

    #[inline(always)]
    fn of_feet(&self, feet: f32x8) -> f32x8 {
        feet * f32x8::splat(self.slope)
    }

    #[inline(always)]
    fn of(&self, away: &[f32x8; 3]) -> f32x8 {
        let [x, y, z] = [0, 1, 2].map(|i| away[i] * f32x8::splat(self.axis[i]));
        x + y + z
    }
}

/// A rectangle beside the ray.
struct Occluder {
    normal: Axis,
    /// How far before it the foot 0 is.
    height: f32,
    /// Its edges, with where they begin and end, counted from the foot 0: of a large one what is far off is inexact, and does not matter.
    edges: [(Axis, [f32; 2]); 2],
}

impl Occluder {
    fn new(rectangle: &Rectangle, (tree, place, dir): (&PhotonTree, DVec3, DVec3)) -> Self {
        let corner = tree.relative(rectangle.corner()) - place;
        let edge = |edge: DVec3| {
            let length = edge.length();
            let start = corner.dot(edge / length);
            (Axis::new(edge / length, dir), [start, start + length / tree.unit()].map(|end| end as f32))
        };
        Occluder {
            normal: Axis::new(rectangle.normal(), dir),
            height: -corner.dot(rectangle.normal()) as f32,
            edges: [edge(rectangle.u()), edge(rectangle.v())],
        }
    }

    /// Whether it stands between feet and what is `away` from them; in its plane nothing is behind it.
    #[inline(always)]
    fn is_between(&self, feet: f32x8, away: &[f32x8; 3]) -> f32x8 {
        let (start, rise) = (f32x8::splat(self.height) + self.normal.of_feet(feet), self.normal.of(away));
        let crosses = (start * (start + rise)).simd_lt(f32x8::ZERO);
        if !crosses.any() {
            return f32x8::ZERO;
        }
        let part = -start / rise;
        let covers = |(edge, [start, end]): &(Axis, [f32; 2])| {
            let at = edge.of_feet(feet) + part * edge.of(away);
            at.simd_ge(f32x8::splat(*start)) & at.simd_le(f32x8::splat(*end))
        };
        crosses & covers(&self.edges[0]) & covers(&self.edges[1])
    }
}

/// What is left of discs across the ray, each stretch asked once, when the first photon needs it.
struct Shares<'a> {
    beside: &'a Beside<'a>,
    sheets: Option<Sheets>,
    kernel: Kernel,
    radius: f64,
    salt: u64,
    /// Where the stretches begin along the ray, and how long each is \[L\].
    start: f64,
    length: f64,
    /// The same as feet are told, the length inverse.
    first: f32,
    per_foot: f32,
    /// The last stretch.
    last: f32,
    /// Shares of the stretches, negative where directions tell them, and at their ends; 0 and none where none was asked.
    known: Vec<f32>,
    at_ends: Vec<Option<DiscShare>>,
}

impl<'a> Shares<'a> {
    /// The number of stretches; none where it would be too large.
    fn count(span: Interval, radius: f64) -> Option<usize> {
        let count = (span.length() / (STRETCH * radius)).ceil().max(LEAST);
        (count <= MOST).then_some(count as usize)
    }

    fn new(
        beside: &'a Beside<'a>,
        (unit, middle, span): (f64, f64, Interval),
        (kernel, radius, salt): (Kernel, f64, u64),
        count: usize,
    ) -> Self {
        let length = span.length() / count as f64;
        let (first, per_foot) = (((span.start - middle) / unit) as f32, (unit / length) as f32);
        let sheets = beside.sheets();
        Shares {
            beside,
            sheets,
            kernel,
            radius,
            salt,
            start: span.start,
            length,
            first,
            per_foot,
            last: (count - 1) as f32,
            known: vec![0.0; count],
            at_ends: vec![None; count + 1],
        }
    }

    #[inline(always)]
    fn at(&mut self, asked: f32x8, feet: f32x8) -> f32x8 {
        let stretches = (feet - f32x8::splat(self.first)) * f32x8::splat(self.per_foot);
        // Rounding may put a foot before the first; lanes that are not asked may be anywhere.
        let stretches = (asked & stretches).fast_max(f32x8::ZERO).fast_min(f32x8::splat(self.last));
        let stretches = stretches.fast_trunc_int().to_array();
        let shares = self.known_of(&stretches);
        if !(asked & shares.simd_eq(f32x8::ZERO)).any() {
            return shares;
        }
        bits(asked.to_bitmask()).for_each(|lane| self.ask(stretches[lane] as usize));
        self.known_of(&stretches)
    }

    #[inline(always)]
    fn known_of(&self, stretches: &[i32; 8]) -> f32x8 {
        let mut shares = [0.0; 8];
        for (share, stretch) in shares.iter_mut().zip(stretches) {
            *share = self.known[*stretch as usize];
        }
        f32x8::new(shares)
    }

    #[cold]
    fn ask(&mut self, stretch: usize) {
        if self.known[stretch] != 0.0 {
            return;
        }
        if self.ask_together(stretch / TOGETHER * TOGETHER) {
            return;
        }
        let DiscShare { part, is_sampled } = self.mean_of(stretch);
        let part = part.max(DiscShare::LEAST) as f32;
        self.known[stretch] = if is_sampled { -part } else { part };
    }

    /// The mean shares over [`TOGETHER`] stretches from this one on, by a parabola over either half; false where shares are not even enough.
    fn ask_together(&mut self, first: usize) -> bool {
        if self.sheets.is_none() || first + TOGETHER > self.known.len() {
            return false;
        }
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|n| self.at_end(first + n).part);
        let off = |told: f64, near: f64, far: f64| (0.375 * near + 0.75 * c - 0.125 * far - told).abs();
        let is_even = off(b, a, e).max(off(d, e, a)) <= EVEN * a.max(c).max(e);
        if is_even {
            for (known, part) in self.known[first..].iter_mut().zip(means_between([a, b, c, d, e])) {
                *known = part.max(DiscShare::LEAST) as f32;
            }
        }
        is_even
    }

    /// The share at the end of so many stretches.
    fn at_end(&mut self, end: usize) -> DiscShare {
        self.at_ends[end].unwrap_or_else(|| {
            let share = self.share_at(end as f64);
            self.at_ends[end] = Some(share);
            share
        })
    }

    /// The mean share over a stretch.
    fn mean_of(&mut self, stretch: usize) -> DiscShare {
        let [start, end] = [stretch, stretch + 1].map(|end| self.at_end(end));
        let told = |shares: &[DiscShare], weights: &[f64]| {
            let part = shares.iter().zip(weights).map(|(share, weight)| share.part * weight).sum::<f64>();
            let is_sampled = shares.iter().any(|share| share.is_sampled);
            DiscShare { part: part / weights.iter().sum::<f64>(), is_sampled }
        };
        let even = EVEN * start.part.max(end.part);
        if (end.part - start.part).abs() <= even {
            return told(&[start, end], &[1.0, 1.0]);
        }
        let middle = self.share_at(stretch as f64 + 0.5);
        if (start.part - 2.0 * middle.part + end.part).abs() <= even {
            return told(&[start, middle, end], &[1.0, 4.0, 1.0]);
        }
        let place = |n: usize| stretch as f64 + (n as f64 + 0.5) / PLACES as f64;
        let shares: [DiscShare; PLACES] = std::array::from_fn(|n| self.share_at(place(n)));
        told(&shares, &[1.0; PLACES])
    }

    /// The share at a place, counted in stretches.
    fn share_at(&self, stretches: f64) -> DiscShare {
        let along = self.start + stretches * self.length;
        match &self.sheets {
            Some(sheets) => DiscShare::exact(sheets.share(self.kernel, along, self.radius)),
            None => {
                let place = (along, self.radius, 0.0);
                let share = self.beside.disc_share(self.kernel, place, (true, true), self.salt, |_| true);
                share.unwrap_or(DiscShare::WHOLE)
            }
        }
    }
}

/// The means between five equally far places of what is a parabola through the first three, and another one through the last three.
fn means_between([a, b, c, d, e]: [f64; 5]) -> [f64; TOGETHER] {
    let mean = |near: f64, middle: f64, far: f64| (5.0 * near + 8.0 * middle - far) / 12.0;
    [mean(a, b, c), mean(c, b, a), mean(c, d, e), mean(e, d, c)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimators::boundary::Boundary;
    use crate::geometry::{Cuboid, Rectangle, Shape, Sphere};
    use crate::math::warp;
    use crate::photons::{Flags, Photon};
    use crate::rng::{Purpose, Stream};
    use crate::stats::Moments;
    use glam::Vec3;

    #[test]
    fn means_between_places_are_those_of_parabolas() {
        let mut stream = Stream::new(14, Purpose::Synthetic, 0, 0);
        for _ in 0..100 {
            let [p, q, r] = stream.triple().map(|u| 2.0 * u - 1.0);
            let means = means_between([0.0, 1.0, 2.0, 3.0, 4.0].map(|x| p + q * x + r * x * x));
            for (x, mean) in [0.0, 1.0, 2.0, 3.0].into_iter().zip(means) {
                let expected = p + q * (x + 0.5) + r * (x * x + x + 1.0 / 3.0);
                assert!((mean - expected).abs() < 1e-13, "{mean} {expected}");
            }
        }
    }

    /// A uniform source along rays through a box and a ball, alone and with sheets in them, in all directions and nearly along normals, where
    /// shares change within a part of a stretch: each place counts by the part of its disc that is seen, over the share of its stretch. One
    /// in the mean, if not at each place.
    #[test]
    fn a_uniform_source_is_right_in_the_mean() {
        let mut stream = Stream::new(12, Purpose::Synthetic, 0, 0);
        let [low, high] = [DVec3::ZERO, DVec3::ONE];
        let photon = |position| Photon {
            position,
            dir: Vec3::Z,
            normal: Vec3::ZERO,
            power: Vec3::ONE,
            order: 0,
            flags: Flags::NONE,
        };
        let tree = PhotonTree::new(vec![photon(low), photon(high)]).unwrap();
        let media = [
            Shape::Cuboid(Cuboid::new(low, high).unwrap()),
            Shape::Sphere(Sphere::new(0.5 * high, 0.5).unwrap()),
        ];
        let sheet = |u: DVec3, v: DVec3| Shape::Rectangle(Rectangle::new(0.2 * high, u, v).unwrap());
        let walls = [sheet(0.6 * DVec3::X, 0.4 * DVec3::Y), sheet(0.6 * DVec3::X, 0.5 * DVec3::Z)];
        let mut ratios = [Moments::new(); 8];
        let mut parted = 0;
        for trial in 0..1600 {
            let medium = &media[trial % 2];
            let known = Boundary::of(medium).unwrap();
            let boundary = if trial % 4 < 2 { known } else { known.about(&walls) };
            let place = 0.5 * high + 0.5 * warp::square_to_sphere(stream.pair()) * stream.unit();
            let about = warp::square_to_sphere(stream.pair());
            let is_steep = trial % 8 >= 4;
            let dir = if is_steep { (DVec3::X + 0.1 * about).normalize() } else { about };
            let ray = Ray::new(place, dir);
            let span = medium.interval(&ray).unwrap();
            let (kernel, radius) = (Kernel::ALL[trial % 5], 0.05 + 0.4 * stream.unit());
            let beside = Beside::new(&boundary, &ray, span, radius);
            let way = (&tree, &ray, span);
            let mut rows = BesideRows::new(&beside, way, (kernel, radius, true), trial as u64);
            assert_eq!(rows.parts(), [span]);
            let shares = rows.shares.as_mut().unwrap();
            let (middle, unit) = (tree.middle_of(&ray), tree.unit());
            let count = 16 * shares.known.len();
            let (mut sum, mut worst) = (0.0, 0.0f64);
            for n in 0..count {
                let along = span.start + span.length() * (n as f64 + 0.5) / count as f64;
                let foot = f32x8::splat(((along - middle) / unit) as f32);
                let told = shares.at(f32x8::splat(f32::from_bits(u32::MAX)), foot).to_array()[0];
                let told = f64::from(told.abs());
                let seen = beside.disc_share(kernel, (along, radius, 0.0), (true, true), n as u64, |_| true);
                let ratio = seen.unwrap().part / told;
                sum += ratio;
                worst = worst.max((ratio - 1.0).abs());
            }
            // The stretch is asked, not the place.
            parted += usize::from(worst > 1e-3);
            ratios[trial % 8].push(sum / count as f64);
        }
        assert!(parted > 1000, "{parted}");
        for ratios in &ratios {
            let off = ratios.mean() - 1.0;
            assert!(ratios.std_error() < 1.2e-4, "{}", ratios.std_error());
            assert!(off.abs() < 2e-4 + 3.0 * ratios.std_error(), "{off} {}", ratios.std_error());
        }
    }
}
