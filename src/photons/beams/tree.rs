//! The tree over beams: pieces of them in kd order, boxes sixteen wide above them.

use super::Beam;
use super::chord::Chord;
use super::crossing::Crossing;
use super::group::{GROUP, Group, Stretch};
use super::order::{Entry, kd_order};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use crate::photons::tree::{Boxes, Cylinder, Extent, Units, bits, levels_of};
use glam::DVec3;

/// Pieces are longer by this in single precision, in the tree's units, so that those that follow each other leave no gap.
const MARGIN: f32 = 1e-6;

/// Room about places for roundings of numbers up to 18 units.
const ROOM: f32 = 2e-5;

/// Pieces of a beam, at most.
const MOST_PIECES: f64 = 65_535.0;

/// A part of a beam, `part` of `of` equal ones.
#[derive(Debug, Clone, Copy)]
struct Piece {
    beam: u32,
    part: u16,
    of: u16,
}

impl Piece {
    /// From where to where on its beam \[L\]: the end of one is the start of the next, bit by bit.
    fn span(self, length: f64) -> (f64, f64) {
        let cut = |part: u16| {
            if part == self.of { length } else { length * (f64::from(part) / f64::from(self.of)) }
        };
        (cut(self.part), cut(self.part + 1))
    }
}

/// Beams, cut into pieces so that the boxes about them are tight.
///
/// Boxes are held in single precision and are wide enough that nothing is missed; what they let in is decided in double precision.
/// A search meets the same beams in the same order on any number of threads.
#[derive(Debug)]
pub struct BeamTree {
    units: Units,
    beams: Vec<Beam>,
    /// In kd order, sixteen a group, each of which has a box of the lowest level.
    pieces: Vec<Piece>,
    groups: Vec<Group>,
    levels: Vec<Vec<Boxes>>,
}

impl BeamTree {
    /// The tree over beams in parts, as a pass stores them, built by the threads of the current pool.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if a start, direction, length or power is not finite; [`Error::OutOfRange`] beyond 2^30 beams.
    pub fn new(parts: Vec<Vec<Beam>>) -> Result<Self> {
        let count = parts.iter().map(Vec::len).sum();
        // Pieces are three times as many at most, and numbered in 32 bits.
        if count > 1 << 30 {
            return Err(Error::out_of_range("the number of beams in one map", count as f64, "up to 2^30"));
        }
        let mut beams = Vec::with_capacity(count);
        parts.into_iter().for_each(|part| beams.extend(part));
        let is_finite = |beam: &Beam| {
            beam.start.is_finite()
                && beam.dir.is_finite()
                && beam.length.is_finite()
                && beam.power.is_finite()
        };
        let non_finite = beams.iter().filter(|beam| !is_finite(beam)).count() as u64;
        if non_finite > 0 {
            return Err(Error::NonFinite { count: non_finite, place: "stored beams" });
        }
        let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for beam in &beams {
            let end = beam.at(beam.length);
            lower = lower.min(beam.start.min(end));
            upper = upper.max(beam.start.max(end));
        }
        let units =
            if beams.is_empty() { Units::new(DVec3::ZERO, DVec3::ZERO) } else { Units::new(lower, upper) };
        let pieces = cut(&beams);
        let mut entries: Vec<Entry> = pieces
            .iter()
            .enumerate()
            .map(|(index, piece)| {
                let beam = &beams[piece.beam as usize];
                let (from, to) = piece.span(beam.length);
                let middle = units.relative(beam.at(0.5 * (from + to))).as_vec3().to_array();
                Entry { middle, index: index as u32 }
            })
            .collect();
        kd_order(&mut entries);
        let mut pieces: Vec<Piece> = entries.into_iter().map(|entry| pieces[entry.index as usize]).collect();
        let beams = in_order_of(&mut pieces, beams);
        let stretches = |pieces: &[Piece]| {
            let stretch = |piece: &Piece| {
                let beam = &beams[piece.beam as usize];
                let (from, to) = piece.span(beam.length);
                let middle = units.relative(beam.at(0.5 * (from + to))).as_vec3();
                Stretch {
                    middle,
                    dir: beam.dir.as_vec3(),
                    half: units.shrink(0.5 * (to - from)) as f32 + MARGIN,
                }
            };
            Group::new(&pieces.iter().map(stretch).collect::<Vec<_>>())
        };
        let groups = pieces.chunks(GROUP).map(stretches).collect();
        let extent = |piece: &Piece| {
            let beam = &beams[piece.beam as usize];
            let (from, to) = piece.span(beam.length);
            let [a, b] = [from, to].map(|t| units.relative(beam.at(t)).as_vec3());
            Extent { lower: a.min(b).to_array(), upper: a.max(b).to_array() }
        };
        let extents = pieces.chunks(GROUP).filter_map(|group| group.iter().map(extent).reduce(Extent::union));
        let levels = levels_of(extents.collect());
        Ok(BeamTree { units, beams, pieces, groups, levels })
    }

