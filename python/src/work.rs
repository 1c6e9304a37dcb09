//! Long work beside Python: on a thread of its own, watched, ended by Ctrl-C.

use crate::error::{refuse, refused};
use anyhow::anyhow;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use turbid::transport::Progress;

/// How often Python looks whether it was interrupted: soon for who waits, and nothing beside the work.
const LOOK: Duration = Duration::from_millis(200);

/// Stack of the thread that works \[bytes\]: as a main thread has it.
const STACK: usize = 8 << 20;

/// What the last panic said, for the exception that it becomes.
static PANICKED: Mutex<String> = Mutex::new(String::new());

/// Panics are told as exceptions, not on stderr.
pub fn silence_panics() {
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        let what = info.payload_as_str().unwrap_or("no text");
        let text = format!("internal error at {place}, please report it: {what}");
        *PANICKED.lock().unwrap_or_else(PoisonError::into_inner) = text;
    }));
}

/// How far the work is, and whether it shall stop.
#[derive(Default)]
pub struct Watch {
    is_cancelled: AtomicBool,
    stage: Mutex<&'static str>,
    steps: AtomicU64,
    done: AtomicU64,
}

impl Progress for Watch {
    fn stage(&self, name: &'static str, steps: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = name;
        self.steps.store(steps, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

impl Watch {
    /// Asks for what the work says of itself.
    fn tell(&self, py: Python<'_>, progress: &Py<PyAny>) -> PyResult<()> {
        let stage = *self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let steps = self.steps.load(Ordering::Relaxed).max(1);
        let part = self.done.load(Ordering::Relaxed) as f64 / steps as f64;
        progress.call1(py, (stage, part.min(1.0))).map(drop)
    }
}

/// Does something with Python free for others, on so many threads, all cores if none are given.
///
/// `progress` is called five times a second, and at the end, with the name of the stage and the part of it that is done. An interrupt, or an
/// exception of `progress`, ends the wait at once and the work at its next look.
///
/// # Errors
/// Those of the work; a panic of it, as an internal error; `KeyboardInterrupt`
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<u16>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Watch) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    if threads.is_some_and(|n| !(1..=1024).contains(&n)) {
        return Err(refuse(format!(
            "threads is {}; allowed: whole numbers from 1 to 1024",
            threads.unwrap_or(0)
        )));
    }
    let watch = Arc::new(Watch::default());
    let (send, receive) = channel();
    let watched = Arc::clone(&watch);
    let on_thread = move || {
        let all = AssertUnwindSafe(|| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from));
            let pool = pool.stack_size(STACK).build().map_err(|error| anyhow!("threads: {error}"))?;
            pool.install(|| work(&watched))
        });
        // Nobody listens any more if the wait was ended.
        let _unheard = send.send(catch_unwind(all));
    };
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(on_thread);
    thread.map_err(|error| refuse(format!("no thread to work on: {error}")))?;
    // Only this thread waits: the receiver need not be shared.
    let receive = Mutex::new(receive);
    let wait = || receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK);
    loop {
        match py.detach(wait) {
            Ok(Ok(Ok(done))) => {
                progress.map_or(Ok(()), |progress| watch.tell(py, progress))?;
                return Ok(done);
            }
            Ok(Ok(Err(error))) => return Err(refused(&error)),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                return Err(refuse(&*PANICKED.lock().unwrap_or_else(PoisonError::into_inner)));
            }
            Err(RecvTimeoutError::Timeout) => {
                let told = progress.map_or(Ok(()), |progress| watch.tell(py, progress));
                if let Err(error) = py.check_signals().and(told) {
                    watch.is_cancelled.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    }
}
