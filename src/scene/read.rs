//! Scenes from text: what is wrong with them is said in one line.

use super::file::SceneFile;
use crate::error::{Error, Result};
use crate::input::{is_inside, line_and_column};
use std::ops::Range;
use std::path::Path;

impl SceneFile {
    /// A scene file from its text. What serde passes over is refused too: lists of numbers of which only the first ones are read.
    ///
    /// # Arguments
    /// `name` what messages call the text, before line and column; none for text that nobody wrote by hand
    ///
    /// # Errors
    /// `Error::Scene`: what is no TOML, or a key, a value or a length that is not allowed, with its place
    pub fn read(text: &str, name: Option<&str>) -> Result<Self> {
        let told = |error: &toml::de::Error| match name {
            Some(name) => located(name, text, error),
            None => toml_message(text, error),
        };
        let file = SceneFile::from_toml(text).map_err(|error| Error::Scene(told(&error)))?;
        let given: toml::Table = toml::from_str(text).map_err(|error| Error::Scene(told(&error)))?;
        let read = file.to_toml().ok().and_then(|text| toml::from_str::<toml::Table>(&text).ok());
        let read = read.map(toml::Value::Table);
        read_whole(&toml::Value::Table(given), read.as_ref(), "").map_err(|text| match name {
            Some(name) => Error::Scene(format!("{name}: {text}")),
            None => Error::Scene(text),
        })?;
        Ok(file)
    }

    /// Refuses a scene that names files, the values of all keys `file`, outside of a folder: by an absolute name, by `..`, or through
    /// a link.
    ///
    /// # Errors
    /// `Error::Scene` that names the file
    pub fn check_confined(&self, folder: &Path) -> Result<()> {
        match self.files()?.into_iter().find(|name| !is_inside(name, folder)) {
            None => Ok(()),
            Some(name) => Err(Error::Scene(format!(
                "file {name:?} is outside of the scene's folder; allowed with --confined: files in it"
            ))),
        }
    }

    /// The files that it names, the values of all keys `file`.
    ///
    /// # Errors
    /// `Error::Scene` if it cannot be written as text
    pub fn files(&self) -> Result<Vec<String>> {
        let text = self.to_toml().map_err(|error| Error::Scene(error.to_string()))?;
        let table: toml::Table = toml::from_str(&text).map_err(|error| Error::Scene(error.to_string()))?;
        let mut found = Vec::new();
        add_files(&toml::Value::Table(table), &mut found);
        Ok(found)
    }
}

fn add_files(value: &toml::Value, found: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, value)| match value {
            toml::Value::String(name) if key == "file" => found.push(name.clone()),
            other => add_files(other, found),
        }),
        toml::Value::Array(values) => values.iter().for_each(|value| add_files(value, found)),
        _ => {}
    }
}

/// Whether a value was read to its end; what was read is none where it is a default.
fn read_whole(given: &toml::Value, read: Option<&toml::Value>, key: &str) -> std::result::Result<(), String> {
    let inner = |part: &str| if key.is_empty() { part.to_string() } else { format!("{key}.{part}") };
    match given {
        toml::Value::Table(table) => table
            .iter()
            .try_for_each(|(part, value)| read_whole(value, read.and_then(|r| r.get(part)), &inner(part))),
        toml::Value::Array(list) => {
            // Three equal channels are written as one number, and what is a default is not written: points, spectra.
            let most = read.and_then(toml::Value::as_array).map_or(3, Vec::len);
            if list.len() > most {
                return Err(format!("{key} has {} entries; allowed: {most}", list.len()));
            }
            let entry = |i: usize| read.and_then(toml::Value::as_array).and_then(|r| r.get(i));
            list.iter()
                .enumerate()
                .try_for_each(|(i, value)| read_whole(value, entry(i), &inner(&i.to_string())))
        }
        _ => Ok(()),
    }
}

/// An unknown key or value, and the nearest known one.
pub(super) fn unknown(what: &str, key: &str, known: &[&str]) -> String {
    let nearest =
        known.iter().max_by(|a, b| strsim::jaro_winkler(a, key).total_cmp(&strsim::jaro_winkler(b, key)));
    let list = known.join(", ");
    match nearest {
        Some(name) => format!("unknown {what} `{key}`; nearest: `{name}`; allowed: {list}"),
        None => format!("unknown {what} `{key}`"),
    }
}

/// The error in one line with file, line and column.
fn located(file: &str, text: &str, error: &toml::de::Error) -> String {
    let start = error.span().map_or(0, |span| span.start).min(text.len());
    let (line, column) = line_and_column(text, start);
    format!("{file}:{line}:{column}: {}", toml_message(text, error))
}

/// The message of an error of TOML in one line, with the key in the place of "the value", and the nearest known key.
pub fn toml_message(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().replace('\n', " ");
    let message = of_another_type(&message).unwrap_or(message);
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

/// What is said of a value of another type, in words of scene files; none where something else is said.
fn of_another_type(message: &str) -> Option<String> {
    let (found, expected) = message.strip_prefix("invalid type: ")?.rsplit_once(", expected ")?;
    let in_words = |of: &str| match of {
        "f64" | "f32" => "a number",
        "i64" | "u64" | "u32" | "u16" | "u8" | "usize" => "a whole number",
        "sequence" | "a sequence" => "a list",
        "map" | "a map" => "a table",
        of if of.starts_with("struct ") => "a table",
        _ => "",
    };
    let said = |of: &str| if in_words(of).is_empty() { of.to_string() } else { in_words(of).to_string() };
    Some(format!("the value is {}; allowed: {}", said(found), said(expected)))
}

/// The key whose value stands at a place of the text: the last `key =` before it, on its line.
fn key_before(text: &str, span: Range<usize>) -> Option<&str> {
    let line = text.get(..span.start)?.rsplit('\n').next()?;
    let before = line.rsplit_once('=')?.0.trim_end();
    let start = before.rfind(|c: char| !(c.is_alphanumeric() || "_-.".contains(c))).map_or(0, |i| i + 1);
    (start < before.len()).then(|| &before[start..])
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOG: &str = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1.0 } }\nsigma_t = 1.0\n\
                       albedo = 0.5\n[[lights]]\npoint = { position = [0, 0, 0], power = 1.0 }\n";

    fn told(text: &str, name: Option<&str>) -> String {
        SceneFile::read(text, name).unwrap_err().to_string()
    }

    #[test]
    fn mistakes_have_a_place() {
        assert!(SceneFile::read(FOG, None).is_ok());
        let wrong = FOG.replace("albedo = 0.5", "albedo = 1.5");
        assert!(told(&wrong, Some("fog.toml")).starts_with("fog.toml:4:10: albedo is 1.5; allowed: "));
        assert!(told(&wrong, None).starts_with("albedo is 1.5; allowed: "));
        let wrong = told(&FOG.replace("sigma_t", "sigma_z"), Some("fog.toml"));
        assert!(wrong.contains("fog.toml:3:1: unknown key `sigma_z`; nearest: `sigma_"), "{wrong}");
        let wrong = told(&FOG.replace("[0, 0, 0], radius", "[0, 0, 0, 1], radius"), Some("fog.toml"));
        assert_eq!(wrong, "fog.toml: regions.0.shape.sphere.center has 4 entries; allowed: 3");
    }
}
