//! A file in which a user asks a study of their own.

use super::Digest;
use anyhow::{Context, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use turbid::exchange::{is_of_mitsuba, open};
use turbid::scene::SceneSource;

/// A study file, as text; what it means is for the experiment that it is put to.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The file.
    pub path: PathBuf,
    /// What it holds.
    pub text: String,
    /// Digest of it and of the files that it and its scene name: cells of others are not reused.
    pub digest: String,
    /// Heading of the report, if the file has one.
    pub title: Option<String>,
}

/// Larger study files, and larger scenes that they name, are none.
const MOST_BYTES: u64 = 1 << 20;
const MOST_SCENE: u64 = 1 << 26;

impl Question {
    /// Reads a study file.
    ///
    /// # Errors
    /// What cannot be read, and why
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let text =
            turbid::input::text(read(path, MOST_BYTES)?).with_context(|| path.display().to_string())?;
        Question::of(path, text)
    }

    /// The text of a study file, which need not be there: its folder is where the files are that it names.
    ///
    /// # Errors
    /// A text that is too long, and files that cannot be read
    pub fn of(path: &Path, text: String) -> anyhow::Result<Self> {
        ensure!(
            text.len() as u64 <= MOST_BYTES,
            "{} has {} bytes; allowed: up to {MOST_BYTES}",
            path.display(),
            text.len()
        );
        let table: toml::Table = toml::from_str(&text).unwrap_or_default();
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut parts = vec![text.as_bytes().to_vec()];
        let mut named = BTreeSet::new();
        files_in(&toml::Value::Table(table.clone()), folder, &mut named);
        let scenes: Vec<PathBuf> =
            named.iter().filter(|p| p.extension().is_some_and(|e| e == "toml")).cloned().collect();
        for scene in scenes {
            let text = String::from_utf8(read(&scene, MOST_SCENE)?).unwrap_or_default();
            let folder = scene.parent().unwrap_or(Path::new(""));
            if let Ok(table) = toml::from_str::<toml::Table>(&text) {
                files_in(&toml::Value::Table(table), folder, &mut named);
            }
        }
        for file in &named {
            ensure!(file.as_path() != path, "{} names itself", path.display());
            let digest = Digest::of_file(file).with_context(|| format!("cannot read {}", file.display()))?;
            parts.push(digest.to_string().into_bytes());
        }
        // A scene of Mitsuba names its files in its own way.
        for scene in named.iter().filter(|file| is_of_mitsuba(file)) {
            // What is wrong with it is told where it is read.
            let Ok(opened) = open(&SceneSource::new(scene), false) else { continue };
            for file in &opened.read {
                let digest =
                    Digest::of_file(file).with_context(|| format!("cannot read {}", file.display()))?;
                parts.push(digest.to_string().into_bytes());
            }
        }
        let digest = Digest::of(&parts.join(&b"\n"[..])).to_string();
        let title = table.get("title").and_then(|title| title.as_str()).map(turbid::output::one_line);
        Ok(Question { path: path.to_path_buf(), text, digest, title })
    }

    /// The name of the file without its ending, in characters that any folder may have.
    pub fn stem(&self) -> String {
        stem(&self.path)
    }
}

fn read(path: &Path, most: u64) -> anyhow::Result<Vec<u8>> {
    turbid::input::read(path, most).with_context(|| format!("cannot read {}", path.display()))
}

/// The name of a file without its ending, in characters that any folder may have.
pub(super) fn stem(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().to_lowercase()).unwrap_or_default();
    stem.chars().map(|c| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' }).collect()
}

/// The files that words of a table name, relative to a folder.
fn files_in(value: &toml::Value, folder: &Path, found: &mut BTreeSet<PathBuf>) {
    match value {
        toml::Value::String(word) => {
            let path = folder.join(word);
            if !word.is_empty() && path.is_file() {
                found.insert(path);
            }
        }
        toml::Value::Array(values) => values.iter().for_each(|value| files_in(value, folder, found)),
        toml::Value::Table(table) => table.values().for_each(|value| files_in(value, folder, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_of_all_files() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("scene.toml", "[[regions]]\nshape = { mesh = { file = 'a.ply' } }\n");
        write("a.ply", "ply");
        write("study.toml", "title = 'T'\nscene = 'scene.toml'\n");
        let read = || Question::read(&folder.path().join("study.toml")).unwrap();
        let first = read();
        assert_eq!((first.title.as_deref(), first.stem().as_str()), (Some("T"), "study"));
        assert_eq!(read(), first);
        let path = folder.path().join("study.toml");
        assert_eq!(Question::of(&path, std::fs::read_to_string(&path).unwrap()).unwrap(), first);
        let long = Question::of(&path, " ".repeat(MOST_BYTES as usize + 1)).unwrap_err();
        assert!(long.to_string().ends_with("allowed: up to 1048576"), "{long}");
        write("a.ply", "ply2");
        let second = read();
        assert_ne!(second.digest, first.digest);
        write("scene.toml", "[[regions]]\nshape = { mesh = { file = 'a.ply' } } # same\n");
        assert_ne!(read().digest, second.digest);
        assert!(Question::read(&folder.path().join("none.toml")).is_err());
        // Those of a scene of Mitsuba too.
        write("study.toml", "scene = 'scene.xml'\n");
        write(
            "scene.xml",
            "<scene version='3.0.0'><integrator type='volpath'/><shape type='obj'><string name='filename' value='a.obj'/>\
             <bsdf type='diffuse'/></shape><include filename='lights.xml'/></scene>",
        );
        write("lights.xml", "<scene version='3.0.0'><emitter type='constant'/></scene>");
        write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let third = read();
        assert_eq!(read(), third);
        write("a.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
        let fourth = read();
        assert_ne!(fourth.digest, third.digest);
        write("lights.xml", "<scene version='3.0.0'><emitter type='constant'/> </scene>");
        assert_ne!(read().digest, fourth.digest);
    }
}
