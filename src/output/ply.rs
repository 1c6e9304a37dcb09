//! Photons as a point cloud: PLY, binary, little endian.

use super::{WriteError, write_atomically};
use crate::photons::Photon;
use crate::photons::file::class;
use std::io::{self, Write};
use std::path::Path;

/// One number a photon, and what it is called.
const PROPERTIES: [&str; 14] = [
    "double x",
    "double y",
    "double z",
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
    "uchar class",
];

/// The version of what a file holds: 2 since powers are not divided by the number emitted, which is beside them, and positions
/// are doubles.
const FORMAT: u32 = 2;

/// Writes photons, each with the number that was emitted into its map: the columns of [`crate::photons::file`], and a colour for
/// viewers. Where all have one number emitted, it is a comment, else a property.
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
    let first = photons.first().map(|(_, emitted)| *emitted);
    let common = first.filter(|first| photons.iter().all(|(_, emitted)| emitted == first));
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "comment turbid {}: stored photons, format {FORMAT}", env!("CARGO_PKG_VERSION"))?;
    if let Some(common) = common {
        writeln!(out, "comment emitted {common}")?;
    }
    writeln!(out, "element vertex {}", photons.len())?;
    // The format has no whole numbers of 64 bits.
    let own = common.is_none().then_some("double emitted");
    for property in PROPERTIES.into_iter().chain(own) {
        writeln!(out, "property {property}")?;
    }
    writeln!(out, "end_header")?;
    for (photon, emitted) in photons {
        for number in photon.position.to_array() {
            out.write_all(&number.to_le_bytes())?;
        }
        for number in [photon.dir, photon.power].into_iter().flat_map(|vector| vector.to_array()) {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&colour(photon))?;
        out.write_all(&photon.order.to_le_bytes())?;
        out.write_all(&[class(photon)])?;
        if common.is_none() {
            out.write_all(&(*emitted as f64).to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::Flags;
    use glam::{DVec3, Vec3};

    fn photon() -> Photon {
        Photon {
            position: DVec3::new(0.1, -2.0, 3.5),
            dir: Vec3::NEG_Z,
            normal: Vec3::ZERO,
            power: Vec3::new(8.0, 4.0, 2.0),
            order: 515,
            flags: Flags::SPECULAR.with(Flags::MEDIUM),
        }
    }

    /// Header and body of a file of photons.
    fn encoded(photons: &[(Photon, u64)]) -> (String, Vec<u8>) {
        let mut bytes = Vec::new();
        encode(&mut bytes, photons, &|_| [9, 8, 7]).unwrap();
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        (String::from_utf8(bytes[..start].to_vec()).unwrap(), bytes[start..].to_vec())
    }

    /// The header counts the bytes behind it, and they are where it says.
    #[test]
    fn the_header_describes_the_body() {
        let lying = Photon { normal: Vec3::Z, ..photon() };
        let (header, body) = encoded(&[(photon(), 4), (lying, 4)]);
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(header.contains(": stored photons, format 2\n") && header.contains("\nelement vertex 2\n"));
        assert!(header.contains("\ncomment emitted 4\n"), "{header}");
        let size = |line: &str| match line.split(' ').nth(1) {
            Some("double") => 8,
            Some("float") => 4,
            Some("ushort") => 2,
            Some("uchar") => 1,
            other => panic!("{other:?}"),
        };
        let row: usize = header.lines().filter(|l| l.starts_with("property")).map(size).sum();
        assert_eq!((row, body.len()), (54, 108));
        let double = |at: usize| f64::from_le_bytes(body[at..at + 8].try_into().unwrap());
        assert_eq!([0, 8, 16].map(double), [0.1, -2.0, 3.5]);
        let float = |i: usize| f32::from_le_bytes(body[24 + 4 * i..28 + 4 * i].try_into().unwrap());
        assert_eq!((0..6).map(float).collect::<Vec<_>>(), [0.0, 0.0, -1.0, 8.0, 4.0, 2.0]);
        assert_eq!(body[48..54], [9, 8, 7, 3, 2, 5]);
        assert_eq!(body[54 + 53], 13);
    }

    /// Photons of two maps say each what it is one of.
    #[test]
    fn photons_of_several_maps_have_a_column() {
        let (header, body) = encoded(&[(photon(), 4), (photon(), 1 << 40)]);
        assert!(!header.contains("comment emitted"), "{header}");
        assert!(header.contains("property uchar class\nproperty double emitted\nend_header\n"), "{header}");
        let emitted = |i: usize| f64::from_le_bytes(body[62 * i + 54..62 * (i + 1)].try_into().unwrap());
        assert_eq!((emitted(0), emitted(1), body.len()), (4.0, 1_099_511_627_776.0, 124));
    }
}
