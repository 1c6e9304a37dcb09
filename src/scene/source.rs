//! Scenes from a file or by name, with values changed on top.

use super::builtin::{BUILTIN, Builtin};
use super::read::{say, unknown};
use super::{Scene, SceneFile};
use crate::error::{Error, Result};
use crate::input::{read_all, read_stream, text};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A scene by its file or by its name, and what to change in it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSource {
    scene: PathBuf,
    sets: Vec<(String, toml::Value)>,
}

/// Larger scene files are refused.
const MOST_BYTES: u64 = 1 << 26;

/// Memory that a scene file takes over its size while it is read, at most: each number of a long list is a value.
const IN_MEMORY: f64 = 80.0;

fn refused(text: String) -> Error {
    Error::Scene(text)
}

/// An error met in a file or a setting, which is told first.
fn met_in(what: impl Display, error: impl Display) -> Error {
    Error::Scene(format!("{what}: {error}"))
}

impl SceneSource {
    /// A built-in scene by its name, the path of a scene file, or `-` for one on standard input.
    pub fn new(scene: impl Into<PathBuf>) -> Self {
        SceneSource { scene: scene.into(), sets: Vec::new() }
    }

    /// The same with a value changed: `albedo` of a built-in scene, `regions.0.albedo` of a file.
    #[must_use]
    pub fn with(mut self, key: impl Into<String>, value: toml::Value) -> Self {
        self.sets.push((key.into(), value));
        self
    }

    /// The same with a change as the command line writes it, `albedo=0.5`.
    ///
    /// # Errors
    /// `Error::Scene` for what is no `KEY=VALUE`
    pub fn with_set(self, set: &str) -> Result<Self> {
        let (key, value) = split(set)?;
        Ok(self.with(key, value))
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        if self.is_standard_input() { "standard input".to_string() } else { self.scene.display().to_string() }
    }

    /// Whether the scene is on standard input, which can be read only once.
    pub fn is_standard_input(&self) -> bool {
        self.scene.as_os_str() == "-"
    }

    /// The scene's file, or the name of a built-in one.
    pub fn file(&self) -> &Path {
        &self.scene
    }

    /// Whether the scene is built in.
    pub fn is_builtin(&self) -> bool {
        self.builtin().is_some()
    }

    /// The folder that file names in the scene are relative to.
    pub fn folder(&self) -> PathBuf {
        self.scene.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// The validated scene.
    ///
    /// # Errors
    /// `Error::Scene` with the file, line and key where the scene cannot be read, or is none
    pub fn scene(&self) -> Result<Scene> {
        self.resolve()?.scene(&self.folder()).map_err(|error| met_in(self.name(), error))
    }

    fn builtin(&self) -> Option<&'static Builtin> {
        BUILTIN.iter().find(|b| Path::new(b.name) == self.scene)
    }

    /// The scene file with every change made.
    ///
    /// # Errors
    /// As [`SceneSource::scene`]
    pub fn resolve(&self) -> Result<SceneFile> {
        match self.builtin() {
            Some(builtin) => self.resolve_builtin(builtin),
            None => self.resolve_file(),
        }
    }

    fn resolve_builtin(&self, builtin: &Builtin) -> Result<SceneFile> {
        let mut text = builtin.defaults.to_string();
        let defaults = |error: toml::de::Error| met_in("built-in defaults", say(&text, &error));
        let mut table: toml::Table = toml::from_str(&text).map_err(defaults)?;
        for (key, value) in &self.sets {
            let set = || shown(key, value);
            if !table.contains_key(key) {
                let known = table.keys().map(String::as_str).collect::<Vec<_>>();
                return Err(met_in(set(), unknown("key", key, &known)));
            }
            table.insert(key.clone(), value.clone());
            text = written(&table)?;
            let checked = (builtin.resolve)(&text).map_err(|e| met_in(set(), say(&text, &e)))?;
            checked.map_err(|e| met_in(set(), e))?;
        }
        (builtin.resolve)(&text).map_err(|e| refused(say(&text, &e)))?
    }

