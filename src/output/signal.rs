//! A last word before a program is ended from outside.

use super::one_line;
use std::io::Write;

/// Exit code of a program that was interrupted: 128 and the number of SIGINT.
const INTERRUPTED: i32 = 130;

/// Ends the program with one line on stderr when it is interrupted or asked to end (SIGINT, SIGTERM, SIGHUP). Signals that
/// whoever started it has had ignored, as `nohup` does, stay so, and there is no last word.
pub fn end_on_signal(last_word: impl Fn() -> String + Send + 'static) {
    let end = move || {
        let _unheard = writeln!(std::io::stderr().lock(), "{}", one_line(&last_word()));
        std::process::exit(INTERRUPTED)
    };
    let _unset = ctrlc::try_set_handler(end);
}
