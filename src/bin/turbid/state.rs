//! The file that a progressive picture is resumed from: means and variances of its maps so far, and what they were made from.

use anyhow::{Context, bail};
use std::fs;
use std::path::Path;
use turbid::output::write_atomically;
use turbid::sensor::Film;

/// How the file begins, up to the end of the line.
const MAGIC: &str = "turbid progressive 1";

/// The most that the first two lines take: a scene may have thousands of bodies.
const HEADER_BYTES: u64 = 100_000_000;

/// What a pilot finds, by keys.
pub const FOUND: [&str; 2] = ["photons emitted", "first radii"];

/// The longest value that is told where two differ.
const TOLD: usize = 200;

/// The mean of the maps so far.
pub struct State {
    /// A sample of each pixel is a map.
    pub film: Film,
}

impl State {
    /// Nothing yet.
    pub fn new(width: u32, height: u32) -> Self {
        State { film: Film::new(width, height) }
    }

    /// Reads what an earlier run has written, if it was made from the same.
    pub fn read(
        file: &Path,
        (width, height): (u32, u32),
        made_from: &serde_json::Value,
    ) -> anyhow::Result<Self> {
        let named = || format!("--state {}", file.display());
        // A line, a line of JSON, the numbers.
        let data = fs::metadata(file).with_context(named)?;
        let most = Film::byte_count(width, height) + HEADER_BYTES;
        if !data.is_file() || data.len() > most {
            bail!(
                "{}: not a state of {width} x {height} pixels, which is a file of at most {most} bytes; allowed: another name, or such \
                 a file",
                named()
            );
        }
        let bytes = fs::read(file).with_context(named)?;
        let mut parts = bytes.splitn(3, |byte| *byte == b'\n');
        let (magic, header, numbers) = (parts.next(), parts.next(), parts.next());
        let (Some(header), Some(numbers), true) = (header, numbers, magic == Some(MAGIC.as_bytes())) else {
            bail!(
                "{}: not a state that --progressive has written; allowed: another name, or such a file",
                named()
            );
        };
        let header: serde_json::Value = serde_json::from_slice(header).map_err(|_| {
            anyhow::anyhow!("{}: line 2 is not JSON: the file is damaged; begin anew", named())
        })?;
        if let Some(key) = differing(&header, made_from) {
            let told = |of: &serde_json::Value| {
                let told = of.get(key).map_or_else(|| "nothing".to_string(), ToString::to_string);
                if told.len() > TOLD { String::new() } else { told }
            };
            let (was, is) = (told(&header), told(made_from));
            let both =
                if was.is_empty() || is.is_empty() { String::new() } else { format!(": {was}, now {is}") };
            bail!(
                "{}: was made from another {key}{both}; allowed: the same scene, size and settings as before, or another name",
                named()
            );
        }
        let film = Film::from_bytes(width, height, numbers);
        let Some(film) = film else {
            bail!(
                "{}: its numbers are not those of {width} x {height} pixels: the file is damaged; begin anew",
                named()
            );
        };
        Ok(State { film })
    }

    /// Writes it.
    pub fn write(&self, file: &Path, made_from: &serde_json::Value) -> anyhow::Result<()> {
        write_atomically(file, |out| {
            writeln!(out, "{MAGIC}\n{made_from}")?;
            out.write_all(&self.film.to_bytes())
        })?;
        Ok(())
    }
}

/// The first key in which two settings differ.
fn differing<'a>(a: &'a serde_json::Value, b: &'a serde_json::Value) -> Option<&'a str> {
    let (Some(a), Some(b)) = (a.as_object(), b.as_object()) else { return Some("program") };
    let differing = |key: &&String| a.get(*key) != b.get(*key);
    // What follows from others is told last.
    let is_found = |key: &&String| FOUND.contains(&key.as_str());
    let mut keys: Vec<&String> = a.keys().chain(b.keys()).filter(differing).collect();
    keys.sort_by_key(is_found);
    keys.first().map(|key| key.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_setting_that_differs_is_named() {
        let a = json!({ "seed": 1, "width": 8 });
        assert_eq!(differing(&a, &a), None);
        assert_eq!(differing(&a, &json!({ "seed": 1, "width": 9 })), Some("width"));
        assert_eq!(differing(&a, &json!({ "seed": 1 })), Some("width"));
        let b = json!({ "first radii": 2, "seed": 2, "width": 8 });
        assert_eq!(differing(&b, &a), Some("seed"));
        assert_eq!(differing(&json!(3), &a), Some("program"));
    }
}
