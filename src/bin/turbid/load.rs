//! Scenes from a file or by name, with `--set` on top.

use super::beside::in_folder;
use super::shared::note;
use anyhow::Context;
use std::path::{Path, PathBuf};
use turbid::exchange::from_mitsuba;
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

    /// The words that name it on a command line, for a shell.
    pub fn words(&self) -> String {
        let quoted = |word: &str| {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+:,".contains(c);
            match !word.is_empty() && word.chars().all(is_plain) {
                true => word.to_string(),
                false => format!("'{}'", word.replace('\'', "'\\''")),
            }
        };
        let mut words = vec![quoted(&self.scene.display().to_string())];
        words.extend(self.sets.iter().map(|set| format!("--set {}", quoted(set))));
        words.extend(self.confined.then(|| "--confined".to_string()));
        words.join(" ")
    }

    /// Whether a file is the scene's own.
    pub fn is_file(&self, file: &Path) -> bool {
        !SceneSource::new(&self.scene).is_standard_input() && is_same_file(file, &self.scene).unwrap_or(false)
    }

    /// The validated scene, in which light comes to an end.
    pub fn load(&self) -> anyhow::Result<Scene> {
        Ok(self.read()?.1)
    }

    /// The same with the file that it follows from, every change made.
    pub fn read(&self) -> anyhow::Result<(SceneFile, Scene)> {
        if self.scene.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml")) {
            let imported = from_mitsuba(&self.scene, "scene", &[], self.confined)?;
            imported.notes.iter().try_for_each(|text| note(text))?;
            let folder = in_folder(&imported)?;
            let file = self.source()?.changed(&imported.scene.to_toml()?)?;
            return self.scene_in(file, folder.path());
        }
        let source = self.source()?;
        self.scene_in(source.resolve()?, &source.folder())
    }

    /// The scene file with every change made.
    pub fn resolve(&self) -> anyhow::Result<SceneFile> {
        Ok(self.source()?.resolve()?)
    }

    fn source(&self) -> turbid::Result<SceneSource> {
        self.sets.iter().try_fold(SceneSource::new(&self.scene), |source, set| source.with_set(set))
    }

    fn scene_in(&self, file: SceneFile, folder: &Path) -> anyhow::Result<(SceneFile, Scene)> {
        if self.confined {
            file.check_confined(folder).with_context(|| self.name())?;
        }
        let scene = file.scene(folder).with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        Ok((file, scene))
    }
}
