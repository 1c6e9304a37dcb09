//! Scenes from Python: a dict, TOML text, a file, or the name of a built-in one.

use crate::error::{refuse, refused};
use pyo3::exceptions::{PyTypeError, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use turbid::exchange::{Opened, open};
use turbid::photons::check_end;
use turbid::scene::{BUILTIN, Scene, SceneFile, SceneSource};

/// Dicts and lists in each other, at most: one that holds itself has no end.
const DEEPEST: u32 = 32;

/// A scene as it was given.
pub struct Given {
    opened: Opened,
    /// What messages call it; none for a dict or a text.
    name: Option<String>,
}

impl Given {
    /// Reads what was given.
    pub fn read(
        scene: &Bound<'_, PyAny>,
        changes: Option<&Bound<'_, PyDict>>,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        let changes = changes.map_or(Ok(toml::Table::new()), |changes| table(changes, 0))?;
        let with = |source: PathBuf| {
            let with =
                |source: SceneSource, (key, value): (&String, &toml::Value)| source.with(key, value.clone());
            changes.iter().fold(SceneSource::new(source), with)
        };
        let told = |error: turbid::Error| refuse(error.to_string());
        if let Ok(dict) = scene.cast::<PyDict>() {
            let text = toml::to_string(&table(dict, 0)?).map_err(|error| refuse(error.to_string()))?;
            // Lines of a text that nobody wrote by hand say nothing.
            SceneFile::read(&text, None).map_err(told)?;
            let file = with(PathBuf::from("scene")).changed(&text).map_err(told)?;
            return Ok(Given { opened: Opened::new(file, folder.unwrap_or_default()), name: None });
        }
        let word = scene.cast::<PyString>().ok().map(|word| word.to_string());
        if let Some(text) = word.filter(|word| is_text(word)) {
            let file = with(PathBuf::from("scene")).changed(&text).map_err(told)?;
            return Ok(Given { opened: Opened::new(file, folder.unwrap_or_default()), name: None });
        }
        let mut path: PathBuf = scene.extract().map_err(|_| {
            PyTypeError::new_err(
                "a scene is a dict, TOML text, the path of a scene file, or a built-in scene's name",
            )
        })?;
        if SceneSource::new(&path).is_standard_input() {
            // Python's own standard input is not for us to read.
            path = Path::new(".").join(path);
        }
        let source = with(path);
        let mut opened = open(&source, false).map_err(told)?;
        if let Some(folder) = folder {
            if opened.is_temporary() {
                return Err(refuse("folder says nothing to a scene of Mitsuba; allowed: without it"));
            }
            opened.folder = folder;
        }
        for note in &opened.notes {
            let text = CString::new(note.as_str()).unwrap_or_default();
            PyErr::warn(scene.py(), &scene.py().get_type::<PyUserWarning>(), &text, 2)?;
        }
        Ok(Given { opened, name: Some(source.name()) })
    }

    /// The validated scene, in which light comes to an end.
    pub fn scene(&self) -> PyResult<Scene> {
        let scene = self.opened.scene().and_then(|scene| check_end(&scene).map(|()| scene));
        scene.map_err(|error| refused(&self.named(error.into())))
    }

    /// An error under the scene's name.
    pub fn named(&self, error: anyhow::Error) -> anyhow::Error {
        match &self.name {
            Some(name) => error.context(name.clone()),
            None => error,
        }
    }
}

/// Whether a word is TOML text, not a name.
pub fn is_text(word: &str) -> bool {
    word.contains(['\n', '='])
}

/// A dict as a table of TOML.
pub fn table(dict: &Bound<'_, PyDict>, depth: u32) -> PyResult<toml::Table> {
    let mut table = toml::Table::new();
    for (key, value) in dict {
        let Ok(key) = key.cast::<PyString>().map(|key| key.to_string()) else {
            return Err(refuse(format!("the key {key} is not text")));
        };
        let value = value_of(&value, depth + 1).map_err(|error| {
            match error.is_instance_of::<crate::error::Error>(dict.py()) {
                true => refuse(format!("{key}: {}", error.value(dict.py()))),
                false => error,
            }
        })?;
        table.insert(key, value);
    }
    Ok(table)
}

/// A value of a dict: numbers, words, lists, dicts, arrays of NumPy, names of files.
fn value_of(value: &Bound<'_, PyAny>, depth: u32) -> PyResult<toml::Value> {
    if depth > DEEPEST {
        return Err(refuse(format!("dicts and lists deeper than {DEEPEST}")));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return table(dict, depth).map(toml::Value::Table);
    }
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(toml::Value::Boolean(truth.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(toml::Value::String(text.to_string()));
    }
    if value.is_instance_of::<PyInt>() {
        let number = value
            .extract::<i64>()
            .map_err(|_| refuse(format!("{value}: allowed: a number that fits 64 bits")))?;
        return Ok(toml::Value::Integer(number));
    }
    if value.is_instance_of::<PyFloat>() {
        return value.extract().map(toml::Value::Float);
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let list: PyResult<Vec<_>> = value.try_iter()?.map(|entry| value_of(&entry?, depth + 1)).collect();
        return list.map(toml::Value::Array);
    }
    // Arrays and numbers of NumPy.
    if let Ok(plain) = value.call_method0("tolist") {
        // Numbers wider than those of Python stay what they are.
        if plain.get_type().is(value.get_type()) {
            return value.extract().map(toml::Value::Float);
        }
        return value_of(&plain, depth + 1);
    }
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok(toml::Value::String(path.display().to_string()));
    }
    Err(refuse(format!(
        "a value of type {}; allowed: numbers, text, lists, dicts, arrays",
        value.get_type().name()?
    )))
}

/// A value of TOML as Python has it; names of files as seen from here.
fn object<'py>(
    py: Python<'py>,
    value: &toml::Value,
    folder: &Path,
    key: &str,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        toml::Value::String(text) if key == "file" => {
            PyString::new(py, &folder.join(text).display().to_string()).into_any()
        }
        toml::Value::String(text) => PyString::new(py, text).into_any(),
        toml::Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        toml::Value::Float(number) => PyFloat::new(py, *number).into_any(),
        toml::Value::Boolean(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        toml::Value::Datetime(date) => PyString::new(py, &date.to_string()).into_any(),
        toml::Value::Array(list) => {
            let all: PyResult<Vec<_>> = list.iter().map(|entry| object(py, entry, folder, "")).collect();
            PyList::new(py, all?)?.into_any()
        }
        toml::Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, object(py, value, folder, key)?)?;
            }
            dict.into_any()
        }
    })
}

/// A scene as a dict, valid and complete.
#[pyfunction]
#[pyo3(signature = (scene, parameters=None, folder=None))]
pub fn resolve<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    parameters: Option<&Bound<'py, PyDict>>,
    folder: Option<PathBuf>,
) -> PyResult<Bound<'py, PyAny>> {
    let given = Given::read(scene, parameters, folder)?;
    given.scene()?;
    let Opened { file, folder, .. } = &given.opened;
    if given.opened.is_temporary() && file.files().is_ok_and(|files| !files.is_empty()) {
        return Err(refused(&given.named(anyhow::anyhow!(
            "a scene of Mitsuba with files beside it; allowed here: the scene file that `turbid import` writes"
        ))));
    }
    let text = file.to_toml().map_err(|error| refuse(error.to_string()))?;
    let table: toml::Table = toml::from_str(&text).map_err(|error| refuse(error.to_string()))?;
    object(py, &toml::Value::Table(table), folder, "")
}

/// The built-in scenes: name, what it is, its parameters with their defaults and meanings as TOML.
#[pyfunction]
pub fn builtin() -> Vec<(&'static str, &'static str, &'static str)> {
    BUILTIN.iter().map(|builtin| (builtin.name, builtin.about, builtin.defaults)).collect()
}
