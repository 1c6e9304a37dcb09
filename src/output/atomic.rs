//! Files that appear whole or not at all.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

/// A file that could not be written: which, and why.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file that was wanted.
    pub path: PathBuf,
    /// What stopped it: part of the message, and so no source of its own.
    pub cause: io::Error,
}

/// Writes a file through `write`, so that its path holds either the old content or all of the new.
///
/// The content goes to a temporary file in the same folder, is brought to the disk, and is then renamed. The
/// permissions are those of any new file (0o666 minus the mask). A symbolic link keeps pointing where it did, whether
/// something is there or not; a path that is no regular file, such as a device or a pipe, is written directly. A file that is
/// protected from writing is left.
///
/// What a killed run left in the folder, temporary files that no process holds, is removed.
///
/// # Errors
/// [`WriteError`] if the folder does not exist or cannot be written to, the disk is full, or `write` fails; the
/// old file is then untouched and nothing is left behind.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    write_and_hold(path, write).map(drop)
}

/// The same, and this process holds a lock on the new file, from before it has its name, for as long as what is returned lives. None of
/// what is no regular file, and none that counts where there are no locks.
///
/// # Errors
/// As [`write_atomically`]
pub fn write_and_hold(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Option<fs::File>, WriteError> {
    let path = path.as_ref();
    try_write(path, write).map_err(|cause| WriteError { path: path.to_path_buf(), cause: bare(cause) })
}

/// The system's own error, without the name of the temporary file in which it happened.
fn bare(error: io::Error) -> io::Error {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(&error);
    while let Some(inner) = cause {
        if let Some(code) = inner.downcast_ref::<io::Error>().and_then(io::Error::raw_os_error) {
            return io::Error::from_raw_os_error(code);
        }
        cause = inner.source();
    }
    error
}

/// Where a path leads to through symbolic links, the last of which may lead to nothing.
///
/// # Errors
/// For links that lead back to themselves
fn target(path: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: usize = 40;
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        // An error here is that of a file that is no link, or not there.
        let Ok(goal) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().map_or_else(|| goal.clone(), |folder| folder.join(&goal));
    }
    Err(io::Error::other("a link that leads back to itself"))
}

/// Whether two paths lead to one file.
///
/// # Errors
/// For links that lead back to themselves
pub fn is_same_file(a: &Path, b: &Path) -> io::Result<bool> {
    let whole = |path: &Path| -> io::Result<(PathBuf, Option<std::ffi::OsString>)> {
        let target = target(path)?;
        let folder = folder_of(&target);
        let name = target.file_name().map(|name| name.to_os_string());
        Ok((fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf()), name))
    };
    Ok(whole(a)? == whole(b)?)
}

/// Tries whether [`write_atomically`] could write a file, but for the space that it takes; leaves nothing behind. Pipes and
/// devices are not tried: who reads a pipe would take the try for all there is.
///
/// # Errors
/// [`WriteError`] as there
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let try_it = || match place(path)? {
        Place::Direct(_) => Ok(()),
        Place::Renamed(target) => temporary(folder_of(&target)).map(|_| ()),
    };
    try_it().map_err(|cause| WriteError { path: path.to_path_buf(), cause: bare(cause) })
}

/// How a file is written.
enum Place {
    /// What is no regular file.
    Direct(PathBuf),
    /// Under another name first.
    Renamed(PathBuf),
}

fn place(path: &Path) -> io::Result<Place> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")),
        // Where links such as /dev/stdout lead to has a name that cannot be opened.
        Ok(found) if !found.is_file() => Ok(Place::Direct(path.to_path_buf())),
        // What is protected from writing is not replaced either, though its folder would allow that.
        Ok(found) if found.permissions().readonly() => {
            Err(io::Error::new(io::ErrorKind::PermissionDenied, "it is protected from writing"))
        }
        Ok(_) => {
            let _writable = fs::OpenOptions::new().append(true).open(path)?;
            Ok(Place::Renamed(target(path)?))
        }
        // A name that is too long, a folder that is none.
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(Place::Renamed(target(path)?)),
    }
}

fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

const PREFIX: &str = ".turbid-";
const SUFFIX: &str = ".tmp";

/// A new temporary file, which this process holds.
fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile<fs::File>> {
    remove_left_over(folder);
    // Made by std: permissions of any new file, and errors that do not name the temporary file.
    let file = tempfile::Builder::new()
        .prefix(PREFIX)
        .suffix(SUFFIX)
        .make_in(folder, |path| fs::File::create_new(path))?;
    // Where there are no locks nothing left over is removed either.
    let _unlocked = file.as_file().try_lock();
    Ok(file)
}

/// Removes temporary files that no process holds, the first time that this one writes to a folder. One that was made just
/// now may not be held yet.
fn remove_left_over(folder: &Path) {
    const SETTLED: Duration = Duration::from_secs(1);
    static CLEANED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let is_first = CLEANED.lock().is_ok_and(|mut cleaned| cleaned.insert(folder.to_path_buf()));
    if !is_first {
        return;
    }
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if !(name.starts_with(PREFIX) && name.ends_with(SUFFIX)) {
            continue;
        }
        let is_old = |about: fs::Metadata| about.modified().ok()?.elapsed().ok().map(|age| age > SETTLED);
        let is_old = fs::symlink_metadata(&path).ok().filter(fs::Metadata::is_file).and_then(is_old);
        if is_old == Some(true) && fs::File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) {
            let _kept = fs::remove_file(&path);
        }
    }
}

