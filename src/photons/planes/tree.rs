//! The tree over planes: pieces of them in kd order, boxes sixteen wide above them.

use super::{Plane, PlaneCrossing};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use crate::photons::beams::{Entry, kd_order};
use crate::photons::tree::{Boxes, Cylinder, Extent, Units, levels_of};
use glam::DVec3;

/// Parts of a side, at most: eight pieces a plane on average, then, whatever the sides are.
const MOST_PARTS: f64 = 4.0;

/// A part of a plane, along each side `part` of `of` equal ones.
#[derive(Debug, Clone, Copy)]
struct Piece {
    plane: u32,
    part: [u16; 2],
    of: [u16; 2],
}

impl Piece {
    /// From where to where along a side \[L\]: the end of one is the start of the next, bit by bit.
    fn span(self, side: usize, length: f64) -> (f64, f64) {
        let of = self.of[side];
        let cut = |part: u16| if part == of { length } else { length * (f64::from(part) / f64::from(of)) };
        (cut(self.part[side]), cut(self.part[side] + 1))
    }

    fn corners(self, plane: &Plane) -> [DVec3; 4] {
        let sides = plane.sides();
        let ([a, b], [c, d]) = (<[f64; 2]>::from(self.span(0, sides[0])), self.span(1, sides[1]).into());
        [[a, c], [b, c], [a, d], [b, d]].map(|legs| plane.at(legs))
    }
}

/// Planes, cut into pieces so that the boxes about them are tighter.
///
/// Boxes are held in single precision and are wide enough that nothing is missed; what they let in is decided in double precision.
/// A search meets the same planes in the same order on any number of threads.
#[derive(Debug)]
pub struct PlaneTree {
    units: Units,
    bounds: Option<[DVec3; 2]>,
    planes: Vec<Plane>,
    /// In kd order, sixteen a box of the lowest level.
    pieces: Vec<Piece>,
    levels: Vec<Vec<Boxes>>,
}

impl PlaneTree {
    /// The tree over planes in parts, as a pass stores them, built by the threads of the current pool.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if a start, direction, side or power is not finite; [`Error::OutOfRange`] beyond 2^28 planes.
    pub fn new(parts: Vec<Vec<Plane>>) -> Result<Self> {
        let count = parts.iter().map(Vec::len).sum();
        // Pieces are eight times as many at most, and numbered in 32 bits.
        if count > 1 << 28 {
            return Err(Error::out_of_range("the number of planes in one map", count as f64, "up to 2^28"));
        }
        let mut planes = Vec::with_capacity(count);
        parts.into_iter().for_each(|part| planes.extend(part));
        let is_finite = |plane: &Plane| {
            plane.at(plane.sides()).is_finite()
                && plane.leg.start.is_finite()
                && plane.leg.dir.is_finite()
                && plane.dir.is_finite()
                && plane.leg.power.is_finite()
        };
        let non_finite = planes.iter().filter(|plane| !is_finite(plane)).count() as u64;
        if non_finite > 0 {
            return Err(Error::NonFinite { count: non_finite, place: "stored planes" });
        }
        let pieces = cut(&planes);
        let corners = |piece: &Piece| piece.corners(&planes[piece.plane as usize]);
        let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in pieces.iter().flat_map(corners) {
            (lower, upper) = (lower.min(corner), upper.max(corner));
        }
        let bounds = (!planes.is_empty()).then_some([lower, upper]);
        let [lower, upper] = bounds.unwrap_or([DVec3::ZERO; 2]);
        let units = Units::new(lower, upper);
        let mut entries: Vec<Entry> = pieces
            .iter()
            .enumerate()
            .map(|(index, piece)| {
                let [a, _, _, d] = corners(piece).map(|corner| units.relative(corner));
                Entry { middle: (0.5 * (a + d)).as_vec3().to_array(), index: index as u32 }
            })
            .collect();
        kd_order(&mut entries);
        let pieces: Vec<Piece> = entries.into_iter().map(|entry| pieces[entry.index as usize]).collect();
        let extents = pieces.iter().map(|piece| {
            let corners = corners(piece).map(|corner| units.relative(corner).as_vec3());
            let of = |merge: fn(glam::Vec3, glam::Vec3) -> glam::Vec3| {
                corners.into_iter().reduce(merge).unwrap_or_default().to_array()
            };
            Extent { lower: of(glam::Vec3::min), upper: of(glam::Vec3::max) }
        });
        let levels = levels_of(extents.collect());
        Ok(PlaneTree { units, bounds, planes, pieces, levels })
    }

