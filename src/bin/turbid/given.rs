//! `turbid measure --photons-from`: photons that others have sent out.

use anyhow::bail;
use std::path::PathBuf;
use turbid::output::{is_same_file, one_line};
use turbid::photons::Photon;
use turbid::photons::file::PhotonFile;
use turbid::scene::Scene;
use turbid::sensor::is_answered_by_map;

/// Files of photons, a map each, whose headers have been read.
pub struct Given {
    files: Vec<(PathBuf, PhotonFile)>,
    emitted: Option<u64>,
}

impl Given {
    /// Opens all of them; `emitted` is the number of those that do not say it.
    ///
    /// # Errors
    /// One file twice, since maps are to be independent; those of [`PhotonFile::open`]
    pub fn open(paths: &[PathBuf], emitted: Option<u64>) -> anyhow::Result<Self> {
        for (number, path) in paths.iter().enumerate() {
            if paths[..number].iter().any(|other| is_same_file(path, other).unwrap_or(false)) {
                bail!(
                    "--photons-from names {} twice; allowed: independent maps, a file each",
                    path.display()
                );
            }
        }
        let open = |path: &PathBuf| Ok((path.clone(), PhotonFile::open(path)?));
        Ok(Given { files: paths.iter().map(open).collect::<turbid::Result<_>>()?, emitted })
    }

    /// Photons of the largest.
    pub fn most(&self) -> u64 {
        self.files.iter().map(|(_, file)| file.count()).max().unwrap_or(0)
    }

    /// The photons of each, read when they are asked for, and the number emitted; `see` is shown them.
    pub fn photons(
        self,
        mut see: impl FnMut(&[Photon]),
    ) -> impl Iterator<Item = turbid::Result<(Vec<Photon>, u64)>> {
        let Given { files, emitted: given } = self;
        files.into_iter().map(move |(path, file)| {
            let (photons, said) = file.read()?;
            let refuse = |text: &str| Err(turbid::Error::Scene(format!("{}: {text}", path.display())));
            see(&photons);
            match (said, given) {
                (Some(_), Some(_)) => {
                    refuse("says how many photons were emitted; allowed: --emitted only for files that do not")
                }
                (None, None) => {
                    refuse("does not say how many photons were emitted; allowed: with a column emitted, or --emitted N")
                }
                (said, given) => Ok((photons, said.or(given).unwrap_or_default())),
            }
        })
    }
}

/// What a reader should know: which sensors are left out, and that uncollided light is missing where it counts.
pub fn notes(scene: &Scene, has_uncollided: bool, counts_uncollided: bool) -> Vec<String> {
    let left_out: Vec<String> = scene
        .sensors()
        .iter()
        .filter(|sensor| !is_answered_by_map(sensor))
        .map(|sensor| one_line(&format!("{} {}", sensor.name, sensor.label)))
        .collect();
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        notes.push(format!(
            "left out, since photons of a file do not answer what counts photons on their way: {}",
            left_out.join(", ")
        ));
    }
    if counts_uncollided && !has_uncollided {
        notes.push(
            "no photon of order 0 is in the files, though a fluence counts them: uncollided light is missing, unless there \
             is none; --orders 1.. leaves it out"
                .to_string(),
        );
    }
    notes
}
