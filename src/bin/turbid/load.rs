//! Scenes from a file or by name, with `--set` on top.

use super::beside::in_folder;
use super::shared::note;
use anyhow::{Context, anyhow, bail};
use std::ops::Range;
use std::path::{Path, PathBuf};
use turbid::exchange::from_mitsuba;
use turbid::input::{is_inside, read_stream, text};
use turbid::photons::check_end;
use turbid::scene::{BUILTIN, Builtin, Scene, SceneFile};

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

/// Larger scene files are refused.
const MOST_BYTES: u64 = 1 << 26;

/// Memory that a scene file takes over its size while it is read, at most: each number of a long list is a value.
const IN_MEMORY: f64 = 80.0;

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
        if self.scene.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml")) {
            return self.load_imported();
        }
        let file = self.resolve()?;
        if self.confined {
            let folder = self.folder();
            check_confined(&value(&file)?, &folder).with_context(|| self.name())?;
        }
        let scene = file.scene(&self.folder()).with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        Ok(scene)
    }

    /// A scene of Mitsuba, with every change made to the scene file that it becomes.
    fn load_imported(&self) -> anyhow::Result<Scene> {
        let imported = from_mitsuba(&self.scene, "scene", &[], self.confined)?;
        imported.notes.iter().try_for_each(|text| note(text))?;
        let folder = in_folder(&imported)?;
        let file = self.changed(&imported.scene.to_toml()?)?;
        if self.confined {
            check_confined(&value(&file)?, folder.path()).with_context(|| self.name())?;
        }
        let scene = file.scene(folder.path()).with_context(|| self.name())?;
        check_end(&scene).with_context(|| self.name())?;
        Ok(scene)
    }

    /// The folder that file names in the scene are relative to.
    fn folder(&self) -> PathBuf {
        self.scene.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// The scene file with every change made.
    pub fn resolve(&self) -> anyhow::Result<SceneFile> {
        match BUILTIN.iter().find(|b| Path::new(b.name) == self.scene) {
            Some(builtin) => self.resolve_builtin(builtin),
            None => self.resolve_file(),
        }
    }

    fn resolve_builtin(&self, builtin: &Builtin) -> anyhow::Result<SceneFile> {
        let mut text = builtin.defaults.to_string();
        let mut table: toml::Table = toml::from_str(&text).context("built-in defaults")?;
        for set in &self.sets {
            let (key, value) = split(set)?;
            if !table.contains_key(key) {
                bail!(
                    "--set {set}: {}",
                    unknown("key", key, &table.keys().map(String::as_str).collect::<Vec<_>>())
                );
            }
            table.insert(key.to_string(), value);
            text = toml::to_string(&table)?;
            let checked = (builtin.resolve)(&text).map_err(|e| anyhow!("--set {set}: {}", say(&text, &e)))?;
            checked.with_context(|| format!("--set {set}"))?;
        }
        let file = (builtin.resolve)(&text).map_err(|e| anyhow!(say(&text, &e)))?;
        Ok(file?)
    }

    fn resolve_file(&self) -> anyhow::Result<SceneFile> {
        let path = &self.scene;
        let is_bare_name = !path.exists() && path.extension().is_none();
        if is_bare_name {
            bail!("no such scene: {}", unknown_scene(&self.name()));
        }
        // A scene may come through a pipe.
        let text = read_stream(path, MOST_BYTES)
            .and_then(text)
            .with_context(|| format!("cannot read {}", self.name()))?;
        let what = || format!("a scene file of {} bytes", text.len());
        turbid::memory::check(what, IN_MEMORY * text.len() as f64).with_context(|| self.name())?;
        self.changed(&text)
    }

    /// The scene file of a text, with every change made.
    fn changed(&self, text: &str) -> anyhow::Result<SceneFile> {
        let mut file = SceneFile::from_toml(text).map_err(|e| anyhow!(located(&self.name(), text, &e)))?;
        let mut root = toml::Value::Table(toml::from_str(text)?);
        check_lengths(&root, &file).with_context(|| self.name())?;
        if self.sets.is_empty() {
            return Ok(file);
        }
        for set in &self.sets {
            let (key, value) = split(set)?;
            *slot(&mut root, key).with_context(|| format!("--set {set}"))? = value;
            let changed = toml::to_string(&root)?;
            file =
                SceneFile::from_toml(&changed).map_err(|e| anyhow!("--set {set}: {}", say(&changed, &e)))?;
            check_lengths(&root, &file).with_context(|| format!("--set {set}"))?;
        }
        Ok(file)
    }
}

