//! The integral along a chord of a beam: what a kernel of two or three dimensions takes of it.

use super::disc_share::RULE;
use crate::photons::beams::Chord;

/// Optical depth of a part of a chord, about: a rule of 8 nodes has what passes there to 1e-15.
const DEPTH: f64 = 1.0;

/// Parts of half a chord of one size, at most; of longer ones the parts grow from both ends, since what passes falls from either.
const MOST_PARTS: f64 = 64.0;

/// Visits places on a chord, as distances along the beam \[L\], with weights that sum to its length \[L\]: exact for kernels that are
/// polynomials, and to 1e-8 for what passes, which falls by no more than `rate` \[1/L\] from one end to the other; a cone's tip is met to
/// 1e-3, halves beginning where the beam is nearest.
pub(super) fn along_chord(chord: &Chord, rate: f64, mut visit: impl FnMut(f64, f64)) {
    let middle = chord.nearest.clamp(chord.start, chord.end);
    let mut part = |start: f64, width: f64| {
        RULE.iter().for_each(|(place, weight)| visit(start + width * place, width * weight));
    };
    for (from, to) in [(chord.start, middle), (middle, chord.end)] {
        let length = to - from;
        if length <= 0.0 {
            continue;
        }
        let parts = (rate * length / DEPTH).ceil().max(1.0);
        if parts <= MOST_PARTS {
            let width = length / parts;
            (0..parts as u32).for_each(|number| part(from + width * f64::from(number), width));
            continue;
        }
        let (half, mut near, mut width) = (0.5 * length, 0.0, DEPTH / rate);
        while near < half {
            let far = if near + width < half { near + width } else { half };
            part(from + near, far - near);
            part(to - far, far - near);
            (near, width) = (far, 2.0 * width);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What passes, from either end, at any rate and length; and the length itself. Roundings of places, 4e-16 of a length of 3, times the
    /// highest rate are 1e-9.
    #[test]
    fn what_passes_is_integrated() {
        for rate in [0.0, 1e-3, 1.0, 40.0, 100.0, 1e4, 1e6] {
            for (start, nearest, end) in [(0.0, 1.0, 3.0), (0.5, -1.0, 0.7), (0.0, 2.0, 2.0)] {
                let chord = Chord { start, end, nearest, is_first: true };
                let mut sums = [0.0; 3];
                along_chord(&chord, rate, |t, weight| {
                    sums[0] += weight;
                    sums[1] += weight * libm::exp(-rate * (t - start));
                    sums[2] += weight * libm::exp(-rate * (end - t));
                });
                let length = end - start;
                let passed = if rate > 0.0 { -libm::expm1(-rate * length) / rate } else { length };
                for (sum, exact) in sums.into_iter().zip([length, passed, passed]) {
                    assert!((sum / exact - 1.0).abs() < 1e-8, "{rate} {chord:?}: {sum} {exact}");
                }
            }
        }
    }
}
