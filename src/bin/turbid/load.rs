//! Scenes from a file or by name, with `--set` on top.

use super::beside::refuse_read;
use super::digest::Digest;
use super::shared::note;
use anyhow::Context;
use std::path::{Path, PathBuf};
use turbid::exchange::{Opened, open};
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

    /// The validated scene, in which light comes to an end. Refuses outputs, each with the option that names it, over a file that the
    /// scene is read from.
    pub fn load(&self, outputs: &[(&str, &Path)]) -> anyhow::Result<Scene> {
        Ok(self.read(outputs)?.1)
    }

    /// The same with the file that it follows from, every change made.
    pub fn read(&self, outputs: &[(&str, &Path)]) -> anyhow::Result<(SceneFile, Scene)> {
        self.read_from(outputs, |_| Ok(())).map(|(file, scene, ())| (file, scene))
    }

    /// The same, and a number that stands for all that is in the files that it names.
    pub fn read_digested(&self, outputs: &[(&str, &Path)]) -> anyhow::Result<(SceneFile, Scene, u64)> {
        self.read_from(outputs, |opened| {
            let mut digest = Digest::EMPTY;
            for name in opened.file.files()? {
                let bytes = std::fs::read(opened.folder.join(&name)).with_context(|| name.clone())?;
                digest = digest.with(name.as_bytes()).with(&bytes);
            }
            Ok(digest.number())
        })
    }

    /// The scene, and the files that it is read from.
    pub fn load_with_files(&self) -> anyhow::Result<(Scene, Vec<PathBuf>)> {
        self.read_from(&[], |opened| Ok(opened.read.clone())).map(|(_, scene, read)| (scene, read))
    }

    /// The scene, and what `look` finds in its file and folder.
    fn read_from<T>(
        &self,
        outputs: &[(&str, &Path)],
        look: impl FnOnce(&Opened) -> anyhow::Result<T>,
    ) -> anyhow::Result<(SceneFile, Scene, T)> {
        let opened = open(&self.source()?, self.confined)?;
        for (option, output) in outputs {
            refuse_read(option, output, &opened.read)?;
        }
        opened.notes.iter().try_for_each(|text| note(text))?;
        let scene = opened.scene().with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        let found = look(&opened)?;
        Ok((opened.file, scene, found))
    }

    /// The scene file with every change made.
    pub fn resolve(&self) -> anyhow::Result<SceneFile> {
        Ok(self.source()?.resolve()?)
    }

    fn source(&self) -> turbid::Result<SceneSource> {
        self.sets.iter().try_fold(SceneSource::new(&self.scene), |source, set| source.with_set(set))
    }
}
