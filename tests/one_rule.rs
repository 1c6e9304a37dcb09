//! The one rule: player and referee do not know each other; and inside the player, imports point downwards only.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of src/ from the bottom up; those in one row may know each other. A new room is named here, in its place.
const ORDER: [&[&str]; 16] = [
    &["faults"],
    &["error"],
    &["input", "memory"],
    &["math"],
    &["spectrum"],
    &["rng"],
    &["stats"],
    &["phase", "medium", "surface", "light", "geometry"],
    &["scene"],
    &["exchange"],
    &["transport"],
    &["photons"],
    &["estimators"],
    &["integrators"],
    &["sensor"],
    &["output"],
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Rust sources under a folder, each with its text without line comments.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "target") {
                found.extend(sources(&path));
            }
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let code: Vec<&str> = text.lines().map(|l| l.split("//").next().unwrap_or_default()).collect();
            found.push((path, code.join("\n")));
        }
    }
    found.sort();
    found
}

/// Whether code names a crate: as a whole word before `::` or after `use`.
fn names(code: &str, crate_name: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(crate_name).any(|(at, _)| {
        let (before, after) = (&code[..at], &code[at + crate_name.len()..]);
        !before.ends_with(is_word)
            && !after.starts_with(is_word)
            && (after.starts_with("::") || before.ends_with("use "))
    })
}

fn dependencies(manifest: &Path) -> Vec<String> {
    let manifest: toml::Table = toml::from_str(&fs::read_to_string(manifest).unwrap()).unwrap();
    let tables = ["dependencies", "dev-dependencies", "build-dependencies"];
    let keys = tables.iter().filter_map(|t| manifest.get(*t)?.as_table()).flat_map(|t| t.keys().cloned());
    keys.collect()
}

fn assert_unnamed(folder: &Path, crate_name: &str) {
    let sources = sources(folder);
    assert!(!sources.is_empty(), "{}", folder.display());
    for (path, code) in sources {
        assert!(!names(&code, crate_name), "{} names {crate_name}", path.display());
    }
}

#[test]
fn the_player_does_not_know_the_referee() {
    assert_unnamed(&root().join("src"), "turbid_analytic");
    let manifest: toml::Table =
        toml::from_str(&fs::read_to_string(root().join("Cargo.toml")).unwrap()).unwrap();
    assert!(manifest["dependencies"].get("turbid-analytic").is_none());
    assert!(manifest["dev-dependencies"].get("turbid-analytic").is_some());
}

#[test]
fn the_referee_does_not_know_the_player() {
    let folder = root().join("analytic");
    assert_unnamed(&folder, "turbid");
    for manifest in ["Cargo.toml", "exact/Cargo.toml"] {
        assert!(!dependencies(&folder.join(manifest)).contains(&"turbid".to_string()));
    }
}

#[test]
fn the_figures_know_neither() {
    let folder = root().join("experiments/figure");
    for (crate_name, package) in [("turbid", "turbid"), ("turbid_analytic", "turbid-analytic")] {
        assert_unnamed(&folder, crate_name);
        assert!(!dependencies(&folder.join("Cargo.toml")).contains(&package.to_string()));
    }
}

fn height(room: &str) -> Option<usize> {
    ORDER.iter().position(|row| row.contains(&room))
}

/// The rooms that code names as `crate::room`, also within braces; items that the crate's root hands on by their room.
fn rooms_named(code: &str) -> Vec<String> {
    let mut rooms = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let inner = rest.strip_prefix('{').map_or(rest, |r| r.split('}').next().unwrap_or(r));
        let parts: Vec<&str> = if rest.starts_with('{') { inner.split(',').collect() } else { vec![inner] };
        for part in parts {
            let name: String = part.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            rooms.push(match name.as_str() {
                "Spectrum" => "spectrum".to_string(),
                "Error" | "Result" => "error".to_string(),
                other => other.to_string(),
            });
        }
    }
    rooms
}

/// Whether code reaches beyond its room by `super`, where [`rooms_named`] would not see it. One step up from a room's own
/// file is the crate, but for tests inside that file.
fn climbs(code: &str, is_room_itself: bool) -> bool {
    let is_step = |line: &str| line.contains("super::") && line != "    use super::*;";
    code.contains("super::super") || is_room_itself && code.lines().any(is_step)
}

#[test]
fn imports_point_downwards_only() {
    let folder = root().join("src");
    for (path, code) in sources(&folder) {
        let relative = path.strip_prefix(&folder).unwrap();
        let room = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_string();
        // The program is a crate of its own above the library.
        if room == "lib" || room == "bin" {
            continue;
        }
        let here = height(&room).unwrap_or_else(|| panic!("src/{room} has no place in ORDER"));
        for other in rooms_named(&code) {
            let there = height(&other)
                .unwrap_or_else(|| panic!("{}: crate::{other} has no place in ORDER", relative.display()));
            assert!(there <= here, "{} looks up to {other}", relative.display());
        }
        let depth = relative.iter().count();
        let is_room_itself = depth == 1 || depth == 2 && relative.ends_with("mod.rs");
        assert!(!climbs(&code, is_room_itself), "{} climbs with super", relative.display());
        for outer in ["clap", "anyhow", "indicatif"] {
            assert!(
                !names(&code, outer),
                "{} names {outer}, which the library does not know",
                relative.display()
            );
        }
    }
}

/// The test of the test: it would see an upward import, also in braces and in the middle of code.
#[test]
fn upward_imports_would_be_seen() {
    assert_eq!(rooms_named("use crate::{rng::Stream, scene};"), ["rng", "scene"]);
    assert_eq!(rooms_named("let x = crate::photons::Flags::NONE;"), ["photons"]);
    assert_eq!(rooms_named("use crate::Spectrum;"), ["spectrum"]);
    assert!(climbs("use super::super::scene;", false) && climbs("use super::scene;", true));
    assert!(!climbs("use super::record;", false) && !climbs("mod tests {\n    use super::*;\n}", true));
    assert!(height("photons") > height("transport") && height("nowhere").is_none());
    assert!(names("use turbid::rng;", "turbid") && names("turbid::math::exp(x)", "turbid"));
    assert!(!names("use turbid_figure::Plot; // turbid", "turbid") && !names("\"turbid: error\"", "turbid"));
}

/// Every dependency of the workspace says in a comment why it is there.
#[test]
fn every_dependency_has_its_reason() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let section = manifest.split("[workspace.dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
    let lines: Vec<&str> = section.lines().collect();
    let mut seen = 0;
    for (i, line) in lines.iter().enumerate() {
        let Some((name, _)) = line.split_once(" = ") else { continue };
        if line.starts_with('#') || name.starts_with("turbid") || name.contains(char::is_whitespace) {
            continue;
        }
        seen += 1;
        assert!(i > 0 && lines[i - 1].starts_with("# "), "{name} has no line of reason");
    }
    assert!(seen >= 20, "{seen}");
}
