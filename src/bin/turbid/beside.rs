//! Files that belong together: a scene, and what stands beside it.

use super::shared::print;
use anyhow::bail;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use turbid::exchange::Beside;
use turbid::output::{check_writable, is_same_file, write_atomically};

/// Folder and stem of a file that others are to stand beside, where its name ends in one of these.
pub fn folder_and_stem<'a>(
    flag: &str,
    path: &'a Path,
    extension: &str,
) -> anyhow::Result<(PathBuf, &'a str)> {
    let ends = path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    match path.file_stem().and_then(|stem| stem.to_str()) {
        Some(stem) if ends => Ok((path.parent().map(Path::to_path_buf).unwrap_or_default(), stem)),
        _ => bail!("{flag} is {}; allowed: a file name that ends in .{extension}", path.display()),
    }
}

/// Refuses an output over one of the files that were read.
pub fn refuse_read(option: &str, output: &Path, read: &[PathBuf]) -> anyhow::Result<()> {
    match read.iter().find(|file| is_same_file(file, output).unwrap_or(false)) {
        None => Ok(()),
        Some(file) if file.as_path() == output => {
            bail!("{option} names a file of the scene, {}; allowed: another", output.display())
        }
        Some(file) => bail!(
            "{option} names {}, which is {}, a file of the scene; allowed: another",
            output.display(),
            file.display()
        ),
    }
}

/// Writes a file and those beside it, which it names, before it, but over none of those that were read; says what was written.
pub fn write_beside(
    (option, path, text): (&str, &Path, &str),
    (folder, files): (&Path, &[Beside]),
    read: &[PathBuf],
) -> anyhow::Result<()> {
    let mut written = String::new();
    let paths: Vec<PathBuf> = files.iter().map(|file| folder.join(&file.name)).collect();
    for output in paths.iter().map(PathBuf::as_path).chain([path]) {
        refuse_read(option, output, read)?;
    }
    paths.iter().map(PathBuf::as_path).chain([path]).try_for_each(check_writable)?;
    for (file, beside) in files.iter().zip(&paths) {
        write_atomically(beside, |out| out.write_all(&file.bytes))?;
        writeln!(written, "wrote {}", beside.display())?;
    }
    write_atomically(path, |out| out.write_all(text.as_bytes()))?;
    writeln!(written, "wrote {}", path.display())?;
    print(&written)
}
