//! Scenes from a file or by name, with `--set` on top.

use super::shared::note;
use anyhow::Context;
use std::path::{Path, PathBuf};
use turbid::exchange::open;
use turbid::output::is_same_file;
use turbid::photons::check_end;
use turbid::scene::{Scene, SceneFile, SceneSource};

/// Where a digest begins and what it is multiplied by (Fowler, Noll and Vo, FNV-1a of 64 bits).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);

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
        self.read_from(|_, _| Ok(())).map(|(file, scene, ())| (file, scene))
    }

    /// The same, and a number that stands for all that is in the files that it names.
    pub fn read_digested(&self) -> anyhow::Result<(SceneFile, Scene, u64)> {
        self.read_from(|file, folder| {
            let mut digest = FNV.0;
            for name in file.files()? {
                let bytes = std::fs::read(folder.join(&name)).with_context(|| name.clone())?;
                for byte in name.bytes().chain(bytes) {
                    digest = (digest ^ u64::from(byte)).wrapping_mul(FNV.1);
                }
            }
            Ok(digest)
        })
    }

    /// The scene, and what `look` finds in its file and folder.
    fn read_from<T>(
        &self,
        look: impl FnOnce(&SceneFile, &Path) -> anyhow::Result<T>,
    ) -> anyhow::Result<(SceneFile, Scene, T)> {
        let opened = open(&self.source()?, self.confined)?;
        opened.notes.iter().try_for_each(|text| note(text))?;
        let scene = opened.scene().with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        let found = look(&opened.file, &opened.folder)?;
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
