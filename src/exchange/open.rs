//! Scenes from anywhere: built in, in a scene file, in a scene of Mitsuba.

use super::import::{Imported, from_mitsuba};
use crate::error::{Error, Result};
use crate::scene::{Scene, SceneFile, SceneSource};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A scene's file, and where the files are that it names.
#[derive(Debug)]
pub struct Opened {
    /// The scene file, every change made.
    pub file: SceneFile,
    /// The folder that file names in it are relative to.
    pub folder: PathBuf,
    /// The files that it was read from, and those that it names.
    pub read: Vec<PathBuf>,
    /// What is not quite the same as in a scene of Mitsuba.
    pub notes: Vec<String>,
    parts: Option<TempDir>,
}

impl Opened {
    /// A scene file whose files are in a folder.
    pub fn new(file: SceneFile, folder: PathBuf) -> Self {
        Opened { file, folder, read: Vec::new(), notes: Vec::new(), parts: None }
    }

    /// Whether the folder is a temporary one, which goes with this value.
    pub fn is_temporary(&self) -> bool {
        self.parts.is_some()
    }

    /// The validated scene.
    ///
    /// # Errors
    /// `Error::Scene` and `Error::OutOfRange` for what is no scene
    pub fn scene(&self) -> Result<Scene> {
        self.file.scene(&self.folder)
    }
}

/// Opens a built-in scene, a scene file, or, where its name ends in .xml, a scene of Mitsuba 3 ([`from_mitsuba`]); a confined scene names
/// files in its own folder alone.
///
/// # Errors
/// `Error::Scene` with file and line, for what is none of them
pub fn open(source: &SceneSource, is_confined: bool) -> Result<Opened> {
    let mut opened = if is_of_mitsuba(source.file()) {
        let imported = from_mitsuba(source.file(), "scene", &[], is_confined)?;
        let text = imported.scene.to_toml().map_err(|error| Error::Scene(error.to_string()))?;
        let parts = imported.in_folder()?;
        let (file, folder) = (source.changed(&text)?, parts.path().to_path_buf());
        Opened { file, folder, read: imported.read, notes: imported.notes, parts: Some(parts) }
    } else {
        let mut opened = Opened::new(source.resolve()?, source.folder());
        if !source.is_builtin() && !source.is_standard_input() {
            opened.read.push(source.file().to_path_buf());
        }
        opened
    };
    opened.read.extend(opened.file.files()?.iter().map(|name| opened.folder.join(name)));
    if is_confined {
        opened.file.check_confined(&opened.folder).map_err(|error| error.within(&source.name()))?;
    }
    Ok(opened)
}

/// Whether a file is read as a scene of Mitsuba: by the end of its name.
pub fn is_of_mitsuba(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("xml"))
}

impl Imported {
    /// Writes the files beside the scene to a temporary folder, in which the scene can be read.
    ///
    /// # Errors
    /// `Error::Scene` where they cannot be written
    pub fn in_folder(&self) -> Result<TempDir> {
        let failed = |error: &dyn std::fmt::Display| {
            Error::Scene(format!("a folder for the parts of the scene: {error}"))
        };
        let folder = tempfile::tempdir().map_err(|error| failed(&error))?;
        for file in &self.files {
            std::fs::write(folder.path().join(&file.name), &file.bytes).map_err(|error| failed(&error))?;
        }
        Ok(folder)
    }
}
