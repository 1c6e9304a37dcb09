//! Files of the command: what is read, what is written, and text from elsewhere on its way through.

use crate::cli::{HEAD, exact, file, refused, rows, stdout};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

const SLAB: [&str; 5] = ["slab", "--tau", "1", "--albedo", "0.9"];

/// A small question, with more words.
fn ask(more: &[&str]) -> assert_cmd::assert::Assert {
    exact().args(SLAB).args(more).assert()
}

/// What a terminal would obey: colour, a line end, a bell, C1, a line separator, a change of direction.
const OBEYED: &str = "a\u{1b}[31mb\u{7}c\u{9b}d\u{2028}e\u{202e}f\u{2066}g";
const SHOWN: &str = "a\\u{1b}[31mb\\u{7}c\\u{9b}d e\\u{202e}f\\u{2066}g";

fn is_plain(text: &str) -> bool {
    let turns =
        |c: char| matches!(c, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.lines().all(|line| !line.chars().any(|c| c.is_control() || turns(c)))
}

/// A pipe by name, where the system has them.
fn pipe(folder: &Path) -> Option<PathBuf> {
    let path = folder.join("pipe");
    let made = Command::new("mkfifo").arg(&path).status();
    made.is_ok_and(|status| status.success()).then_some(path)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn text_of_the_user_is_spelt_out_in_messages() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    // The parser of the command line leaves out colour, and takes a line end for one of its own.
    refused(exact().args(["slab", "--tau", "1", "--albedo", OBEYED]).assert(), &["d e\\u{202e}f"]);
    refused(exact().args(["slab", "--tau", "1\n2", "--albedo", "1"]).assert(), &["'1", "2'"]);
    refused(ask(&["--mu0", OBEYED]), &["d e\\u{202e}f"]);
    refused(exact().args(["kernel", "--kernel", OBEYED]).assert(), &["d e\\u{202e}f"]);
    refused(exact().arg(OBEYED).assert(), &["d e\\u{202e}f"]);
    refused(ask(&["--plot", &format!("{OBEYED}\n.pdf")]), &["--plot is ", SHOWN, " .pdf;"]);
    refused(ask(&["--moments", &format!("{OBEYED}\n")]), &[SHOWN, "No such file"]);
    refused(
        ask(&["--out", text(&place(&format!("{OBEYED}/a.csv")))]),
        &["cannot write ", SHOWN, "/a.csv: No"],
    );
    let given = |text: &str| {
        let path = place(OBEYED);
        fs::write(&path, text).unwrap();
        path
    };
    refused(
        ask(&["--moments", text(&given(&format!("1\n0.5\n{OBEYED}\n")))]),
        &[SHOWN, ":3: chi_2 is 'a\\u"],
    );
    refused(ask(&["--table", text(&given(&format!("-1,{OBEYED}\n")))]), &[SHOWN, ":1: '-1,a\\u{1b}"]);
    let cell = given(&format!("{HEAD}a,slab,\"1\n{OBEYED}\",,0.9,0,,1,,,,,,R\n"));
    refused(exact().arg("--cases").arg(&cell).assert(), &[SHOWN, ":2: tau is '1 a\\u{1b}"]);
}

#[test]
fn text_of_the_user_is_spelt_out_in_tables() {
    let cell = format!("\"{OBEYED}\ng\"");
    let table = file(&format!(
        "{HEAD}{cell},slab,1,,0.9,0,,1,,,,,,R\n{cell},{cell},1,,0.9,0,,1,,,,,phase={OBEYED},{cell}\n\
         c,slab,1,,0.9,0,,1,,,,,phase={OBEYED},R\n"
    ));
    for form in ["table", "csv", "json"] {
        let said = stdout(exact().arg("--cases").arg(table.path()).args(["--format", form]));
        assert!(is_plain(&said), "{said:?}");
        assert!(said.contains(&SHOWN.replace('\\', if form == "json" { "\\\\" } else { "\\" })), "{said}");
        if form == "csv" {
            let answers = rows(said.as_bytes());
            assert_eq!((answers.len(), said.lines().count()), (3, 4), "{said}");
            assert_eq!(answers[0]["id"], format!("{SHOWN} g"));
            assert!(answers[1]["note"].starts_with(&format!("geometry {SHOWN} g is")), "{said}");
            assert!(answers[2]["note"].contains(&format!("phase function {SHOWN} is")), "{said}");
        }
    }
    // The name of a file is a parameter of the answer, and in the title of its figure.
    let folder = tempfile::tempdir().unwrap();
    let (moments, figure) = (folder.path().join(format!("{OBEYED}\n")), folder.path().join("a.svg"));
    fs::write(&moments, "1 0 0.1").unwrap();
    for form in ["table", "csv", "json"] {
        let words = ["--moments", text(&moments), "--format", form, "--plot", text(&figure)];
        let said = stdout(exact().args(SLAB).args(words));
        assert!(is_plain(&said) && said.contains("3 Legendre moments of a"), "{said:?}");
        assert!(is_plain(&fs::read_to_string(&figure).unwrap()));
    }
}

/// What has no end, no size or no text is refused before it is read, by every option that reads.
#[cfg(target_os = "linux")]
#[test]
fn only_files_of_a_bounded_size_are_read() {
    const NO_FILE: &str = ": a folder, a device or a pipe; allowed: a file\n";
    let folder = tempfile::tempdir().unwrap();
    let (large, binary) = (folder.path().join("large"), folder.path().join("binary"));
    // A hole, which takes no space.
    fs::File::create(&large).unwrap().set_len((16 << 20) + 1).unwrap();
    fs::write(&binary, b"\xff\xfe1,0\n").unwrap();
    let pipe = pipe(folder.path());
    let says = [
        (Some(Path::new("/dev/zero")), NO_FILE),
        (Some(folder.path()), NO_FILE),
        (pipe.as_deref(), NO_FILE),
        (Some(&large), ": has 16777217 bytes; allowed: up to 16777216\n"),
        (Some(&binary), "not text; allowed: UTF-8\n"),
        (Some(Path::new("/nowhere")), "/nowhere: No such file or directory (os error 2)\n"),
    ];
    for (path, part) in says {
        let Some(path) = path else { continue };
        refused(ask(&["--moments", text(path)]), &[text(path), part]);
        refused(ask(&["--table", text(path)]), &[text(path), part]);
        refused(exact().arg("--cases").arg(path).assert(), &[text(path), part]);
    }
}

/// Errors of writing name the file that was asked for, once, and come before the work.
#[cfg(unix)]
#[test]
fn what_cannot_be_written_is_said_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| text(&folder.path().join(name)).to_string();
    fs::write(place("file"), "old").unwrap();
    std::os::unix::fs::symlink("circle", place("circle.svg")).unwrap();
    std::os::unix::fs::symlink("circle.svg", place("circle")).unwrap();
    let long = format!("{}.svg", "x".repeat(300));
    for (name, cause) in [
        ("none/a.svg", "No such file or directory (os error 2)"),
        ("file/a.svg", "Not a directory (os error 20)"),
        ("circle.svg", "Too many levels of symbolic links (os error 40)"),
        (&long, "File name too long (os error 36)"),
        ("", "it is a folder"),
    ] {
        let path = place(name);
        let said = format!("exact: error: cannot write {path}: {cause}\n");
        // The albedo is refused by the work, the cell by reading.
        let work = ["slab", "--tau", "1", "--albedo", "7"];
        refused(exact().args(work).args(["--out", &path]).assert(), &[&said]);
        refused(exact().args(["--cases", "/nowhere", "--out", &path]).assert(), &[&said]);
        if path.ends_with(".svg") {
            refused(exact().args(work).args(["--plot", &path]).assert(), &[&said]);
        }
    }
    assert_eq!(fs::read_to_string(place("file")).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
}

/// A folder that may not be written to, and a file that may not grow.
#[cfg(target_os = "linux")]
#[test]
fn what_the_system_forbids_is_said_of_the_file_that_was_asked_for() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let closed = folder.path().join("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o500)).unwrap();
    let path = closed.join("a.csv");
    // The superuser is forbidden nothing there; in /proc nobody makes a file.
    if fs::File::create(&path).is_err() {
        let said = format!("cannot write {}: Permission denied (os error 13)\n", path.display());
        refused(
            exact().args(["slab", "--tau", "1", "--albedo", "7", "--out", text(&path)]).assert(),
            &[&said],
        );
    }
    let forbidden = exact().args(["slab", "--tau", "1", "--albedo", "7", "--out", "/proc/a.csv"]).assert();
    refused(forbidden, &["cannot write /proc/a.csv: ", " (os error "]);
    // Room for nothing: the shell's limit on the size of files, its signal ignored.
    let path = folder.path().join("a.csv");
    let limited = format!("trap '' XFSZ; ulimit -f 0; exec \"$0\" {} --out \"$1\"", SLAB.join(" "));
    let words = ["-c", &limited, env!("CARGO_BIN_EXE_exact"), text(&path)];
    let output = Command::new("sh").args(words).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let want = format!("exact: error: cannot write {}: File too large (os error 27)\n", path.display());
    assert_eq!((output.status.code(), said), (Some(2), want));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn links_stay_links_whether_they_lead_to_a_file_or_not() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::create_dir(place("other")).unwrap();
    fs::write(place("old.csv"), "old").unwrap();
    symlink("old.csv", place("to-old")).unwrap();
    symlink("other/new.csv", place("to-new")).unwrap();
    symlink("to-new", place("to-link")).unwrap();
    for (link, goal) in [("to-old", "old.csv"), ("to-new", "other/new.csv"), ("to-link", "other/new.csv")] {
        ask(&["--out", text(&place(link)), "--format", "json"]).success();
        assert!(fs::symlink_metadata(place(link)).unwrap().is_symlink(), "{link}");
        assert!(fs::read_to_string(place(goal)).unwrap().starts_with("{\n"), "{link}");
        fs::remove_file(place(goal)).unwrap();
    }
    // Two outputs in one place that is not there yet.
    symlink("a.svg", place("b.svg")).unwrap();
    let (a, b) = (place("a.svg"), place("b.svg"));
    refused(ask(&["--out", text(&a), "--plot", text(&b)]), &["--plot is ", "b.svg, which is --out too"]);
    let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["b.svg", "other", "to-link", "to-new", "to-old"]);
}

