//! Panics: one line with the place, and exit code 2; or the words of whoever catches one on purpose.

use super::progress::say;
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many times a panic is waited for at this moment, on any thread: what is caught on purpose is not printed.
static CATCHING: AtomicUsize = AtomicUsize::new(0);

/// Where the last panics were, by what they said: rayon brings a panic to another thread, without its place.
static PLACES: Mutex<VecDeque<(String, String)>> = Mutex::new(VecDeque::new());

/// Places that are kept.
const KEPT: usize = 64;

/// Runs a program: a panic that nobody catches is one line on standard error, and exit code 2.
pub(crate) fn guarded(name: &'static str, program: impl FnOnce() -> ExitCode) -> ExitCode {
    std::panic::set_hook(Box::new(move |info| {
        let (place, text) = (place(info), info.payload_as_str().unwrap_or(SPEECHLESS));
        if CATCHING.load(Ordering::SeqCst) == 0 {
            say(&format!("{name}: error: internal error at {place}: {text}"));
        } else if let Ok(mut places) = PLACES.lock() {
            places.truncate(KEPT - 1);
            places.push_front((text.to_string(), place));
        }
    }));
    catch_unwind(AssertUnwindSafe(program)).unwrap_or_else(|payload| {
        let text = words(payload.as_ref());
        // Not printed where it was, since another thread had one caught at that moment.
        if let Some(place) = taken(&text) {
            say(&format!("{name}: error: internal error at {place}: {text}"));
        }
        ExitCode::from(2)
    })
}

/// What a part of the work makes, or what its panic said: with the place, where a program is [`guarded`].
pub(crate) fn caught<T>(part: impl FnOnce() -> T) -> Result<T, String> {
    CATCHING.fetch_add(1, Ordering::SeqCst);
    let made = catch_unwind(AssertUnwindSafe(part));
    CATCHING.fetch_sub(1, Ordering::SeqCst);
    made.map_err(|payload| {
        let text = words(payload.as_ref());
        let place = taken(&text).map_or(String::new(), |place| format!(" at {place}"));
        format!("internal error{place}: {text}")
    })
}

/// Where the last panic was that said this.
fn taken(text: &str) -> Option<String> {
    let mut places = PLACES.lock().ok()?;
    let index = places.iter().position(|(said, _)| said == text)?;
    places.remove(index).map(|(_, place)| place)
}

/// A panic without words.
const SPEECHLESS: &str = "no text";

fn words(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or(SPEECHLESS).to_string()
}

/// File and line; of a file elsewhere the package's folder and what is below.
fn place(info: &PanicHookInfo) -> String {
    info.location()
        .map_or("an unknown place".to_string(), |l| format!("{}:{}", in_package(l.file()), l.line()))
}

/// A file's name without the folders above its package: reports hold no absolute paths.
fn in_package(file: &str) -> &str {
    let Some(sources) = file.rfind("/src/").filter(|_| file.starts_with('/')) else { return file };
    file[..sources].rfind('/').map_or(file, |start| &file[start + 1..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_caught_says_what_it_said() {
        assert_eq!(caught(|| 3), Ok(3));
        // Unless another test has set the hook there is no place.
        let said = caught(|| panic!("{} of 2", 3)).map(|()| 0).unwrap_err();
        assert!(said.starts_with("internal error") && said.ends_with(": 3 of 2"), "{said}");
    }

    const PANIC_IN: &str = "TURBID_TEST_PANIC";

    /// Not a test by itself: the process that the next one starts.
    #[test]
    fn child_that_panics() {
        if std::env::var_os(PANIC_IN).is_some() {
            let code = guarded("child", || {
                let said = caught(|| rayon::join(|| 1, || panic!("{} on purpose\n\u{1b}", 2)));
                say(&format!("child: {}", said.map(|_: (i32, i32)| String::new()).unwrap_or_else(|e| e)));
                panic!("{} of 2\n\u{1b}[31m", 3)
            });
            std::process::exit(if code == ExitCode::from(2) { 2 } else { 1 });
        }
    }

    /// A panic is one line with its place, and exit code 2; one that is caught is told by whoever catches it, with its place too.
    #[test]
    fn a_panic_is_one_line() {
        let child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "harness::panics::tests::child_that_panics", "--test-threads=1"])
            .env(PANIC_IN, "1")
            .output()
            .unwrap();
        let text = String::from_utf8(child.stderr).unwrap();
        assert_eq!(child.status.code(), Some(2), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2, "{text}");
        let place = |line: &str, start: &str, end: &str| -> bool {
            let inner = line.strip_prefix(start).and_then(|rest| rest.strip_suffix(end));
            inner.is_some_and(|place| {
                place.rsplit_once(':').is_some_and(|(file, line)| {
                    file.ends_with("src/harness/panics.rs") && line.parse::<u32>().is_ok()
                })
            })
        };
        assert!(place(lines[0], "child: internal error at ", ": 2 on purpose \\u{1b}"), "{text}");
        assert!(place(lines[1], "child: error: internal error at ", ": 3 of 2 \\u{1b}[31m"), "{text}");
    }

    #[test]
    fn places_are_those_of_the_package() {
        assert_eq!(in_package("experiments/src/rates/fit.rs"), "experiments/src/rates/fit.rs");
        assert_eq!(in_package("/home/a/registry/src/x-1/csv-1.3.0/src/reader.rs"), "csv-1.3.0/src/reader.rs");
        assert_eq!(in_package("/rustc/library/core/src/option.rs"), "core/src/option.rs");
    }
}
