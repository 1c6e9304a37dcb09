//! `turbid export`: a scene as one of another program.

use super::beside::{folder_and_stem, write_beside};
use super::load::Source;
use super::shared::note;
use anyhow::Context;
use std::path::PathBuf;
use turbid::exchange::to_mitsuba;

/// Write a scene as a scene of Mitsuba 3, which renders to the same values.
///
/// Meshes and grids are written beside the file, with names that begin as its own. What Mitsuba cannot say is refused by
/// name; what is not quite the same is told. The picture: `mitsuba -m scalar_rgb -D spp=256 FILE.xml`.
#[derive(clap::Args)]
pub struct Export {
    #[command(flatten)]
    source: Source,
    /// The XML file to write.
    #[arg(long, value_name = "FILE.xml")]
    mitsuba: PathBuf,
}

impl Export {
    /// Writes the files.
    pub fn run(self) -> anyhow::Result<()> {
        let (folder, stem) = folder_and_stem("--mitsuba", &self.mitsuba, "xml")?;
        let (scene, read) = self.source.load_with_files()?;
        let exported = to_mitsuba(&scene, stem).with_context(|| self.source.name())?;
        write_beside(("--mitsuba", &self.mitsuba, &exported.text), (&folder, &exported.files), &read)?;
        exported.notes.iter().try_for_each(|text| note(text))?;
        Ok(())
    }
}