fn try_write(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Option<fs::File>> {
    let target = match place(path)? {
        Place::Direct(target) => {
            let mut file = BufWriter::new(fs::OpenOptions::new().write(true).open(&target)?);
            write(&mut file)?;
            file.flush()?;
            return Ok(None);
        }
        Place::Renamed(target) => target,
    };
    let mut temporary = temporary(folder_of(&target))?;
    // As a plain file, whose errors do not name it.
    let mut buffered = BufWriter::new(temporary.as_file_mut());
    write(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    temporary.as_file().sync_all()?;
    Ok(Some(temporary.persist(&target).map_err(|e| e.error)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_appears_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_atomically(&path, |w| w.write_all(b"one")).unwrap();
        write_atomically(&path, |w| w.write_all(b"two")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Another process would find it locked until it is let go.
    #[test]
    fn a_file_can_be_held() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let is_free = || fs::File::open(&path).unwrap().try_lock().is_ok();
        let held = write_and_hold(&path, |w| w.write_all(b"one")).unwrap();
        assert!(held.is_some() && !is_free());
        let again = write_and_hold(&path, |w| w.write_all(b"two")).unwrap();
        drop(held);
        assert!(!is_free());
        drop(again);
        assert!(is_free());
        assert_eq!(fs::read(&path).unwrap(), b"two");
    }

    /// What a temporary file adds to the system's errors, its own name, is taken off again.
    #[test]
    fn the_temporary_file_is_not_named() {
        #[derive(Debug, thiserror::Error)]
        #[error("{cause} at path \"/tmp/.turbid-x.tmp\"")]
        struct At {
            #[source]
            cause: io::Error,
        }
        let full = || io::Error::from_raw_os_error(28);
        for error in [full(), io::Error::new(io::ErrorKind::StorageFull, At { cause: full() })] {
            assert_eq!(bare(error).to_string(), full().to_string());
        }
        assert_eq!(bare(io::Error::other("no")).to_string(), "no");
    }

    #[test]
    fn a_failed_writer_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("the disk said no"))
        })
        .unwrap_err();
        assert_eq!(error.to_string(), format!("cannot write {}: the disk said no", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn errors_name_the_path_that_was_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.csv");
        let text = write_atomically(&path, |_| Ok(())).unwrap_err().to_string();
        assert!(text.starts_with(&format!("cannot write {}: ", path.display())), "{text}");
        assert!(!text.contains(".turbid-") && text.contains("os error 2"), "{text}");
        assert!(
            write_atomically(folder.path(), |_| Ok(())).unwrap_err().to_string().contains("it is a folder")
        );
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let ours = folder.path().join("ours");
        let plain = folder.path().join("plain");
        write_atomically(&ours, |_| Ok(())).unwrap();
        fs::write(&plain, b"").unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomically(&link, |w| w.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        // A link to nothing too, by a path of its own folder.
        let (goal, dangling) = (folder.path().join("goal"), folder.path().join("dangling"));
        std::os::unix::fs::symlink("goal", &dangling).unwrap();
        assert!(is_same_file(&dangling, &goal).unwrap() && !is_same_file(&dangling, &file).unwrap());
        write_atomically(&dangling, |w| w.write_all(b"here")).unwrap();
        assert!(fs::symlink_metadata(&dangling).unwrap().is_symlink());
        assert_eq!(fs::read(&goal).unwrap(), b"here");
        let circle = folder.path().join("circle");
        std::os::unix::fs::symlink("circle", &circle).unwrap();
        assert!(write_atomically(&circle, |_| Ok(())).unwrap_err().to_string().contains("circle: "));
        write_atomically("/dev/null", |w| w.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    /// What a run left that was killed while it wrote; what another one is writing stays.
    #[test]
    fn what_was_left_over_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let names = [".turbid-dead.tmp", ".turbid-held.tmp", ".turbid-new.tmp", "mine.tmp"];
        let [dead, held, new, mine] = names.map(|name| folder.path().join(name));
        for path in [&dead, &held, &new, &mine] {
            fs::write(path, b"x").unwrap();
        }
        let old = std::time::SystemTime::now() - Duration::from_secs(100);
        for path in [&dead, &held, &mine] {
            fs::File::options().write(true).open(path).unwrap().set_modified(old).unwrap();
        }
        let file = fs::File::open(&held).unwrap();
        file.lock().unwrap();
        write_atomically(folder.path().join("a.csv"), |_| Ok(())).unwrap();
        assert_eq!([&dead, &held, &new, &mine].map(|path| path.exists()), [false, true, true, true]);
    }

    #[test]
    fn what_cannot_be_written_is_known_before() {
        let folder = tempfile::tempdir().unwrap();
        let says = |path: &Path| check_writable(path).unwrap_err().to_string();
        let path = folder.path().join("a.csv");
        check_writable(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&path, b"old").unwrap();
        check_writable(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert!(says(folder.path()).ends_with("it is a folder"));
        let missing = folder.path().join("none/a.csv");
        assert!(says(&missing).starts_with(&format!("cannot write {}: No such file", missing.display())));
        let protect = |is_protected: bool| {
            let mut permissions = fs::metadata(&path).unwrap().permissions();
            permissions.set_readonly(is_protected);
            fs::set_permissions(&path, permissions).unwrap();
        };
        protect(true);
        assert!(says(&path).ends_with("it is protected from writing"), "{}", says(&path));
        assert!(write_atomically(&path, |w| w.write_all(b"new")).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        protect(false);
        let long = folder.path().join("x".repeat(300));
        assert!(says(&long).contains("name too long"), "{}", says(&long));
        assert!(says(&path.join("b")).contains("Not a directory"), "{}", says(&path.join("b")));
    }
}
