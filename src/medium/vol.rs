//! Grids as files: the binary `.vol` format of Mitsuba, version 3.
//!
//! Little-endian: the letters `VOL`, the version 3 as a byte; five 32-bit integers: 1 for single-precision values,
//! samples along x, y and z, channels; six 32-bit floats: the box's lower and upper corner; then the values, channel
//! fastest, then x, y, z.

use super::Grid;
use crate::error::{Error, Result};
use glam::DVec3;
use std::path::Path;

const HEADER: usize = 48;
/// Samples along an axis that a file may state: the memory of a grid is asked for only after its length is right.
const MOST: i32 = 1 << 20;

/// The 4 bytes at an index, which the caller knows to be there.
fn word(bytes: &[u8], at: usize) -> [u8; 4] {
    [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
}

/// Larger files are refused: 1024^3 samples.
const MOST_BYTES: u64 = (1 << 32) + HEADER as u64;

impl Grid {
    /// Reads a `.vol` file.
    ///
    /// # Errors
    /// `Error::Scene` that names the file: missing, too short or too long, not of this format, of another version or
    /// type, with a size or channels out of range, with values that are negative or not finite
    pub fn read(path: &Path) -> Result<Self> {
        let bytes =
            crate::input::read(path, MOST_BYTES).map_err(|cause| refused(path, &cause.to_string()))?;
        // The values once more, and their bounds.
        crate::memory::check(|| format!("a grid of {} bytes", bytes.len()), 1.2 * bytes.len() as f64)
            .map_err(|cause| refused(path, &cause.to_string()))?;
        Grid::from_bytes(&bytes).map_err(|cause| refused(path, &cause.to_string()))
    }

    /// The grid that a `.vol` file of these bytes holds.
    ///
    /// # Errors
    /// `Error::Scene` or `Error::OutOfRange`, as [`Grid::read`]
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let refuse = |text: String| Err(Error::Scene(text));
        if bytes.len() < 4 || &bytes[..3] != b"VOL" {
            return refuse("does not start with `VOL`; allowed: a Mitsuba grid".into());
        }
        if bytes[3] != 3 {
            return refuse(format!("version is {}; allowed: 3", bytes[3]));
        }
        if bytes.len() < HEADER {
            return refuse(format!("ends after {} bytes, within the header of {HEADER}", bytes.len()));
        }
        let integer = |i: usize| i32::from_le_bytes(word(bytes, 4 + 4 * i));
        if integer(0) != 1 {
            return refuse(format!("type of the values is {}; allowed: 1, single precision", integer(0)));
        }
        let mut count = [0usize; 3];
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let size = integer(1 + axis);
            if !(1..=MOST).contains(&size) {
                return refuse(format!("samples along {name} are {size}; allowed: 1 to {MOST}"));
            }
            count[axis] = size as usize;
        }
        let channels = integer(4);
        if channels != 1 && channels != 3 {
            return refuse(format!("channels are {channels}; allowed: 1 or 3"));
        }
        let channels = channels as usize;
        let float = |i: usize| f64::from(f32::from_le_bytes(word(bytes, 24 + 4 * i)));
        let corners = (DVec3::new(float(0), float(1), float(2)), DVec3::new(float(3), float(4), float(5)));
        let values = count.iter().fold(channels as u64, |product, n| product.saturating_mul(*n as u64));
        let length = values.saturating_mul(4).saturating_add(HEADER as u64);
        if bytes.len() as u64 != length {
            return refuse(format!("has {} bytes; allowed: {length}, which its header states", bytes.len()));
        }
        let values = bytes[HEADER..].chunks_exact(4).map(|b| f32::from_le_bytes(word(b, 0))).collect();
        Grid::new(corners, count, channels, values)
    }

    /// The bytes of its `.vol` file. The box's corners are rounded to single precision.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + 4 * self.values().len());
        bytes.extend(b"VOL\x03");
        let [x, y, z] = self.count();
        for number in [1, x, y, z, self.channels()] {
            bytes.extend((number as i32).to_le_bytes());
        }
        let (min, max) = self.corners();
        for number in min.to_array().into_iter().chain(max.to_array()) {
            bytes.extend((number as f32).to_le_bytes());
        }
        for value in self.values() {
            bytes.extend(value.to_le_bytes());
        }
        bytes
    }
}

fn refused(path: &Path, cause: &str) -> Error {
    Error::Scene(format!("grid {}: {cause}", path.display()))
}
