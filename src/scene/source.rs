//! Scenes from a file or by name, with values changed on top.

use super::builtin::{BUILTIN, Builtin};
use super::read::{toml_message, unknown};
use super::{Scene, SceneFile};
use crate::error::{Error, Result};
use crate::input::{read_all, read_stream, text};
use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

/// A scene by its file or by its name, and what to change in it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSource {
    scene: PathBuf,
    changes: Vec<Change>,
}

/// A value that is changed.
#[derive(Debug, Clone, PartialEq)]
struct Change {
    key: String,
    value: toml::Value,
    /// Whether the command line said so.
    is_set: bool,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let option = if self.is_set { "--set " } else { "" };
        match &self.value {
            toml::Value::String(word) => write!(f, "{option}{}={word}", self.key),
            other => write!(f, "{option}{}={other}", self.key),
        }
    }
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
        SceneSource { scene: scene.into(), changes: Vec::new() }
    }

    /// The same with a value changed: `albedo` of a built-in scene, `regions.0.albedo` of a file.
    #[must_use]
    pub fn with(mut self, key: impl Into<String>, value: toml::Value) -> Self {
        self.changes.push(Change { key: key.into(), value, is_set: false });
        self
    }

    /// The same with a change as the command line writes it, `albedo=0.5`.
    ///
    /// # Errors
    /// `Error::Scene` for what is no `KEY=VALUE`
    pub fn with_set(mut self, set: &str) -> Result<Self> {
        let (key, value) = split(set)?;
        self.changes.push(Change { key: key.to_string(), value, is_set: true });
        Ok(self)
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
        let defaults = |error| met_in("built-in defaults", toml_message(builtin.defaults, &error));
        let table: toml::Table = toml::from_str(builtin.defaults).map_err(defaults)?;
        let read = |root: &toml::Value| {
            let text = written(root)?;
            (builtin.resolve)(&text).map_err(|error| refused(toml_message(&text, &error)))?
        };
        self.made_in(&toml::Value::Table(table), false, read)
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
        let file = SceneFile::read(text, Some(&self.name()))?;
        if self.changes.is_empty() {
            return Ok(file);
        }
        let root = toml::from_str(text).map_err(|error| met_in(self.name(), error))?;
        self.made_in(&toml::Value::Table(root), true, |root| SceneFile::read(&written(root)?, None))
    }

    /// The scene file with every change made before any is checked: some are allowed together alone. What is wrong is told of the
    /// first change with which it is.
    fn made_in(
        &self,
        start: &toml::Value,
        may_be_new: bool,
        read: impl Fn(&toml::Value) -> Result<SceneFile>,
    ) -> Result<SceneFile> {
        let mut root = start.clone();
        for change in &self.changes {
            let place = slot(&mut root, &change.key, may_be_new).map_err(|error| met_in(change, error))?;
            *place = change.value.clone();
        }
        read(&root).map_err(|whole| {
            let mut root = start.clone();
            for change in &self.changes {
                if let Ok(place) = slot(&mut root, &change.key, may_be_new) {
                    *place = change.value.clone();
                }
                if let Err(error) = read(&root) {
                    return met_in(change, error);
                }
            }
            whole
        })
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

/// The place of a dotted key, where numbers count list entries from 0. Only the last part may be new, if any.
fn slot<'a>(place: &'a mut toml::Value, key: &str, may_be_new: bool) -> Result<&'a mut toml::Value> {
    let (part, rest) = key.split_once('.').map_or((key, None), |(part, rest)| (part, Some(rest)));
    let inner = match place {
        toml::Value::Table(table) => {
            if (rest.is_some() || !may_be_new) && !table.contains_key(part) {
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
        Some(rest) => slot(inner, rest, may_be_new),
        None => Ok(inner),
    }
}

fn unknown_scene(name: &str) -> String {
    let list = BUILTIN.iter().map(|b| b.name).collect::<Vec<_>>().join(", ");
    format!("`{name}` is neither a file nor built in; allowed: {list}, or the path of a scene file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_built_in_scenes_are_checked_together() {
        let slab = BUILTIN.iter().find(|builtin| builtin.name == "slab").unwrap();
        let changed = |changes: &[(&str, f64)]| {
            let with = |source: SceneSource, (key, value): &(&str, f64)| source.with(*key, (*value).into());
            changes.iter().fold(SceneSource::new("slab"), with).resolve()
        };
        assert_eq!(changed(&[]), (slab.resolve)(slab.defaults).unwrap());
        assert_ne!(changed(&[("tau", 1.0)]), changed(&[]));
        let told = |changes: &[(&str, f64)]| changed(changes).unwrap_err().to_string();
        assert!(told(&[("albedo", 2.0)]).starts_with("albedo=2.0: albedo is 2"));
        assert!(told(&[("tau", 1.0), ("albedo", 2.0), ("g", 0.0)]).starts_with("albedo=2.0: albedo is 2"));
        let wrong = told(&[("tua", 2.0)]);
        assert!(
            wrong.starts_with("tua=2.0: unknown key `tua`; nearest: `tau`; allowed: albedo, "),
            "{wrong}"
        );
        // The depth of a probe is at most tau, whichever of the two is named first.
        let deep = SceneSource::new("shaft").with("depth", 9.0.into());
        assert!(
            deep.resolve()
                .unwrap_err()
                .to_string()
                .starts_with("depth=9.0: depth is 9; allowed: at most tau")
        );
        assert!(deep.with("tau", 10.0.into()).resolve().is_ok());
        let set = SceneSource::new("slab").with_set("albedo=2").unwrap().resolve().unwrap_err().to_string();
        assert!(set.starts_with("--set albedo=2: albedo is 2"), "{set}");
    }

    #[test]
    fn changes_of_a_file_are_checked_together() {
        let text = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1.0 } }\nsigma_t = 1.0\nalbedo = 0.5\ng = 0.0\n\
                    [[lights]]\npoint = { position = [0, 0, 0], power = 1.0 }\n";
        let wrong = SceneSource::new("fog.toml").with("regions.0.albedo", 2.into());
        let told = |source: &SceneSource| source.changed(text).unwrap_err().to_string();
        assert!(told(&wrong).starts_with("regions.0.albedo=2: albedo is 2"), "{}", told(&wrong));
        let later = wrong.clone().with("regions.0.g", 0.5.into());
        assert!(told(&later).starts_with("regions.0.albedo=2: albedo is 2"), "{}", told(&later));
        assert!(told(&later.with("regions.7.g", 0.5.into())).starts_with("regions.7.g=0.5: `7` is no entry"));
        assert!(wrong.with("regions.0.albedo", 0.25.into()).changed(text).is_ok());
    }
}
