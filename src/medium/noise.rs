//! Fractal value noise, with bounds.

use glam::DVec3;

/// Octaves that a noise may have: the twelfth has 2048 lattice steps to one of the first.
pub const MOST_OCTAVES: u32 = 12;
/// Lattice points along an axis that bounds look at; a box with more in it has the bounds of all.
const LOOKED_AT: i64 = 6;

/// Numbers at the points of a lattice, smooth in between, in octaves of doubled frequency; in \[-1, 1\].
///
/// Within a cell of the lattice the value is a convex sum of those at the cell's corners, so that these bound it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    seed: u64,
    octaves: u32,
    /// Amplitude of an octave over that of the one before.
    gain: f64,
    /// One over the sum of all amplitudes.
    norm: f64,
}

/// A number in [-1, 1) of a lattice point.
///
/// Each coordinate is multiplied in and mixed by the output function of SplitMix64 (Steele, Lea and Flood 2014).
fn hash(seed: u64, [x, y, z]: [i64; 3]) -> f64 {
    let mix = |word: u64| {
        let mut z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let word = mix(mix(mix(mix(seed) ^ x as u64) ^ y as u64) ^ z as u64);
    (word >> 11) as f64 * (2.0 / 9_007_199_254_740_992.0) - 1.0
}

/// Frequency and seed of an octave: offsets keep the lattices of octaves apart.
fn octave(seed: u64, i: u32) -> (f64, f64, u64) {
    (f64::from(1u32 << i), 0.37 * f64::from(i), seed.wrapping_add(u64::from(i)))
}

impl Noise {
    /// A noise of `octaves` from 1 to [`MOST_OCTAVES`], each with `gain` times the amplitude of the one before.
    pub(super) fn new(seed: u64, octaves: u32, gain: f64) -> Self {
        let sum = (0..octaves).fold((0.0, 1.0), |(sum, a), _| (sum + a, a * gain)).0;
        Noise { seed, octaves, gain, norm: 1.0 / sum }
    }

    /// The value at a point, in lattice steps of the first octave.
    pub fn at(&self, p: DVec3) -> f64 {
        let (mut sum, mut amplitude) = (0.0, self.norm);
        for i in 0..self.octaves {
            let (frequency, offset, seed) = octave(self.seed, i);
            sum += amplitude * value(seed, p * frequency + offset);
            amplitude *= self.gain;
        }
        sum
    }

    /// Bounds of the value in a box.
    pub fn bounds(&self, min: DVec3, max: DVec3) -> (f64, f64) {
        let (mut low, mut high, mut amplitude) = (0.0, 0.0, self.norm);
        for i in 0..self.octaves {
            let (frequency, offset, seed) = octave(self.seed, i);
            let (a, b) = value_bounds(seed, min * frequency + offset, max * frequency + offset);
            low += amplitude * a;
            high += amplitude * b;
            amplitude *= self.gain;
        }
        (low, high)
    }
}

/// The cell that a coordinate lies in; beyond 2^53, where cells have no inside, the last one.
fn cell(x: f64) -> i64 {
    const LAST: f64 = 9_007_199_254_740_992.0;
    x.floor().clamp(-LAST, LAST) as i64
}

/// One octave.
fn value(seed: u64, p: DVec3) -> f64 {
    let corner = p.to_array().map(cell);
    // 3t^2 - 2t^3: no slope at the lattice points, so that cells meet smoothly.
    let part = p.to_array().map(|x| {
        let t = x - x.floor();
        t * t * (3.0 - 2.0 * t)
    });
    let at = |x: i64, y: i64, z: i64| hash(seed, [corner[0] + x, corner[1] + y, corner[2] + z]);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let line = |y: i64, z: i64| mix(at(0, y, z), at(1, y, z), part[0]);
    let face = |z: i64| mix(line(0, z), line(1, z), part[1]);
    mix(face(0), face(1), part[2])
}

/// The least and the greatest number at the corners of all cells that a box touches.
fn value_bounds(seed: u64, min: DVec3, max: DVec3) -> (f64, f64) {
    let (first, last) = (min.to_array().map(cell), max.to_array().map(|x| cell(x) + 1));
    if (0..3).any(|axis| last[axis] - first[axis] >= LOOKED_AT) {
        return (-1.0, 1.0);
    }
    let (mut low, mut high) = (1.0f64, -1.0f64);
    for z in first[2]..=last[2] {
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let number = hash(seed, [x, y, z]);
                (low, high) = (low.min(number), high.max(number));
            }
        }
    }
    (low, high)
}