/// A scene file as keys and values.
fn value(file: &SceneFile) -> anyhow::Result<toml::Value> {
    Ok(toml::Value::Table(toml::from_str(&file.to_toml()?)?))
}

/// Refuses names of files, the values of all keys `file`, that lead out of a folder.
fn check_confined(value: &toml::Value, folder: &Path) -> anyhow::Result<()> {
    match value {
        toml::Value::Table(table) => table.iter().try_for_each(|(key, value)| match value {
            toml::Value::String(name) if key == "file" => check_inside(name, folder),
            other => check_confined(other, folder),
        }),
        toml::Value::Array(values) => values.iter().try_for_each(|value| check_confined(value, folder)),
        _ => Ok(()),
    }
}

fn check_inside(name: &str, folder: &Path) -> anyhow::Result<()> {
    if !is_inside(name, folder) {
        bail!("file {name:?} is outside of the scene's folder; allowed with --confined: files in it");
    }
    Ok(())
}

/// Refuses lists of numbers of which only the first ones were read, as `position = [0, 0, 0, 1]`.
fn check_lengths(given: &toml::Value, file: &SceneFile) -> anyhow::Result<()> {
    read_whole(given, value(file).ok().as_ref(), "")
}

/// Whether a value was read to its end; what was read is none where it is a default.
fn read_whole(given: &toml::Value, read: Option<&toml::Value>, key: &str) -> anyhow::Result<()> {
    let inner = |part: &str| if key.is_empty() { part.to_string() } else { format!("{key}.{part}") };
    match given {
        toml::Value::Table(table) => table
            .iter()
            .try_for_each(|(part, value)| read_whole(value, read.and_then(|r| r.get(part)), &inner(part))),
        toml::Value::Array(list) => {
            // Three equal channels are written as one number, and what is a default is not written: points, spectra.
            let most = read.and_then(toml::Value::as_array).map_or(3, Vec::len);
            if list.len() > most {
                bail!("{key} has {} entries; allowed: {most}", list.len());
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
fn split(set: &str) -> anyhow::Result<(&str, toml::Value)> {
    let Some((key, value)) = set.split_once('=') else { bail!("--set {set}: allowed: KEY=VALUE") };
    let (key, value) = (key.trim(), value.trim());
    let parsed =
        toml::from_str::<toml::Table>(&format!("value = {value}")).ok().and_then(|mut t| t.remove("value"));
    let is_number_like = value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    match parsed {
        Some(parsed) => Ok((key, parsed)),
        None if is_number_like => match value.parse::<f64>() {
            // TOML wants digits on both sides of the point, and no more range than f64 has.
            Ok(number) if number.is_finite() => Ok((key, toml::Value::Float(number))),
            _ => bail!("--set {set}: {key} is {value}; allowed: a number that fits 64 bits"),
        },
        None => Ok((key, toml::Value::String(value.to_string()))),
    }
}

/// The place of a dotted key, where numbers count list entries from 0. Only the last part may be new.
fn slot<'a>(place: &'a mut toml::Value, key: &str) -> anyhow::Result<&'a mut toml::Value> {
    let (part, rest) = key.split_once('.').map_or((key, None), |(part, rest)| (part, Some(rest)));
    let inner = match place {
        toml::Value::Table(table) => {
            if rest.is_some() && !table.contains_key(part) {
                bail!("{}", unknown("key", part, &table.keys().map(String::as_str).collect::<Vec<_>>()));
            }
            // A new key gets its value at once, from the caller.
            table.entry(part).or_insert(toml::Value::Boolean(false))
        }
        toml::Value::Array(list) => {
            let count = list.len();
            let found = part.parse::<usize>().ok().and_then(|i| list.get_mut(i));
            found.ok_or_else(|| anyhow!("`{part}` is no entry of a list of {count}, counted from 0"))?
        }
        other => bail!("`{part}` is inside `{other}`, which has no parts"),
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
