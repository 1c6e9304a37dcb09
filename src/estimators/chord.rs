//! The integral along a chord of a beam: what a kernel of two or three dimensions takes of it.

use super::disc_share::RULE;
use crate::photons::beams::Chord;

/// Optical depth of a part of a chord, about: a rule of 8 nodes has what passes there to 1e-15.
const DEPTH: f64 = 1.0;

/// Parts of half a chord, at most.
const MOST_PARTS: f64 = 64.0;

/// Visits places on a chord, as distances along the beam \[L\], with weights that sum to its length \[L\]: exact for kernels that are
/// polynomials, and to rounding for what passes, which falls by no more than `rate` \[1/L\]; a cone's tip is met to 1e-3, halves beginning
/// where the beam is nearest.
pub(super) fn along_chord(chord: &Chord, rate: f64, mut visit: impl FnMut(f64, f64)) {
    let middle = chord.nearest.clamp(chord.start, chord.end);
    for (from, to) in [(chord.start, middle), (middle, chord.end)] {
        let length = to - from;
        if length <= 0.0 {
            continue;
        }
        let parts = (rate * length / DEPTH).ceil().clamp(1.0, MOST_PARTS);
        let width = length / parts;
        for part in 0..parts as u32 {
            let start = from + width * f64::from(part);
            RULE.iter().for_each(|(place, weight)| visit(start + width * place, width * weight));
        }
    }
}