    /// Visits every plane that a ray meets in `span` and within its sides, starts included and ends not; a plane that the ray lies in is
    /// not met.
    pub fn met(&self, ray: &Ray, span: Interval, mut visit: impl FnMut(&Plane, &PlaneCrossing)) {
        let mut ask = |piece: &Piece| {
            let plane = &self.planes[piece.plane as usize];
            let Some(crossing) = PlaneCrossing::new(ray, plane) else { return };
            let sides = plane.sides();
            let is_within = |side: usize| {
                let ((from, to), t) = (piece.span(side, sides[side]), crossing.along_legs[side]);
                from <= t && t < to
            };
            let s = crossing.along_ray;
            if is_within(0) && is_within(1) && span.start <= s && s < span.end {
                visit(plane, &crossing);
            }
        };
        let Some(line) = Cylinder::new(&self.units, ray, span, 0.0) else {
            self.pieces.iter().for_each(ask);
            return;
        };
        line.each_touched(&self.levels, |place| ask(&self.pieces[place]));
    }

    /// Number of planes.
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether there are no planes.
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// Every plane, in the order in which they came.
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Memory that it occupies \[bytes\].
    pub fn bytes(&self) -> usize {
        size_of_val(&self.planes[..])
            + size_of_val(&self.pieces[..])
            + self.levels.iter().map(|level| size_of_val(&level[..])).sum::<usize>()
    }

    /// The corners of the box about all of them; none if there are none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }
}

