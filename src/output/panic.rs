//! A fault of the program, told as any error is.

use super::one_line;
use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Runs a program; a panic, which is a fault of the program, ends it with one line on stderr that says where, and exit code 2.
/// An allocation that fails, or a stack that is full, ends it with what the standard library says of it, and exit code 2 too.
pub fn without_panic(program: &'static str, run: impl FnOnce() -> ExitCode) -> ExitCode {
    let _unset = register_conditional_shutdown(SIGABRT, 2, Arc::new(AtomicBool::new(true)));
    set_hook(Box::new(move |info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        let what = one_line(info.payload_as_str().unwrap_or("no text"));
        let line = format!("{program}: error: internal error at {place}, please report it: {what}");
        let _unheard = writeln!(std::io::stderr().lock(), "{line}");
    }));
    catch_unwind(AssertUnwindSafe(run)).unwrap_or(ExitCode::from(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::take_hook;

    #[test]
    fn a_panic_ends_with_code_2() {
        let hook = take_hook();
        let codes =
            [without_panic("test", || panic!("on purpose")), without_panic("test", || ExitCode::SUCCESS)];
        set_hook(hook);
        let expected = [ExitCode::from(2), ExitCode::SUCCESS];
        assert_eq!(format!("{codes:?}"), format!("{expected:?}"));
    }
}
