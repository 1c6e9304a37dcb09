//! Photons as a point cloud: PLY, binary, little endian.

use super::{WriteError, write_atomically};
use crate::photons::Photon;
use std::io::{self, Write};
use std::path::Path;

/// One number a photon, and what it is called.
const PROPERTIES: [&str; 14] = [
    "float x",
    "float y",
    "float z",
    "float dir_x",
    "float dir_y",
    "float dir_z",
    "float power_r",
    "float power_g",
    "float power_b",
    "uchar red",
    "uchar green",
    "uchar blue",
    "ushort order",
    "uchar flags",
];

/// The version of what a file holds.
const FORMAT: u32 = 1;

/// Writes photons: position \[L\], direction of travel, power \[W\] (as stored, divided by the emitted number), a colour for
/// viewers, order, and flags (1 specular, 2 surface, 4 medium).
///
/// # Errors
/// [`WriteError`], naming the path; the old file is then untouched.
pub fn write_ply(
    path: impl AsRef<Path>,
    photons: &[(Photon, u64)],
    colour: impl Fn(&Photon) -> [u8; 3],
) -> Result<(), WriteError> {
    write_atomically(path, |out| encode(out, photons, &colour))
}

fn encode(
    out: &mut dyn Write,
    photons: &[(Photon, u64)],
    colour: &dyn Fn(&Photon) -> [u8; 3],
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "comment turbid {}: stored photons, format {FORMAT}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "element vertex {}", photons.len())?;
    for property in PROPERTIES {
        writeln!(out, "property {property}")?;
    }
    writeln!(out, "end_header")?;
    for (photon, emitted) in photons {
        let power = photon.power / *emitted as f32;
        for vector in [photon.position.as_vec3(), photon.dir, power] {
            for number in vector.to_array() {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        out.write_all(&colour(photon))?;
        out.write_all(&photon.order.to_le_bytes())?;
        out.write_all(&[photon.flags.bits()])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::Flags;
    use glam::{DVec3, Vec3};

    /// The header counts the bytes behind it, and they are where it says.
    #[test]
    fn the_header_describes_the_body() {
        let photon = Photon {
            position: DVec3::new(1.0, -2.0, 3.5),
            dir: Vec3::NEG_Z,
            normal: Vec3::ZERO,
            power: Vec3::new(8.0, 4.0, 2.0),
            order: 515,
            flags: Flags::SPECULAR.with(Flags::MEDIUM),
        };
        let mut bytes = Vec::new();
        encode(&mut bytes, &[(photon, 4), (photon, 8)], &|_| [9, 8, 7]).unwrap();
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header = std::str::from_utf8(&bytes[..start]).unwrap();
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(header.contains(": stored photons, format 1\n") && header.contains("\nelement vertex 2\n"));
        let size = |line: &str| match line.split(' ').nth(1) {
            Some("float") => 4,
            Some("ushort") => 2,
            Some("uchar") => 1,
            other => panic!("{other:?}"),
        };
        let row: usize = header.lines().filter(|l| l.starts_with("property")).map(size).sum();
        let body = &bytes[start..];
        assert_eq!((row, body.len()), (42, 84));
        let float = |i: usize| f32::from_le_bytes(body[4 * i..4 * i + 4].try_into().unwrap());
        assert_eq!((0..9).map(float).collect::<Vec<_>>(), [1.0, -2.0, 3.5, 0.0, 0.0, -1.0, 2.0, 1.0, 0.5]);
        assert_eq!(body[36..42], [9, 8, 7, 3, 2, 5]);
        assert_eq!(f32::from_le_bytes(body[42 + 24..42 + 28].try_into().unwrap()), 1.0);
    }
}
