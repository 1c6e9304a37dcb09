//! Tells the program which compiler made it, for the record of where results come from.

use std::process::Command;

fn main() -> std::io::Result<()> {
    let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_string());
    let output = Command::new(compiler).arg("--version").output()?;
    let version = String::from_utf8_lossy(&output.stdout);
    let mut out = std::io::stdout().lock();
    std::io::Write::write_all(
        &mut out,
        format!("cargo::rustc-env=TURBID_RUSTC={}\n", version.trim()).as_bytes(),
    )?;
    std::io::Write::write_all(&mut out, b"cargo::rerun-if-changed=build.rs\n")
}
