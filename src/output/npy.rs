//! NumPy arrays: their header, and photons as records.

use super::{WriteError, write_atomically};
use crate::photons::Photon;
use crate::photons::file::class;
use std::io::{self, Write};
use std::path::Path;

/// The columns of [`crate::photons::file`].
const RECORD: &str = "[('position', '<f8', (3,)), ('direction', '<f8', (3,)), ('power', '<f8', (3,)), ('order', '<u2'), \
                      ('class', '|u1'), ('emitted', '<u8')]";

/// What a `.npy` file (version 1.0) begins with.
///
/// # Arguments
/// `descr` the type and `shape` the shape, as Python writes them
///
/// # Source
/// NEP 1, A Simple File Format for NumPy Arrays
pub(super) fn npy_header(descr: &str, shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
    // Ten bytes before it and a newline behind it, a multiple of 64 in all.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{text:<width$}\n", width = length - 1).into_bytes());
    bytes
}

/// Writes photons as a NumPy array of records, each with the number that was emitted into its map: the columns of
/// [`crate::photons::file`], every bit of them.
///
/// # Errors
/// [`WriteError`], naming the path; the old file is then untouched.
pub fn write_photons_npy(path: impl AsRef<Path>, photons: &[(Photon, u64)]) -> Result<(), WriteError> {
    write_atomically(path, |out| encode(out, photons))
}

fn encode(out: &mut dyn Write, photons: &[(Photon, u64)]) -> io::Result<()> {
    out.write_all(&npy_header(RECORD, &format!("({},)", photons.len())))?;
    for (photon, emitted) in photons {
        for vector in [photon.position, photon.dir.as_dvec3(), photon.power.as_dvec3()] {
            for number in vector.to_array() {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        out.write_all(&photon.order.to_le_bytes())?;
        out.write_all(&[class(photon)])?;
        out.write_all(&emitted.to_le_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::Flags;
    use glam::{DVec3, Vec3};

    /// Byte by byte what `numpy.save` writes of two such records.
    #[test]
    fn records_as_numpy_writes_them() {
        let photon = Photon {
            position: DVec3::new(0.1, -2.0, 3.5),
            dir: Vec3::NEG_Z,
            normal: Vec3::ZERO,
            power: Vec3::new(8.0, 0.1, 0.0),
            order: 515,
            flags: Flags::MEDIUM,
        };
        let mut bytes = Vec::new();
        encode(&mut bytes, &[(photon, 7), (Photon { normal: Vec3::Y, order: 0, ..photon }, 1 << 40)])
            .unwrap();
        let mut expected = b"\x93NUMPY\x01\x00\xf6\x00".to_vec();
        expected.extend(
            b"{'descr': [('position', '<f8', (3,)), ('direction', '<f8', (3,)), ('power', '<f8', (3,)), ",
        );
        expected.extend(b"('order', '<u2'), ('class', '|u1'), ('emitted', '<u8')], 'fortran_order': False, 'shape': (2,), }");
        expected.resize(255, b' ');
        expected.push(b'\n');
        for (order, class, emitted) in
            [([3, 2], 4, [7, 0, 0, 0, 0, 0, 0, 0]), ([0, 0], 12, [0, 0, 0, 0, 0, 1, 0, 0])]
        {
            for number in [0.1, -2.0, 3.5, 0.0, 0.0, -1.0, 8.0, f64::from(0.1f32), 0.0] {
                expected.extend(number.to_le_bytes());
            }
            expected.extend(order);
            expected.push(class);
            expected.extend(emitted);
        }
        assert_eq!(bytes, expected);
    }
}
