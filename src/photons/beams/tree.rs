//! The tree over beams: pieces of them in kd order, boxes sixteen wide above them.

use super::Beam;
use super::crossing::Crossing;
use super::order::{BLOCK, Entry, kd_order};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use crate::photons::tree::bits;
use crate::photons::tree::{Boxes, Cylinder, Extent, Units, levels_of};
use glam::DVec3;

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
    /// In kd order, sixteen a box of the lowest level.
    pieces: Vec<Piece>,
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
        let pieces: Vec<Piece> = entries.into_iter().map(|entry| pieces[entry.index as usize]).collect();
        let extents = pieces.iter().map(|piece| {
            let beam = &beams[piece.beam as usize];
            let (from, to) = piece.span(beam.length);
            let [a, b] = [from, to].map(|t| units.relative(beam.at(t)).as_vec3());
            Extent { lower: a.min(b).to_array(), upper: a.max(b).to_array() }
        });
        let levels = levels_of(extents.collect());
        Ok(BeamTree { units, beams, pieces, levels })
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
        let Some(cylinder) = Cylinder::new(&self.units, ray, span, radius) else {
            self.pieces.iter().for_each(ask);
            return;
        };
        let (mut touched, mut parents) = (vec![0u32], Vec::new());
        for (height, level) in self.levels.iter().enumerate().rev() {
            std::mem::swap(&mut touched, &mut parents);
            touched.clear();
            for &node in &parents {
                let first = node as usize * BLOCK;
                let inside = bits(cylinder.touched(&level[node as usize])).map(|lane| first + lane);
                if height > 0 {
                    touched.extend(inside.map(|child| child as u32));
                } else {
                    inside.for_each(|place| ask(&self.pieces[place]));
                }
            }
        }
    }

    /// Number of beams.
    pub fn len(&self) -> usize {
        self.beams.len()
    }

    /// Whether there are no beams.
    pub fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// Every beam, in the order in which they came.
    pub fn beams(&self) -> &[Beam] {
        &self.beams
    }

    /// Memory that the beams and the boxes above them occupy \[bytes\].
    pub fn bytes(&self) -> usize {
        let boxes: usize = self.levels.iter().map(Vec::len).sum();
        size_of_val(&self.beams[..]) + size_of_val(&self.pieces[..]) + boxes * size_of::<Boxes>()
    }
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
