//! `turbid import`: a scene of another program as a scene file.

use super::beside::{folder_and_stem, write_beside};
use super::shared::note;
use anyhow::{Context, bail};
use std::path::PathBuf;
use turbid::exchange::from_mitsuba;
use turbid::photons::check_end;

/// Read a scene of Mitsuba 3 (XML) and write it as a scene file.
///
/// Meshes, grids and phase functions are written beside the file, with names that begin as its own. What turbid cannot say is
/// refused by name, with its line; what is not quite the same is told. Commands that take a scene read `FILE.xml` too.
#[derive(clap::Args)]
pub struct Import {
    /// The XML file.
    file: PathBuf,
    /// The scene file to write.
    #[arg(short, long, value_name = "SCENE.toml")]
    output: PathBuf,
    /// A value of a parameter of the file, `$NAME`.
    #[arg(short = 'D', value_name = "NAME=VALUE")]
    define: Vec<String>,
    /// Refuse a scene that names files outside of its own folder: by an absolute name, by `..`, or through a link. For scenes
    /// of strangers.
    #[arg(long)]
    confined: bool,
}

impl Import {
    /// Reads, checks, writes.
    pub fn run(self) -> anyhow::Result<()> {
        let (folder, stem) = folder_and_stem("--output", &self.output, "toml")?;
        let mut given = Vec::new();
        for define in &self.define {
            let Some((name, value)) = define.split_once('=') else {
                bail!("-D {define}; allowed: NAME=VALUE")
            };
            given.push((name.to_string(), value.to_string()));
        }
        let imported = from_mitsuba(&self.file, stem, &given, self.confined)?;
        let parts = imported.in_folder()?;
        let scene = imported.scene.scene(parts.path()).with_context(|| self.file.display().to_string())?;
        check_end(&scene).with_context(|| self.file.display().to_string())?;
        let text = imported.scene.to_toml()?;
        write_beside(("--output", &self.output, &text), (&folder, &imported.files), &imported.read)?;
        imported.notes.iter().try_for_each(|text| note(text))?;
        Ok(())
    }
}
