//! Scenes from a file or by name, with `--set` on top.

use anyhow::Context;
use std::path::{Path, PathBuf};
use turbid::output::is_same_file;
use turbid::photons::check_end;
use turbid::scene::{Scene, SceneFile, SceneSource};

/// Which scene, and what to change in it.
#[derive(clap::Args)]
pub struct Source {
    /// A built-in scene (see `turbid scenes`), a scene file, or - for one on standard input.
    scene: PathBuf,
    /// Change a value before the scene is made: `albedo=0.5` of a built-in scene, `regions.0.albedo=0.5` of a file.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Refuse a scene that names files outside of its own folder: by an absolute name, by `..`, or through a link. For scenes
    /// of strangers.
    #[arg(long)]
    confined: bool,
}

impl Source {
    /// A scene with these changes.
    pub fn with_sets(scene: &str, sets: Vec<String>) -> Self {
        Source { scene: scene.into(), sets, confined: false }
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        SceneSource::new(&self.scene).name()
    }

    /// Whether a file is the scene's own.
    pub fn is_file(&self, file: &Path) -> bool {
        !SceneSource::new(&self.scene).is_standard_input() && is_same_file(file, &self.scene).unwrap_or(false)
    }

    /// The validated scene, in which light comes to an end.
    pub fn load(&self) -> anyhow::Result<Scene> {
        self.scene_of(&self.resolve()?)
    }

    /// The same of its file, which may be read only once.
    pub fn scene_of(&self, file: &SceneFile) -> anyhow::Result<Scene> {
        let source = SceneSource::new(&self.scene);
        if self.confined {
            source.check_confined(file)?;
        }
        let scene = file.scene(&source.folder()).with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        Ok(scene)
    }

    /// The scene file with every change made.
    pub fn resolve(&self) -> anyhow::Result<SceneFile> {
        let source = SceneSource::new(&self.scene);
        Ok(self.sets.iter().try_fold(source, |source, set| source.with_set(set))?.resolve()?)
    }
}
