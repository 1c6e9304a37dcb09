//! Photons of media in files, our own and those of other programs: PLY and NumPy arrays, told apart by how they begin.
//!
//! Both have the same columns, PLY with a name for each number, NumPy for each vector:
//!
//! | PLY | NumPy | |
//! |---|---|---|
//! | `x y z` | `position` | where it collided \[L\] |
//! | `dir_x dir_y dir_z` | `direction` | unit direction of travel |
//! | `power_r power_g power_b` | `power` | \[W\], as though it were the only one emitted: estimates divide by the number emitted |
//! | `order` | `order` | scatterings so far, 0 for uncollided light; 65535 and more are 65535 |
//! | `class` | `class` | what its path met: 1 specular, 2 surface, 4 medium, added up; 8 more where it lies on a surface itself. May be missing |
//! | `emitted`, or `comment emitted N` | `emitted` | photons sent out into its map, the same of all. May be missing: whoever reads it must know then |
//!
//! Vectors are of single or double precision, the others of any type of number. Other columns are passed over.

mod class;
mod header;
mod layout;
mod npy;
mod ply;
mod rows;

pub use class::{MOST_EMITTED, ON_SURFACE, class};

use super::Photon;
use crate::error::{Error, Result};
use header::Header;
use rows::{Rows, check_end};
use std::fs::{File, Metadata};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// A file of photons whose header has been read and fits its size.
#[derive(Debug)]
pub struct PhotonFile {
    path: PathBuf,
    input: BufReader<File>,
    header: Header,
}

/// An error about a file of photons.
fn refused(path: &Path, text: &str) -> Error {
    Error::Scene(format!("{}: {text}", path.display()))
}

impl PhotonFile {
    /// Opens a file and reads its header; nothing is asked for by what it says before that fits the size of the file.
    ///
    /// # Errors
    /// `Error::Scene` that names the file: missing, no file, none of the two formats, columns missing or of a wrong type, more
    /// photons than it has bytes for, bytes behind the last one
    pub fn open(path: &Path) -> Result<Self> {
        Self::try_open(path).map_err(|text| refused(path, &text))
    }

    fn try_open(path: &Path) -> std::result::Result<Self, String> {
        let read = |cause: std::io::Error| format!("cannot read it: {cause}");
        // Asked first: to open a pipe that nobody writes to would wait for ever.
        let is_file = |about: Metadata| about.is_file().then_some(about.len());
        let Some(length) = std::fs::metadata(path).map_err(read).map(is_file)? else {
            return Err("a folder, a device or a pipe; allowed: a file".into());
        };
        let mut input = BufReader::with_capacity(1 << 16, File::open(path).map_err(read)?);
        let mut magic = [0; 4];
        let begun = (&mut input).take(4).read(&mut magic).map_err(read)?;
        let header = match &magic[..begun] {
            b"ply\n" | b"ply\r" => ply::header(&mut input, length)?,
            b"\x93NUM" => npy::header(&mut magic.chain(&mut input), length)?,
            _ => return Err("is neither PLY nor a NumPy array; allowed: photons as .ply or .npy".into()),
        };
        Ok(PhotonFile { path: path.to_path_buf(), input, header })
    }

    /// Photons in it.
    pub fn count(&self) -> u64 {
        self.header.count
    }

    /// The photons, in the order of the file, and the number emitted, if the file says it.
    ///
    /// # Errors
    /// `Error::Scene` that names file and photon, counted from 0: numbers that are not finite, powers below 0, directions whose
    /// length differs from 1 by more than 1e-3, photons on surfaces, numbers emitted that differ
    pub fn read(self) -> Result<(Vec<Photon>, Option<u64>)> {
        let PhotonFile { path, mut input, header } = self;
        let Header { count, body, is_alone, emitted } = header;
        let refuse = |number: u64, text: &str| refused(&path, &format!("photon {number}: {text}"));
        // No more than the file has bytes for, as its header was checked.
        let mut photons = Vec::with_capacity(usize::try_from(count).unwrap_or_default());
        let (mut rows, layout) = Rows::of(body);
        let mut common = emitted;
        for number in 0..count {
            let row = rows.next(&mut input).map_err(|text| refuse(number, &text))?;
            let (photon, emitted) = layout.photon(row).map_err(|text| refuse(number, &text))?;
            if let Some(emitted) = emitted
                && *common.get_or_insert(emitted) != emitted
            {
                let text = format!(
                    "is one of {emitted} emitted, those before it of {}; allowed: the photons of one map",
                    common.unwrap_or_default()
                );
                return Err(refuse(number, &text));
            }
            photons.push(photon);
        }
        if is_alone {
            check_end(&mut input).map_err(|text| refused(&path, &text))?;
        }
        Ok((photons, common))
    }
}