/// Pieces of about the mean sides.
fn cut(planes: &[Plane]) -> Vec<Piece> {
    let mean =
        |side: usize| planes.iter().map(|plane| plane.sides()[side]).sum::<f64>() / planes.len() as f64;
    let means = [mean(0), mean(1)];
    let of = |plane: &Plane| {
        [0, 1].map(|side| {
            let wanted = if means[side] > 0.0 { (plane.sides()[side] / means[side]).ceil() } else { 1.0 };
            wanted.clamp(1.0, MOST_PARTS) as u16
        })
    };
    let mut pieces = Vec::with_capacity(planes.len());
    for (index, plane) in (0u32..).zip(planes) {
        let of = of(plane);
        pieces.extend(
            (0..of[0]).flat_map(|i| (0..of[1]).map(move |j| Piece { plane: index, part: [i, j], of })),
        );
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::photons::Flags;
    use crate::photons::beams::{Beam, BeamKind};
    use crate::rng::{Purpose, Stream};
    use glam::{DMat3, Vec3};

    fn plane(start: DVec3, [first, second]: [DVec3; 2], [length, reach]: [f64; 2]) -> Plane {
        let (power, kind, flags) = (Vec3::ONE, BeamKind::Sampled, Flags::NONE);
        let leg = Beam { start, dir: first, length, power, medium: 0, order: 0, flags, kind };
        Plane { leg, dir: second, depth: 1.0, reach }
    }

    /// Random planes, in large and small maps and far off, some thin, some within a ten-millionth of the ray's own direction, some
    /// without extent and some very long: met is what all planes, asked one by one by a matrix's inverse, say, each once.
    #[test]
    fn planes_met_are_those_found_one_by_one() {
        let mut stream = Stream::new(6, Purpose::Synthetic, 0, 0);
        let (mut found, mut thin) = (0, 0);
        for trial in 0..120 {
            let size = libm::exp10(8.0 * stream.unit() - 4.0);
            let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
            let count = [0, 1, 5, 16, 17, 300, 2000][trial % 7];
            let position = |stream: &mut Stream| {
                far + (DVec3::from(stream.triple()) - 0.5) * DVec3::new(size, 0.3 * size, 0.5 * size)
            };
            let axis = warp::square_to_sphere(stream.pair());
            let planes: Vec<Plane> = (0..count)
                .map(|which| {
                    let [first, about] = [0; 2].map(|_| warp::square_to_sphere(stream.pair()));
                    let second = match which % 8 {
                        0 => axis,
                        1 => first,
                        2 | 4 => (first + about * 0.02).normalize(),
                        3 => (about * 1e-7 - axis).normalize(),
                        _ => about,
                    };
                    let side = |stream: &mut Stream| match which % 5 {
                        0 => 0.0,
                        1 | 2 => 30.0 * size * stream.unit(),
                        _ => size * stream.unit(),
                    };
                    let sides = [side(&mut stream) + 0.1 * size, side(&mut stream)];
                    plane(position(&mut stream), [first, second], sides)
                })
                .collect();
            // In two parts, the first of them empty now and then.
            let cut = planes.len() / 3;
            let tree = PlaneTree::new(vec![planes[..cut].to_vec(), planes[cut..].to_vec()]).unwrap();
            assert_eq!((tree.len(), tree.planes()), (count, &planes[..]));
            for which in 0..8 {
                let dir = if which < 3 { axis } else { warp::square_to_sphere(stream.pair()) };
                let away = [0.2, 2.0, 100.0][which % 3] * size;
                let ray = Ray::new(position(&mut stream) - dir * away, dir);
                let end = if which == 5 { f64::INFINITY } else { 2.0 * away * stream.unit() };
                let span = Interval { start: end.min(away) * 0.3 * stream.unit(), end };
                let mut seen = Vec::new();
                let key = |plane: &Plane| plane.leg.start.to_array().map(f64::to_bits);
                tree.met(&ray, span, |plane, crossing| {
                    let off = (plane.at(crossing.along_legs) - ray.at(crossing.along_ray)).length();
                    let long = 1e-12 * (far.length() + 100.0 * size + plane.reach + plane.leg.length);
                    assert!(off < long / crossing.determinant, "{trial} {which}: {off}");
                    thin += u32::from(crossing.determinant < 0.03);
                    seen.push(key(plane));
                });
                seen.sort_unstable();
                let all = seen.len();
                seen.dedup();
                assert_eq!(all, seen.len(), "{trial} {which}: twice");
                // What rounding does not decide may be either.
                let sure = |plane: &Plane, by: f64| {
                    let matrix = DMat3::from_cols(plane.leg.dir, plane.dir, -dir);
                    if matrix.determinant().abs() < 1e-14 {
                        return by > 0.0;
                    }
                    let v = ray.origin - plane.leg.start;
                    let [t0, t1, s] = (matrix.inverse() * v).to_array();
                    let error = by
                        * (1e-13 * (v.length() + plane.reach + size) / matrix.determinant().powi(2).min(1.0));
                    let most = |x: f64, from: f64, to: f64| x >= from - error && x < to + error;
                    most(t0, 0.0, plane.leg.length)
                        && most(t1, 0.0, plane.reach)
                        && most(s, span.start, span.end)
                };
                for plane in &planes {
                    let is_found = seen.binary_search(&key(plane)).is_ok();
                    assert!(is_found || !sure(plane, -1.0), "{trial} {which}: {plane:?} is missed");
                    assert!(!is_found || sure(plane, 1.0), "{trial} {which}: {plane:?} is not met");
                }
                found += all;
            }
        }
        assert!(found > 5_000 && thin > 100, "{found} {thin}");
    }

    /// The same tree on one thread and on many.
    #[test]
    fn trees_do_not_depend_on_the_threads() {
        let mut stream = Stream::new(7, Purpose::Synthetic, 0, 0);
        let one = |_| {
            let dirs = [0; 2].map(|_| warp::square_to_sphere(stream.pair()));
            plane(DVec3::from(stream.triple()), dirs, stream.pair())
        };
        let planes: Vec<Plane> = (0..40_000).map(one).collect();
        let order = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let tree = pool.install(|| PlaneTree::new(vec![planes.clone()]).unwrap());
            tree.pieces.iter().map(|piece| (piece.plane, piece.part)).collect::<Vec<_>>()
        };
        let alone = order(1);
        assert!(alone.len() > planes.len());
        assert_eq!(alone, order(7));
    }

    /// A plane that is not finite is an error, and no panic.
    #[test]
    fn planes_are_finite() {
        let dirs = [DVec3::X, DVec3::Y];
        for wrong in [
            plane(DVec3::NAN, dirs, [1.0, 1.0]),
            plane(DVec3::ZERO, dirs, [1.0, f64::INFINITY]),
            plane(DVec3::ZERO, [DVec3::X, DVec3::NAN], [1.0, 1.0]),
        ] {
            assert!(PlaneTree::new(vec![vec![wrong]]).is_err());
        }
    }
}
