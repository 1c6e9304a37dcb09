//! A scene as text, with the files that it names.

use crate::harness::say;
use anyhow::{Context, ensure};
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Table, Value};
use turbid::exchange::open;
use turbid::input::{read, read_text};
use turbid::output::write_atomically;
use turbid::scene::{Scene, SceneFile, SceneSource};

/// Larger files of a scene are refused.
const MOST_BYTES: u64 = 1 << 28;

/// A scene file before it is read, and what stands beside it: meshes, grids, tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneText {
    /// The scene file.
    pub table: Table,
    /// Other files by name.
    pub files: BTreeMap<String, Vec<u8>>,
}

impl SceneText {
    /// A scene of one's own ([`open`]), and the files beside it that it names.
    ///
    /// # Errors
    /// what is no scene, or has no camera, with file and line; files that cannot be read
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        // A device would be read up to its end.
        read_text(path, MOST_BYTES).with_context(|| format!("cannot read {}", path.display()))?;
        let source = SceneSource::new(path);
        let opened = open(&source, false)?;
        opened.notes.iter().for_each(|note| say(&format!("{}: {note}", source.name())));
        let scene = opened.scene().map_err(|error| error.within(&source.name()))?;
        ensure!(
            scene.camera().is_some(),
            "{}: the scene has no camera; allowed: one with [camera]",
            source.name()
        );
        let table: Table = toml::from_str(&opened.file.to_toml()?)?;
        let (mut files, mut names) = (BTreeMap::new(), Vec::new());
        named_files(&Value::Table(table.clone()), &mut names);
        for name in names {
            let path = opened.folder.join(&name);
            let bytes = read(&path, MOST_BYTES).with_context(|| format!("cannot read {}", path.display()))?;
            files.insert(name, bytes);
        }
        Ok(SceneText { table, files })
    }

    /// The scene file as text.
    pub fn toml(&self) -> String {
        toml::to_string(&self.table).unwrap_or_default()
    }

    /// Writes the scene as `name` and its files beside it.
    ///
    /// # Errors
    /// where a file cannot be written
    pub fn write(&self, folder: &Path, name: &str) -> anyhow::Result<()> {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        for (file, bytes) in &self.files {
            write_atomically(folder.join(file), |out| out.write_all(bytes))?;
        }
        write_atomically(folder.join(name), |out| out.write_all(self.toml().as_bytes()))?;
        Ok(())
    }

    /// The validated scene.
    ///
    /// # Errors
    /// what the scene is refused for
    pub fn scene(&self) -> anyhow::Result<Scene> {
        let file = SceneFile::from_toml(&self.toml())?;
        if self.files.is_empty() {
            return Ok(file.scene(Path::new("."))?);
        }
        let folder = tempfile::tempdir()?;
        for (name, bytes) in &self.files {
            std::fs::write(folder.path().join(name), bytes)?;
        }
        Ok(file.scene(folder.path())?)
    }

    /// The parts of a kind: `objects`, `regions`, `interiors`, `lights`.
    pub fn parts(&self, kind: &str) -> &[Value] {
        self.table.get(kind).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// The same, to be changed.
    pub fn parts_mut(&mut self, kind: &str) -> &mut Vec<Value> {
        let entry = self.table.entry(kind).or_insert_with(|| Value::Array(Vec::new()));
        if !entry.is_array() {
            *entry = Value::Array(Vec::new());
        }
        match entry {
            Value::Array(parts) => parts,
            _ => unreachable!("an array was put there"),
        }
    }

    /// Leaves out the files that nothing names any more.
    pub fn without_unused(mut self) -> Self {
        let mut names = Vec::new();
        named_files(&Value::Table(self.table.clone()), &mut names);
        self.files.retain(|name, _| names.contains(name));
        self.table.retain(|_, part| part.as_array().is_none_or(|parts| !parts.is_empty()));
        self
    }
}

/// Every value of a key `file`.
fn named_files(value: &Value, names: &mut Vec<String>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                match value {
                    Value::String(name) if key == "file" => names.push(name.clone()),
                    other => named_files(other, names),
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| named_files(value, names)),
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => {}
    }
}

/// A table of these keys.
pub fn table<const N: usize>(entries: [(&str, Value); N]) -> Value {
    Value::Table(entries.into_iter().map(|(key, value)| (key.to_string(), value)).collect())
}

/// The only key of a table, and what stands there: a choice of the scene file.
pub fn choice(value: &Value) -> Option<(&str, &Value)> {
    let mut entries = value.as_table()?.iter();
    let (key, value) = entries.next()?;
    entries.next().is_none().then_some((key.as_str(), value))
}

/// A number, whole or not.
pub fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

/// Three numbers.
pub fn point(value: &Value) -> Option<[f64; 3]> {
    let all: Vec<f64> = value.as_array()?.iter().map(number).collect::<Option<_>>()?;
    all.try_into().ok()
}

/// Numbers as a value.
pub fn array(numbers: &[f64]) -> Value {
    Value::Array(numbers.iter().map(|x| Value::Float(*x)).collect())
}
