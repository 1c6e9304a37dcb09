//! Scenes from a file or by name, with `--set` on top.

use anyhow::Context;
use std::path::{Path, PathBuf};
use turbid::photons::check_end;
use turbid::scene::{Scene, SceneFile, SceneSource};

/// Which scene, and what to change in it.
#[derive(clap::Args)]
pub struct Source {
    /// A built-in scene (see `turbid scenes`) or a scene file.
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
        self.scene.display().to_string()
    }

    /// The scene's file, or the name of a built-in one.
    pub fn file(&self) -> &Path {
        &self.scene
    }

    /// The validated scene, in which light comes to an end.
    pub fn load(&self) -> anyhow::Result<Scene> {
        let source = self.source()?;
        let file = source.resolve()?;
        if self.confined {
            source.check_confined(&file)?;
        }
        let scene = file.scene(&source.folder()).with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        Ok(scene)
    }

    /// The scene file with every change made.
    pub fn resolve(&self) -> anyhow::Result<SceneFile> {
        Ok(self.source()?.resolve()?)
    }

    fn source(&self) -> turbid::Result<SceneSource> {
        self.sets.iter().try_fold(SceneSource::new(&self.scene), |source, set| source.with_set(set))
    }
}
