//! What the cells of a folder belong to.

use super::cell::{self, FORMAT, Header};
use super::outputs::{MOST_NOTES, read_if_there};
use super::{Settings, Watch};
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};
use std::path::Path;
use turbid::output::{write_atomically, write_json};

/// Format, settings and program of a folder of cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Manifest {
    pub format: u32,
    pub seed: u64,
    pub settings: String,
    pub program: String,
}

const FILE: &str = "manifest.json";

impl Manifest {
    pub(super) fn new(settings: &Settings, program: &str) -> Self {
        Manifest {
            format: FORMAT,
            seed: settings.seed,
            settings: settings.words(),
            program: program.to_string(),
        }
    }

    /// Prepares the folder: forgets its cells if asked to, says which cells are not reused, writes the manifest.
    pub(super) fn prepare(
        &self,
        folder: &Path,
        settings: &Settings,
        watch: &dyn Watch,
    ) -> anyhow::Result<()> {
        let path = folder.join(FILE);
        let earlier =
            read_if_there(&path, MOST_NOTES)?.map(|bytes| serde_json::from_slice::<Manifest>(&bytes).ok());
        if settings.fresh && earlier.is_some() {
            // Only a folder with a manifest is ours to empty; of some experiments only their own cells are.
            let own = settings.only.iter().map(|name| folder.join(name)).filter(|own| own.is_dir());
            let own: Vec<_> =
                if settings.only.is_empty() { vec![folder.to_path_buf()] } else { own.collect() };
            for own in own {
                std::fs::remove_dir_all(&own).with_context(|| format!("cannot empty {}", own.display()))?;
            }
        } else if let Some(earlier) = earlier.flatten() {
            // Of many parts one asked for by mistake would replace what the others measured.
            ensure!(
                settings.part.is_none() || earlier.settings == self.settings,
                "{} holds cells of other settings ({}); allowed for a part: another --out",
                settings.out.display(),
                earlier.settings
            );
            if let Some(reason) = self.refusal(&earlier, settings) {
                watch.say(&reason);
            }
        }
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
        write_atomically(&path, |out| write_json(out, self))?;
        Ok(())
    }

    /// Why cells of an earlier manifest are not reused, in one line.
    fn refusal(&self, earlier: &Manifest, settings: &Settings) -> Option<String> {
        if earlier.format != self.format {
            return Some("Cells of an older format are not reused.".to_string());
        }
        if earlier.settings != self.settings {
            return Some(format!("Cells of other settings ({}) are not reused.", earlier.settings));
        }
        match (earlier.program == self.program, settings.reuse_cells) {
            (true, _) => None,
            (false, true) => {
                Some("Cells of another build are reused, as asked; the report says so.".to_string())
            }
            (false, false) => {
                Some("Cells of another build are not reused (--reuse-cells would).".to_string())
            }
        }
    }

    /// Whether a file holds a cell that this study can take.
    pub(super) fn accepts(&self, path: &Path, experiment: &str, id: &str, settings: &Settings) -> bool {
        cell::read(path).is_ok_and(|(header, _)| self.check(&header, experiment, id, settings).is_ok())
    }

    /// Whether a cell is one of this study.
    ///
    /// # Errors
    /// Why it is not
    pub(super) fn check(
        &self,
        header: &Header,
        experiment: &str,
        id: &str,
        settings: &Settings,
    ) -> anyhow::Result<()> {
        ensure!(header.experiment == experiment && header.id == id, "it is another cell's file");
        ensure!(
            header.settings == self.settings,
            "it is of other settings ({}, not {})",
            header.settings,
            self.settings
        );
        ensure!(
            header.program == self.program || settings.reuse_cells,
            "it is of another build of the program ({}, not {}); allowed: parts of one build, or --reuse-cells",
            header.program,
            self.program
        );
        Ok(())
    }
}