    /// Visits every beam whose line comes nearest to a ray within `radius` \[L\] of it, both nearest points on the beam and in `span`,
    /// their starts included and their ends not; a beam that is exactly parallel to the ray has no such point.
    pub fn near(&self, ray: &Ray, span: Interval, radius: f64, mut visit: impl FnMut(&Beam, &Crossing)) {
        let mut ask = |piece: &Piece| {
            let beam = &self.beams[piece.beam as usize];
            let Some(crossing) = Crossing::new(ray, (beam.start, beam.dir)) else { return };
            let (from, to) = piece.span(beam.length);
            let (s, t) = (crossing.along_ray, crossing.along_beam);
            if from <= t && t < to && span.start <= s && s < span.end && crossing.offset.abs() <= radius {
                visit(beam, &crossing);
            }
        };
        self.each_piece((ray, span, radius), &mut ask, |group, cylinder| group.near(cylinder));
    }

    /// How many pieces of beams [`BeamTree::near`] asks, sixteen at a time: what it costs.
    pub fn asked_near(&self, ray: &Ray, span: Interval, radius: f64) -> usize {
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radius) else { return self.pieces.len() };
        let mut asked = 0;
        cylinder.each_touched(&self.levels, |group| asked += GROUP.min(self.pieces.len() - group * GROUP));
        asked
    }

    /// Visits every beam whose point nearest to a place lies on it, its start included and its end not, and within `radius` \[L\] of the
    /// place, with the distance along the beam \[L\] and the square of that between both \[L^2\].
    pub fn about(&self, place: DVec3, radius: f64, mut visit: impl FnMut(&Beam, f64, f64)) {
        let mut ask = |piece: &Piece| {
            let beam = &self.beams[piece.beam as usize];
            let way = place - beam.start;
            let along = way.dot(beam.dir);
            let (from, to) = piece.span(beam.length);
            let squared = (way - beam.dir * along).length_squared();
            if from <= along && along < to && squared <= radius * radius {
                visit(beam, along, squared);
            }
        };
        self.each_piece_about(place, radius, &mut ask);
    }

    /// Visits the parts of every beam that are at most `radius` \[L\] from a ray, with their feet in `span`: a beam that is cut into
    /// pieces is told of in several parts, which together are all of it that is so near, each once.
    pub fn chords_near(&self, ray: &Ray, span: Interval, radius: f64, mut visit: impl FnMut(&Beam, &Chord)) {
        let mut ask = |piece: &Piece| {
            let beam = &self.beams[piece.beam as usize];
            let chord = Chord::near_ray(ray, span, radius, (beam.start, beam.dir));
            if let Some(part) = chord.and_then(|chord| chord.on(piece.span(beam.length), beam.length)) {
                visit(beam, &part);
            }
        };
        self.each_piece((ray, span, radius), &mut ask, |group, cylinder| group.touched(cylinder));
    }

    /// The same about a place.
    pub fn chords_about(&self, place: DVec3, radius: f64, mut visit: impl FnMut(&Beam, &Chord)) {
        let mut ask = |piece: &Piece| {
            let beam = &self.beams[piece.beam as usize];
            let chord = Chord::near_place(place, radius, (beam.start, beam.dir));
            if let Some(part) = chord.and_then(|chord| chord.on(piece.span(beam.length), beam.length)) {
                visit(beam, &part);
            }
        };
        self.each_piece_about(place, radius, &mut ask);
    }

    /// Asks every piece that may come within `radius` of a place.
    fn each_piece_about(&self, place: DVec3, radius: f64, ask: &mut impl FnMut(&Piece)) {
        // The ball about the place lies in it.
        let span = Interval { start: -radius, end: radius };
        let at = self.units.relative(place).as_vec3();
        let room = self.units.shrink(radius) as f32 + ROOM;
        self.each_piece((&Ray::new(place, DVec3::Z), span, radius), ask, |group, _| group.about(at, room));
    }

    /// Asks every piece that `near` finds in groups whose boxes come within `radius` of a stretch of a ray.
    fn each_piece(
        &self,
        (ray, span, radius): (&Ray, Interval, f64),
        ask: &mut impl FnMut(&Piece),
        near: impl Fn(&Group, &Cylinder) -> u32,
    ) {
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radius) else {
            self.pieces.iter().for_each(ask);
            return;
        };
        cylinder.each_touched(&self.levels, |group| {
            bits(near(&self.groups[group], &cylinder))
                .for_each(|lane| ask(&self.pieces[group * GROUP + lane]));
        });
    }

    /// Number of beams.
    pub fn len(&self) -> usize {
        self.beams.len()
    }

    /// Whether there are no beams.
    pub fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// Every beam, neighbours near each other.
    pub fn beams(&self) -> &[Beam] {
        &self.beams
    }

    /// Memory that the beams and the boxes above them occupy \[bytes\].
    pub fn bytes(&self) -> usize {
        let boxes: usize = self.levels.iter().map(Vec::len).sum();
        size_of_val(&self.beams[..])
            + size_of_val(&self.pieces[..])
            + size_of_val(&self.groups[..])
            + boxes * size_of::<Boxes>()
    }
}

