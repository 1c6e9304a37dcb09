//! The file that a progressive picture is resumed from: means and variances of its maps so far, and what they were made from.

use super::digest::Digest;
use anyhow::{Context, bail};
use std::fs::{self, TryLockError};
use std::io::Read;
use std::path::Path;
use turbid::output::write_and_hold;
use turbid::sensor::Film;

/// How the file begins, up to the end of the line.
const MAGIC: &str = "turbid progressive 2";

/// The most that the first three lines take: a scene may have thousands of bodies.
const HEADER_BYTES: u64 = 100_000_000;

/// What a pilot finds, by keys.
pub const FOUND: [&str; 2] = ["photons emitted", "first radii"];

/// The longest value that is told where two differ.
const TOLD: usize = 200;

/// The mean of the maps so far.
pub struct State {
    /// A sample of each pixel is a map.
    pub film: Film,
    /// The file as it was read or written last, locked: no other run goes on from it meanwhile.
    held: Option<fs::File>,
}

impl State {
    /// Nothing yet.
    pub fn new(width: u32, height: u32) -> Self {
        State { film: Film::new(width, height), held: None }
    }

    /// Reads what an earlier run has written, if it was made from the same.
    pub fn read(
        file: &Path,
        (width, height): (u32, u32),
        made_from: &serde_json::Value,
    ) -> anyhow::Result<Self> {
        let named = || format!("--state {}", file.display());
        // A line, a line of JSON, a line with a digest of the second line and of the numbers, the numbers.
        let data = fs::metadata(file).with_context(named)?;
        let most = Film::byte_count(width, height) + HEADER_BYTES;
        if !data.is_file() || data.len() > most {
            bail!(
                "{}: not a state of {width} x {height} pixels, which is a file of at most {most} bytes; allowed: another name, or such \
                 a file",
                named()
            );
        }
        let mut held = fs::File::open(file).with_context(named)?;
        // Where there are no locks, nothing tells of other runs.
        let is_held = matches!(held.try_lock(), Err(TryLockError::WouldBlock));
        if is_held || !is_still_at(&held, file) {
            bail!(
                "{}: another run goes on from it; allowed: wait for that one's end, or another name",
                named()
            );
        }
        let mut bytes = Vec::new();
        held.read_to_end(&mut bytes).with_context(named)?;
        let mut parts = bytes.splitn(4, |byte| *byte == b'\n');
        let [magic, header, digest, numbers] = [(); 4].map(|()| parts.next());
        let (Some(text), Some(digest), Some(numbers), true) =
            (header, digest, numbers, magic == Some(MAGIC.as_bytes()))
        else {
            if bytes.starts_with(b"turbid progressive ") && magic != Some(MAGIC.as_bytes()) {
                bail!("{}: a state of another version of turbid; begin anew", named());
            }
            bail!(
                "{}: not a state that --progressive has written; allowed: another name, or such a file",
                named()
            );
        };
        let header: serde_json::Value = serde_json::from_slice(text).map_err(|_| {
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
                "{}: differs in {key}{both}; allowed: the same scene, size and settings as before, or another name",
                named()
            );
        }
        let film = Film::from_bytes(width, height, numbers)
            .filter(|_| digest == digest_of(text, numbers).as_bytes());
        let Some(film) = film else {
            bail!(
                "{}: its numbers are not those of {width} x {height} pixels: the file is damaged; begin anew",
                named()
            );
        };
        Ok(State { film, held: Some(held) })
    }

    /// Writes it, but not over what another run has written since this one began.
    pub fn write(&mut self, file: &Path, made_from: &serde_json::Value) -> anyhow::Result<()> {
        if self.held.is_none() && fs::metadata(file).is_ok_and(|found| found.is_file()) {
            bail!(
                "--state {}: another run has written it since this one began; allowed: another name, or to go on from it",
                file.display()
            );
        }
        self.held = write_and_hold(file, |out| {
            let (header, numbers) = (made_from.to_string(), self.film.to_bytes());
            writeln!(out, "{MAGIC}\n{header}\n{}", digest_of(header.as_bytes(), &numbers))?;
            out.write_all(&numbers)
        })?;
        Ok(())
    }
}

/// Whether an open file still has its name: another run may have put a new one there before this one was locked.
#[cfg(unix)]
fn is_still_at(open: &fs::File, name: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |found: std::io::Result<fs::Metadata>| found.ok().map(|found| (found.dev(), found.ino()));
    place(open.metadata()) == place(fs::metadata(name))
}

/// Elsewhere nothing tells.
#[cfg(not(unix))]
fn is_still_at(_open: &fs::File, _name: &Path) -> bool {
    true
}

/// What tells whether the header and the numbers are those that were written.
fn digest_of(header: &[u8], numbers: &[u8]) -> String {
    format!("{:016x}", Digest::EMPTY.with(header).with(numbers).number())
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

    /// One run at a time: what another one holds is not read, and what another one has written since is not written over.
    #[test]
    fn a_state_has_one_run() {
        let folder = tempfile::tempdir().unwrap();
        let (file, made_from) = (folder.path().join("a.state"), json!({ "seed": 1 }));
        let (mut first, mut second) = (State::new(2, 2), State::new(2, 2));
        let refused = |error: anyhow::Error, words: &str| {
            let said = format!("{error:#}");
            assert!(said.contains("a.state: another run") && said.contains(words), "{said}");
        };
        first.film.push_film(&Film::new(2, 2));
        first.write(&file, &made_from).unwrap();
        first.write(&file, &made_from).unwrap();
        let kept = fs::read(&file).unwrap();
        refused(second.write(&file, &made_from).unwrap_err(), "has written it");
        refused(State::read(&file, (2, 2), &made_from).err().unwrap(), "goes on from it");
        drop(first);
        let mut third = State::read(&file, (2, 2), &made_from).unwrap();
        refused(State::read(&file, (2, 2), &made_from).err().unwrap(), "goes on from it");
        assert_eq!(fs::read(&file).unwrap(), kept);
        third.write(&file, &made_from).unwrap();
    }
}