/// A reader of a pipe gets all of it and then the end; a stream that leads to a file goes on where it stands.
#[cfg(target_os = "linux")]
#[test]
fn pipes_and_streams_are_written_once() {
    let folder = tempfile::tempdir().unwrap();
    let whole = ask(&[]).success().get_output().stdout.clone();
    if let Some(pipe) = pipe(folder.path()) {
        let reader = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().unwrap();
        ask(&["--out", text(&pipe)]).success();
        assert_eq!(reader.wait_with_output().unwrap().stdout, whole);
    }
    for stream in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        let words: Vec<&str> = SLAB.into_iter().chain(["--out", stream]).collect();
        assert_eq!(exact().args(&words).output().unwrap().stdout, whole, "{stream}");
        let log = folder.path().join("log");
        fs::write(&log, "before\n").unwrap();
        let end = fs::OpenOptions::new().append(true).open(&log).unwrap();
        let status = Command::new(env!("CARGO_BIN_EXE_exact")).args(&words).stdout(end).status();
        assert!(status.unwrap().success());
        assert_eq!(fs::read(&log).unwrap(), [b"before\n", whole.as_slice()].concat(), "{stream}");
    }
}

/// What a killed run left beside its output is removed by the next, in the folder to which a link leads.
#[cfg(unix)]
#[test]
fn what_was_left_over_is_removed_by_the_next_run() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::create_dir(place("goal")).unwrap();
    std::os::unix::fs::symlink("goal/a.csv", place("a.csv")).unwrap();
    for name in ["goal/.exact-dead.tmp", "goal/.turbid-dead.tmp", "goal/mine.tmp"] {
        fs::write(place(name), "x").unwrap();
        let old = SystemTime::now() - Duration::from_secs(100);
        fs::File::options().write(true).open(place(name)).unwrap().set_modified(old).unwrap();
    }
    ask(&["--out", text(&place("a.csv"))]).success();
    let mut names: Vec<_> = fs::read_dir(place("goal")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, [".turbid-dead.tmp", "a.csv", "mine.tmp"]);
}

/// A run that is ended from outside leaves its output as it was: nothing is written before all is answered.
#[test]
fn a_run_that_is_ended_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let (table, out) = (folder.path().join("cases.csv"), folder.path().join("a.csv"));
    // Media of their own, seconds of work each.
    let row = |i: u32| format!("{i},slab,1,,0.{i},0.99,,1,,,,,,R\n");
    fs::write(&table, (101..199).map(row).fold(HEAD.to_string(), |all, row| all + &row)).unwrap();
    fs::write(&out, "old").unwrap();
    let words = ["--cases", text(&table), "--out", text(&out)];
    let mut child = Command::new(env!("CARGO_BIN_EXE_exact")).args(words).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "no work to interrupt");
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success());
    assert_eq!(fs::read_to_string(&out).unwrap(), "old");
}
