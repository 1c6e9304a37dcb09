//! The command `turbid`: what it prints, and how it refuses: exit code 2, one line on stderr, nothing on stdout.
#![allow(clippy::unwrap_used, reason = "tests")]

mod arrays;
mod bad_files;
mod bad_input;
mod bad_pictures;
mod bins;
mod compare;
mod exchange;
mod inputs;
mod media;
mod memory;
mod options;
mod output;
mod photons;
mod pictures;
mod progressive;
mod provenance;
mod reference;

use assert_cmd::Command;
use std::path::{Path, PathBuf};

/// A table, and a pane of glass above it, under a small sun: photons know directions to look in that connections do not find.
const BELOW_A_PANE: &str = r#"interiors = [{ name = "glass", index = 1.5 }]
[camera]
position = [0.6, -0.5, 0.5]
look_at = [0.0, -1.0, 0.0]
fov = 40
width = 8
height = 8
[[objects]]
shape = { rectangle = { corner = [-1, -1, 1], u = [2, 0, 0], v = [0, 0, -2] } }
surface = { lambertian = { reflectance = 0.5 } }
[[objects]]
shape = { cuboid = { min = [-1.5, -0.1, -1.5], max = [1.5, 0.1, 1.5] } }
surface = { dielectric = { inside = "glass" } }
[[lights]]
sun = { dir = [0.2, -1, 0.3], irradiance = 1, angular_radius = 3 }
[[sensors]]
name = "table"
measure = { radiance = { origin = [0.6, -0.5, 0.5], dir = [-0.58, -0.5, -0.47] } }
"#;

/// A slab, looked into and with a place inside.
const RAYS: &str = r#"cell = 4.0
[[regions]]
shape = { slab = { top = 0.0, thickness = 2.0 } }
sigma_t = 1.0
albedo = 0.9
g = 0.0
[[lights]]
beam = { dir = [0, 0, 1], irradiance = 1.0, section = 'unbounded' }
[[sensors]]
name = 'back'
measure = { radiance = { origin = [0.5, 0.5, -1.0], dir = [0, 0, 1] } }
[[sensors]]
name = 'inside'
measure = { fluence = [[0.5, 0.5, 1.0]] }
"#;

/// The command, ready to run.
fn turbid(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("turbid").unwrap();
    command.args(arguments);
    command
}

/// Standard output of a run that must succeed in silence on stderr.
fn succeeds(arguments: &[&str]) -> String {
    let output = turbid(arguments).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

/// A run that must be refused: the one line that it says.
fn refuses(arguments: &[&str]) -> String {
    let output = turbid(arguments).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    // On a busy machine a run may tell of its progress, or of the time that it will take.
    let is_of_time = |line: &&str| line.ends_with(" left") || line.ends_with("by a pilot");
    let stderr: String =
        told.lines().filter(|line| !is_of_time(line)).map(|line| format!("{line}\n")).collect();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?} wrote to stdout");
    assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
    assert!(stderr.starts_with("turbid: error: ") && stderr.ends_with('\n'), "{stderr}");
    stderr.trim_end().to_string()
}

/// A refusal that names all these things.
fn refuses_naming(arguments: &[&str], words: &[&str]) {
    let line = refuses(arguments);
    for word in words {
        assert!(line.contains(word), "{arguments:?}: `{word}` is missing in: {line}");
    }
}

/// A folder of scene files for one test.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// A grid of eight equal densities in the unit cube.
    fn grid(&self, name: &str, density: f32) {
        let mut bytes = b"VOL\x03".to_vec();
        [1i32, 2, 2, 2, 1].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        (0..8).for_each(|_| bytes.extend(density.to_le_bytes()));
        std::fs::write(self.0.path().join(name), bytes).unwrap();
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
