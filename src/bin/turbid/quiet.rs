//! Whether notes and progress are told: not with `--quiet`.

use std::sync::atomic::{AtomicBool, Ordering};

static QUIET: AtomicBool = AtomicBool::new(false);

/// Tells neither from now on.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether neither is told.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}
