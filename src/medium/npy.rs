//! Grids as files: NumPy arrays of three axes.

use super::Grid;
use crate::error::{Error, Result};
use crate::input::literal::Literal;
use crate::input::npy::NpyHeader;
use glam::DVec3;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Samples along an axis that a file may state.
const MOST: u64 = 1 << 20;
/// More values are refused: 1024^3 samples.
const MOST_VALUES: u64 = 1 << 30;

/// Types of numbers.
#[derive(Debug, Clone, Copy)]
enum Kind {
    F32,
    F64,
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }

    /// The number that these bytes hold, or the first four of them.
    fn number(self, bytes: [u8; 8]) -> f64 {
        let word = u64::from_le_bytes(bytes);
        match self {
            Kind::F32 => f64::from(f32::from_bits(word as u32)),
            Kind::F64 => f64::from_bits(word),
        }
    }
}

impl Grid {
    /// Reads a NumPy array over the box from `min` to `max`: element `[i, j, k]` is sample i along x, j along y, k along z.
    /// Doubles are rounded to single precision.
    ///
    /// # Errors
    /// `Error::Scene` that names the file: missing, too short or too long, not a NumPy array, of another type or another number of
    /// axes, larger than memory, with values that are negative or not finite; as [`Grid::new`]
    pub fn read_npy(path: &Path, corners: (DVec3, DVec3)) -> Result<Self> {
        let refused = |cause: &str| Error::Scene(format!("grid {}: {cause}", path.display()));
        // Asked first: to open a pipe that nobody writes to would wait for ever.
        let about = std::fs::metadata(path).map_err(|cause| refused(&cause.to_string()))?;
        if !about.is_file() {
            return Err(refused("a folder, a device or a pipe; allowed: a file"));
        }
        let input = File::open(path).map_err(|cause| refused(&cause.to_string()))?;
        let mut input = BufReader::with_capacity(1 << 16, input);
        let (count, values) = samples(&mut input, about.len()).map_err(|cause| refused(&cause))?;
        Grid::new(corners, count, 1, values).map_err(|cause| refused(&cause.to_string()))
    }
}

/// Samples an axis, and the values as a grid has them, x fastest.
///
/// # Errors
/// What is wrong with the file of `length` bytes, and what is allowed
fn samples(input: &mut impl Read, length: u64) -> std::result::Result<([usize; 3], Vec<f32>), String> {
    let NpyHeader { descr, is_fortran, shape, rest } = NpyHeader::read(input, length)?;
    let kind = match &descr {
        Literal::Text(kind) if kind == "<f4" => Kind::F32,
        Literal::Text(kind) if kind == "<f8" => Kind::F64,
        Literal::Text(kind) => {
            return Err(format!("has numbers of type '{kind}'; allowed: '<f4' and '<f8', little endian"));
        }
        _ => return Err("has records; allowed: numbers of type '<f4' or '<f8'".into()),
    };
    let [x, y, z] = shape[..] else {
        return Err(format!("has {} axes; allowed: 3, along x, y and z", shape.len()));
    };
    for (axis, size) in [("x", x), ("y", y), ("z", z)] {
        if !(1..=MOST).contains(&size) {
            return Err(format!("samples along {axis} are {size}; allowed: 1 to {MOST}"));
        }
    }
    // Three times 20 bits: no product is too large.
    let all = x * y * z;
    if all > MOST_VALUES {
        return Err(format!("has {x} x {y} x {z} samples; allowed: up to {MOST_VALUES} in all"));
    }
    let size = kind.size();
    if all * size as u64 != rest {
        return Err(format!(
            "{rest} bytes follow its header; allowed: {}, which it states",
            all * size as u64
        ));
    }
    // The values, once more where they are scaled and placed, and their bounds.
    crate::memory::check(|| format!("a grid of {all} samples"), 10.0 * all as f64)
        .map_err(|cause| cause.to_string())?;
    let count = [x, y, z].map(|n| n as usize);
    let mut values = vec![0.0; all as usize];
    let mut bytes = [0; 8];
    // Axes by how fast they run, the slowest first: in the order of C that is x.
    let axes: [usize; 3] = if is_fortran { [2, 1, 0] } else { [0, 1, 2] };
    let mut index = [0; 3];
    for slow in 0..count[axes[0]] {
        index[axes[0]] = slow;
        for middle in 0..count[axes[1]] {
            index[axes[1]] = middle;
            for fast in 0..count[axes[2]] {
                index[axes[2]] = fast;
                let [i, j, k] = index;
                input
                    .read_exact(&mut bytes[..size])
                    .map_err(|cause| format!("cannot read element [{i}, {j}, {k}]: {cause}"))?;
                let value = kind.number(bytes);
                // Not true of what is not a number.
                let is_allowed = value >= 0.0 && value <= f64::from(f32::MAX);
                if !is_allowed {
                    let name = format!("element [{i}, {j}, {k}]");
                    let allowed = "at least 0, and what single precision holds";
                    return Err(Error::out_of_range(name, value, allowed).to_string());
                }
                values[(k * count[1] + j) * count[0] + i] = value as f32;
            }
        }
    }
    Ok((count, values))
}
