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
    info.location().map_or("an unknown place".to_string(), |l| format!("{}:{}", in_package(l.file()), l.line()))
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
        assert_eq!(CATCHING.load(Ordering::SeqCst), 0);
    }

    #[test]
    fn places_are_those_of_the_package() {
        assert_eq!(in_package("experiments/src/rates/fit.rs"), "experiments/src/rates/fit.rs");
        assert_eq!(in_package("/home/a/registry/src/x-1/csv-1.3.0/src/reader.rs"), "csv-1.3.0/src/reader.rs");
        assert_eq!(in_package("/rustc/library/core/src/option.rs"), "core/src/option.rs");
    }
}
