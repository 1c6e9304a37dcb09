//! The program `turbid`, which other packages' tests run.

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// When the newest file of a folder was written.
fn newest(folder: &Path) -> SystemTime {
    let time = |entry: std::fs::DirEntry| match entry.file_type().unwrap().is_dir() {
        true => newest(&entry.path()),
        false => entry.metadata().unwrap().modified().unwrap(),
    };
    std::fs::read_dir(folder).unwrap().map(|entry| time(entry.unwrap())).max().unwrap()
}

/// The program beside the tests; built if only this package's tests were asked for, and it is older than its source.
pub fn turbid() -> Command {
    let folder = std::env::current_exe().unwrap().ancestors().nth(2).unwrap().to_path_buf();
    let program = folder.join(format!("turbid{}", std::env::consts::EXE_SUFFIX));
    let written = std::fs::metadata(&program).and_then(|m| m.modified());
    if !written.is_ok_and(|written| written >= newest(&root().join("src"))) {
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "-p", "turbid", "--bin", "turbid"]).current_dir(root());
        build.args((!cfg!(debug_assertions)).then_some("--release")).assert().success();
    }
    Command::new(program)
}

/// The folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}