    fn resolve_file(&self) -> Result<SceneFile> {
        let path = &self.scene;
        let is_bare_name = !self.is_standard_input() && !path.exists() && path.extension().is_none();
        if is_bare_name {
            return Err(refused(format!("no such scene: {}", unknown_scene(&self.name()))));
        }
        // A scene may come through a pipe.
        let read = match self.is_standard_input() {
            true => read_all(std::io::stdin().lock(), MOST_BYTES),
            false => read_stream(path, MOST_BYTES),
        };
        let text =
            read.and_then(text).map_err(|error| met_in(format!("cannot read {}", self.name()), error))?;
        let what = || format!("a scene file of {} bytes", text.len());
        crate::memory::check(what, IN_MEMORY * text.len() as f64)
            .map_err(|error| met_in(self.name(), error))?;
        self.changed(&text)
    }

    /// The scene file of a text, with every change made.
    ///
    /// # Errors
    /// As [`SceneSource::scene`]
    pub fn changed(&self, text: &str) -> Result<SceneFile> {
        let mut file = SceneFile::read(text, Some(&self.name()))?;
        let table = toml::from_str(text).map_err(|error| met_in(self.name(), error))?;
        let mut root = toml::Value::Table(table);
        for (key, value) in &self.sets {
            let set = || shown(key, value);
            *slot(&mut root, key).map_err(|error| met_in(set(), error))? = value.clone();
            file = SceneFile::read(&written(&root)?, None).map_err(|error| met_in(set(), error))?;
        }
        Ok(file)
    }
}

/// A change as the command line writes it.
fn shown(key: &str, value: &toml::Value) -> String {
    match value {
        toml::Value::String(word) => format!("--set {key}={word}"),
        other => format!("--set {key}={other}"),
    }
}

fn written(value: &impl serde::Serialize) -> Result<String> {
    toml::to_string(value).map_err(|error| refused(error.to_string()))
}

/// Key and value of `key=value`; a value that is no TOML is a word, unless it begins like a number.
fn split(set: &str) -> Result<(&str, toml::Value)> {
    let Some((key, value)) = set.split_once('=') else {
        return Err(refused(format!("--set {set}: allowed: KEY=VALUE")));
    };
    let (key, value) = (key.trim(), value.trim());
    let parsed =
        toml::from_str::<toml::Table>(&format!("value = {value}")).ok().and_then(|mut t| t.remove("value"));
    let is_number_like = value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    match parsed {
        Some(parsed) => Ok((key, parsed)),
        None if is_number_like => match value.parse::<f64>() {
            // TOML wants digits on both sides of the point, and no more range than f64 has.
            Ok(number) if number.is_finite() => Ok((key, toml::Value::Float(number))),
            _ => Err(refused(format!("--set {set}: {key} is {value}; allowed: a number that fits 64 bits"))),
        },
        None => Ok((key, toml::Value::String(value.to_string()))),
    }
}

/// The place of a dotted key, where numbers count list entries from 0. Only the last part may be new.
fn slot<'a>(place: &'a mut toml::Value, key: &str) -> Result<&'a mut toml::Value> {
    let (part, rest) = key.split_once('.').map_or((key, None), |(part, rest)| (part, Some(rest)));
    let inner = match place {
        toml::Value::Table(table) => {
            if rest.is_some() && !table.contains_key(part) {
                let known = table.keys().map(String::as_str).collect::<Vec<_>>();
                return Err(refused(unknown("key", part, &known)));
            }
            // A new key gets its value at once, from the caller.
            table.entry(part).or_insert(toml::Value::Boolean(false))
        }
        toml::Value::Array(list) => {
            let count = list.len();
            let found = part.parse::<usize>().ok().and_then(|i| list.get_mut(i));
            found.ok_or_else(|| {
                refused(format!("`{part}` is no entry of a list of {count}, counted from 0"))
            })?
        }
        other => return Err(refused(format!("`{part}` is inside `{other}`, which has no parts"))),
    };
    match rest {
        Some(rest) => slot(inner, rest),
        None => Ok(inner),
    }
}

fn unknown_scene(name: &str) -> String {
    let list = BUILTIN.iter().map(|b| b.name).collect::<Vec<_>>().join(", ");
    format!("`{name}` is neither a file nor built in; allowed: {list}, or the path of a scene file")
}
