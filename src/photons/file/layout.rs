//! Where the numbers of a photon stand in a record, and what they may be.

use super::class::{MOST_EMITTED, ON_SURFACE};
use crate::error::plain;
use crate::photons::{Flags, Photon};
use glam::{DVec3, Vec3};

/// A type of numbers, little endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    F32,
    F64,
    /// Whole numbers of so many bytes.
    Unsigned(usize),
    /// The same with a sign.
    Signed(usize),
}

impl Number {
    /// Bytes.
    pub fn size(self) -> usize {
        match self {
            Number::F32 => 4,
            Number::F64 => 8,
            Number::Unsigned(size) | Number::Signed(size) => size,
        }
    }

    /// Whether it holds fractions.
    pub fn is_float(self) -> bool {
        matches!(self, Number::F32 | Number::F64)
    }

    /// The number in these bytes; of whole numbers beyond 2^53 the nearest.
    fn read(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        word[..self.size()].copy_from_slice(&bytes[..self.size()]);
        let whole = u64::from_le_bytes(word);
        match self {
            Number::F32 => f64::from(f32::from_bits(whole as u32)),
            Number::F64 => f64::from_bits(whole),
            Number::Unsigned(_) => whole as f64,
            Number::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                ((whole << unused) as i64 >> unused) as f64
            }
        }
    }
}

/// Where a number stands in a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub offset: usize,
    pub number: Number,
}

impl Place {
    fn read(self, record: &[u8]) -> f64 {
        self.number.read(&record[self.offset..])
    }
}

/// Where the numbers of a photon stand.
#[derive(Debug)]
pub(super) struct Layout {
    /// Bytes of a record.
    pub size: usize,
    pub position: [Place; 3],
    pub direction: [Place; 3],
    pub power: [Place; 3],
    pub order: Place,
    pub class: Option<Place>,
    pub emitted: Option<Place>,
}

/// Differences of a direction's length from 1: what single precision rounds, which stays as it is so that our own photons keep
/// their bits, and what is an error of whoever wrote the file.
const ROUNDED: f64 = 1e-6;
const WRONG: f64 = 1e-3;

/// Where all larger orders are kept.
const LAST_ORDER: f64 = u16::MAX as f64;

impl Layout {
    /// The photon of a record, and the number emitted with it, where it is a column.
    ///
    /// # Errors
    /// What is wrong with it, and what is allowed
    pub fn photon(&self, record: &[u8]) -> Result<(Photon, Option<u64>), String> {
        let vector = |places: [Place; 3]| DVec3::from_array(places.map(|place| place.read(record)));
        let is = |name: &str, numbers: [f64; 3], allowed: &str| {
            Err(format!("{name} is ({}); allowed: {allowed}", numbers.map(plain).join(", ")))
        };
        let (position, direction, power) =
            (vector(self.position), vector(self.direction), vector(self.power));
        if !position.is_finite() {
            return is("position", position.to_array(), "finite numbers");
        }
        // The least and the largest of what is not a number are others.
        if !(power.is_finite() && power.min_element() >= 0.0 && power.max_element() <= f64::from(f32::MAX)) {
            return is("power", power.to_array(), "at least 0, and what single precision holds");
        }
        let length = direction.length();
        // Not true of what is not a number.
        let is_unit = (length - 1.0).abs() <= WRONG;
        if !is_unit {
            return is("direction", direction.to_array(), "a unit vector, to 1e-3");
        }
        let direction = if (length - 1.0).abs() <= ROUNDED { direction } else { direction / length };
        let order = self.order.read(record);
        if !(order >= 0.0 && order.fract() == 0.0) {
            return Err(format!("order is {order}; allowed: whole numbers from 0"));
        }
        let class = self.class.map_or(0.0, |class| class.read(record));
        let on_surface = f64::from(ON_SURFACE);
        if (on_surface..2.0 * on_surface).contains(&class) {
            return Err(format!("class is {class}: it lies on a surface; allowed: photons of media, 0 to 7"));
        }
        let flags = (class.fract() == 0.0 && (0.0..on_surface).contains(&class)).then_some(class as u8);
        let Some(flags) = flags.and_then(Flags::of_bits) else {
            return Err(format!("class is {class}; allowed: whole numbers from 0 to 7"));
        };
        let emitted = self.emitted.map(|emitted| whole_emitted(emitted.read(record))).transpose()?;
        let photon = Photon {
            position,
            dir: direction.as_vec3(),
            normal: Vec3::ZERO,
            power: power.as_vec3(),
            order: order.min(LAST_ORDER) as u16,
            flags,
        };
        Ok((photon, emitted))
    }
}

/// A number of photons emitted.
///
/// # Errors
/// What it is, and what is allowed
pub(super) fn whole_emitted(number: f64) -> Result<u64, String> {
    match number.fract() == 0.0 && (1.0..=MOST_EMITTED).contains(&number) {
        true => Ok(number as u64),
        false => Err(format!("emitted is {number}; allowed: whole numbers from 1 to {MOST_EMITTED:e}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_type() {
        let cases: [(Number, &[u8], f64); 9] = [
            (Number::Unsigned(1), &[200], 200.0),
            (Number::Signed(1), &[200], -56.0),
            (Number::Unsigned(2), &[1, 2], 513.0),
            (Number::Signed(2), &[0xff, 0xff], -1.0),
            (Number::Signed(4), &[0, 0, 0, 0x80], -2_147_483_648.0),
            (Number::Unsigned(8), &[0xff; 8], 18_446_744_073_709_551_615.0),
            (Number::Signed(8), &[0xff; 8], -1.0),
            (Number::F32, &0.1f32.to_le_bytes(), 0.1f32 as f64),
            (Number::F64, &0.1f64.to_le_bytes(), 0.1),
        ];
        for (number, bytes, value) in cases {
            assert_eq!(number.read(bytes), value, "{number:?}");
        }
    }
}