/// The beams in the order in which pieces of them come first, which are numbered anew.
fn in_order_of(pieces: &mut [Piece], beams: Vec<Beam>) -> Vec<Beam> {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; beams.len()];
    let mut ordered = Vec::with_capacity(beams.len());
    for piece in pieces {
        let number = &mut numbers[piece.beam as usize];
        if *number == NONE {
            *number = ordered.len() as u32;
            ordered.push(beams[piece.beam as usize]);
        }
        piece.beam = *number;
    }
    ordered
}

/// Pieces of about half the mean length: three a beam at most, on average.
fn cut(beams: &[Beam]) -> Vec<Piece> {
    let total: f64 = beams.iter().map(|beam| beam.length).sum();
    let longest = 0.5 * total / beams.len() as f64;
    let of = |beam: &Beam| {
        let wanted = if longest > 0.0 { (beam.length / longest).ceil() } else { 1.0 };
        wanted.clamp(1.0, MOST_PIECES) as u16
    };
    let mut pieces = Vec::with_capacity(beams.iter().map(|beam| usize::from(of(beam))).sum());
    for (index, beam) in (0u32..).zip(beams) {
        let of = of(beam);
        pieces.extend((0..of).map(|part| Piece { beam: index, part, of }));
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::photons::Flags;
    use crate::photons::beams::BeamKind;
    use crate::rng::{Purpose, Stream};
    use glam::Vec3;

    fn beam(start: DVec3, dir: DVec3, length: f64) -> Beam {
        let (power, kind, flags) = (Vec3::ONE, BeamKind::Sampled, Flags::NONE);
        Beam { start, dir, length, power, medium: 0, order: 0, flags, kind }
    }

    /// Random beams, in large and small maps and far off, some parallel to the ray, nearly so and end-on, some without length and some
    /// very long: found is what all beams, asked one by one by formulas of their own, say, each once.
    #[test]
    fn beams_near_a_ray_are_those_found_one_by_one() {
        let mut stream = Stream::new(6, Purpose::Synthetic, 0, 0);
        let (mut found, mut thin) = (0, 0);
        for trial in 0..120 {
            let size = libm::exp10(8.0 * stream.unit() - 4.0);
            let far = DVec3::from(stream.triple()) * [0.0, 3.0 * size, 1e3 * size][trial % 3];
            let count = [0, 1, 5, 16, 17, 300, 3000][trial % 7];
            let position = |stream: &mut Stream| {
                far + (DVec3::from(stream.triple()) - 0.5) * DVec3::new(size, 0.3 * size, 0.1 * size)
            };
            let axis = warp::square_to_sphere(stream.pair());
            let beams: Vec<Beam> = (0..count)
                .map(|which| {
                    let about = warp::square_to_sphere(stream.pair());
                    let dir = match which % 8 {
                        0 => axis,
                        1 => -axis,
                        2 | 4 => (axis + about * 0.02).normalize(),
                        3 => (about * 1e-7 - axis).normalize(),
                        _ => about,
                    };
                    let length = match which % 5 {
                        0 => 0.0,
                        1 | 2 => 100.0 * size * stream.unit(),
                        _ => size * stream.unit() * stream.unit(),
                    };
                    beam(position(&mut stream), dir, length)
                })
                .collect();
            // In two parts, the first of them empty now and then.
            let cut = beams.len() / 3;
            let tree = BeamTree::new(vec![beams[..cut].to_vec(), beams[cut..].to_vec()]).unwrap();
            let keys = |beams: &[Beam]| {
                let mut keys: Vec<_> =
                    beams.iter().map(|beam| beam.start.to_array().map(f64::to_bits)).collect();
                keys.sort_unstable();
                keys
            };
            assert_eq!(keys(tree.beams()), keys(&beams));
            for which in 0..8 {
                let dir = match which {
                    0..=2 => axis,
                    3 => DVec3::X,
                    _ => warp::square_to_sphere(stream.pair()),
                };
                let away = [0.2, 2.0, 100.0][which % 3] * size;
                let ray = Ray::new(position(&mut stream) - dir * away, dir);
                let end = if which == 5 { f64::INFINITY } else { 2.0 * away * stream.unit() };
                let span = Interval { start: end.min(away) * 0.3 * stream.unit(), end };
                let radius = size * [1e-3, 0.02, 0.2, 30.0][which % 4];
                let mut seen = Vec::new();
                tree.near(&ray, span, radius, |beam, crossing| {
                    let place = ray.at(crossing.along_ray) + crossing.normal * crossing.offset;
                    let off = (place - beam.at(crossing.along_beam)).length();
                    let long = 1e-12 * (place.length() + beam.length + away + radius) / crossing.sine;
                    assert!(off < long, "{trial} {which}: {off} {long}");
                    thin += u32::from(crossing.sine < 0.03);
                    seen.push(beam.start.to_array().map(f64::to_bits));
                });
                // The lines' nearest points by the formulas of textbooks; those that these do not decide may be either.
                let sure = |beam: &Beam, by: f64| {
                    let (v, c) = (ray.origin - beam.start, dir.dot(beam.dir));
                    let squared = dir.cross(beam.dir).length_squared();
                    let error = 1e-14 * (v.length() + beam.length) / squared + 1e-12 * size;
                    let s = (c * v.dot(beam.dir) - v.dot(dir)) / squared;
                    let t = (v.dot(beam.dir) - c * v.dot(dir)) / squared;
                    let apart = (v + dir * s - beam.dir * t).length();
                    let most = |x: f64, from: f64, to: f64| x >= from - by * error && x < to + by * error;
                    squared > 0.0
                        && most(s, span.start, span.end)
                        && most(t, 0.0, beam.length)
                        && apart <= radius + by * error
                };
                let key = |beam: &Beam| beam.start.to_array().map(f64::to_bits);
                let mut once = seen.clone();
                once.sort_unstable();
                once.dedup();
                assert_eq!(once.len(), seen.len(), "{trial} {which}: twice");
                for beam in &beams {
                    let is_found = once.binary_search(&key(beam)).is_ok();
                    assert!(is_found || !sure(beam, -1.0), "{trial} {which}: {beam:?} is missed");
                    assert!(!is_found || sure(beam, 1.0), "{trial} {which}: {beam:?} is not near");
                }
                found += seen.len();
            }
        }
        assert!(found > 10_000 && thin > 100, "{found} {thin}");
    }

    /// The same tree on one thread and on many.
    #[test]
    fn trees_do_not_depend_on_the_threads() {
        let mut stream = Stream::new(7, Purpose::Synthetic, 0, 0);
        let one =
            |_| beam(DVec3::from(stream.triple()), warp::square_to_sphere(stream.pair()), stream.unit());
        let beams: Vec<Beam> = (0..40_000).map(one).collect();
        let order = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let tree = pool.install(|| BeamTree::new(vec![beams.clone()]).unwrap());
            tree.pieces.iter().map(|piece| (piece.beam, piece.part)).collect::<Vec<_>>()
        };
        let alone = order(1);
        assert!(alone.len() > beams.len());
        assert_eq!(alone, order(7));
    }

    /// A beam that is not finite is an error, and no panic.
    #[test]
    fn beams_are_finite() {
        for wrong in [
            beam(DVec3::NAN, DVec3::X, 1.0),
            beam(DVec3::ZERO, DVec3::X, f64::INFINITY),
            Beam { power: Vec3::NAN, ..beam(DVec3::ZERO, DVec3::X, 1.0) },
        ] {
            assert!(BeamTree::new(vec![vec![wrong]]).is_err());
        }
    }
}
