//! Scenes from a file or by name, with values changed on top.

use super::builtin::{BUILTIN, Builtin};
use super::{Scene, SceneFile};
use crate::error::{Error, Result};
use crate::input::{read_all, read_stream, text};
use std::fmt::Display;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

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

    /// Refuses a scene that names files outside of its own folder: by an absolute name, by `..`, or through a link.
    ///
    /// # Errors
    /// `Error::Scene` that names the file
    pub fn check_confined(&self, file: &SceneFile) -> Result<()> {
        check_confined(&value(file)?, &self.folder()).map_err(|error| met_in(self.name(), error))
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
        let mut file = SceneFile::from_toml(&text).map_err(|e| refused(located(&self.name(), &text, &e)))?;
        let table = toml::from_str(&text).map_err(|e| refused(located(&self.name(), &text, &e)))?;
        let mut root = toml::Value::Table(table);
        check_lengths(&root, &file).map_err(|error| met_in(self.name(), error))?;
        for (key, value) in &self.sets {
            let set = || shown(key, value);
            *slot(&mut root, key).map_err(|error| met_in(set(), error))? = value.clone();
            let changed = written(&root)?;
            file = SceneFile::from_toml(&changed).map_err(|e| met_in(set(), say(&changed, &e)))?;
            check_lengths(&root, &file).map_err(|error| met_in(set(), error))?;
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

/// A scene file as keys and values.
fn value(file: &SceneFile) -> Result<toml::Value> {
    let text = file.to_toml().map_err(|error| refused(error.to_string()))?;
    Ok(toml::Value::Table(toml::from_str(&text).map_err(|error| refused(error.to_string()))?))
}

/// Refuses names of files, the values of all keys `file`, that lead out of a folder.
fn check_confined(value: &toml::Value, folder: &Path) -> Result<()> {
    match value {
        toml::Value::Table(table) => table.iter().try_for_each(|(key, value)| match value {
            toml::Value::String(name) if key == "file" => check_inside(name, folder),
            other => check_confined(other, folder),
        }),
        toml::Value::Array(values) => values.iter().try_for_each(|value| check_confined(value, folder)),
        _ => Ok(()),
    }
}

fn check_inside(name: &str, folder: &Path) -> Result<()> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let is_plain =
        Path::new(name).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    // What is not there is refused by who reads it.
    let leads_inside = match (folder.canonicalize(), folder.join(name).canonicalize()) {
        (Ok(folder), Ok(file)) => file.starts_with(folder),
        _ => true,
    };
    if !(is_plain && leads_inside) {
        return Err(refused(format!(
            "file {name:?} is outside of the scene's folder; allowed with --confined: files in it"
        )));
    }
    Ok(())
}

/// Refuses lists of numbers of which only the first ones were read, as `position = [0, 0, 0, 1]`.
fn check_lengths(given: &toml::Value, file: &SceneFile) -> Result<()> {
    read_whole(given, value(file).ok().as_ref(), "")
}

/// Whether a value was read to its end; what was read is none where it is a default.
fn read_whole(given: &toml::Value, read: Option<&toml::Value>, key: &str) -> Result<()> {
    let inner = |part: &str| if key.is_empty() { part.to_string() } else { format!("{key}.{part}") };
    match given {
        toml::Value::Table(table) => table
            .iter()
            .try_for_each(|(part, value)| read_whole(value, read.and_then(|r| r.get(part)), &inner(part))),
        toml::Value::Array(list) => {
            // Three equal channels are written as one number, and what is a default is not written: points, spectra.
            let most = read.and_then(toml::Value::as_array).map_or(3, Vec::len);
            if list.len() > most {
                return Err(refused(format!("{key} has {} entries; allowed: {most}", list.len())));
            }
            let entry = |i: usize| read.and_then(toml::Value::as_array).and_then(|r| r.get(i));
            list.iter()
                .enumerate()
                .try_for_each(|(i, value)| read_whole(value, entry(i), &inner(&i.to_string())))
        }
        _ => Ok(()),
    }
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
            _ => {
                return Err(refused(format!(
                    "--set {set}: {key} is {value}; allowed: a number that fits 64 bits"
                )));
            }
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
                return Err(refused(format!(
                    "{}",
                    unknown("key", part, &table.keys().map(String::as_str).collect::<Vec<_>>())
                )));
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

/// An unknown key or value, and the nearest known one.
fn unknown(what: &str, key: &str, known: &[&str]) -> String {
    let nearest =
        known.iter().max_by(|a, b| strsim::jaro_winkler(a, key).total_cmp(&strsim::jaro_winkler(b, key)));
    let list = known.join(", ");
    match nearest {
        Some(name) => format!("unknown {what} `{key}`; nearest: `{name}`; allowed: {list}"),
        None => format!("unknown {what} `{key}`"),
    }
}

fn unknown_scene(name: &str) -> String {
    let list = BUILTIN.iter().map(|b| b.name).collect::<Vec<_>>().join(", ");
    format!("`{name}` is neither a file nor built in; allowed: {list}, or the path of a scene file")
}

/// The error in one line with file, line and column.
fn located(file: &str, text: &str, error: &toml::de::Error) -> String {
    let start = error.span().map_or(0, |span| span.start).min(text.len());
    let before = &text[..start];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
    format!("{file}:{line}:{column}: {}", say(text, error))
}

/// The error's message in one line, with the key in the place of "the value", and the nearest known key.
fn say(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().replace('\n', " ");
    for (prefix, what) in [("unknown field `", "key"), ("unknown variant `", "value")] {
        if let Some(rest) = message.strip_prefix(prefix) {
            let word = rest.split('`').next().unwrap_or_default();
            let known: Vec<&str> = rest.split('`').skip(2).step_by(2).collect();
            return unknown(what, word, &known);
        }
    }
    if let Some(rest) = message.strip_prefix("unexpected keys in table: ")
        && let Some((words, known)) = rest.split_once(", available keys: ")
    {
        let first = words.split(", ").next().unwrap_or_default();
        return unknown("key", first, &known.split(", ").collect::<Vec<_>>());
    }
    match error.span().and_then(|span| key_before(text, span)) {
        Some(key) => match message.strip_prefix("the value") {
            Some(rest) => format!("{key}{rest}"),
            None => format!("{key}: {message}"),
        },
        None => message,
    }
}

/// The key whose value stands at a place of the text: the last `key =` before it, on its line.
fn key_before(text: &str, span: Range<usize>) -> Option<&str> {
    let line = text.get(..span.start)?.rsplit('\n').next()?;
    let before = line.rsplit_once('=')?.0.trim_end();
    let start = before.rfind(|c: char| !(c.is_alphanumeric() || "_-.".contains(c))).map_or(0, |i| i + 1);
    (start < before.len()).then(|| &before[start..])
}
