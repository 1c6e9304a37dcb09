//! A last word before a program is ended from outside.

/// Exit code of a program that was interrupted: 128 and the number of SIGINT.
#[cfg(unix)]
const INTERRUPTED: i32 = 130;

/// Ends the program with one line on stderr when it is interrupted or asked to end (SIGINT, SIGTERM, SIGHUP). A signal that
/// whoever started it has had ignored, as `nohup` does with SIGHUP, stays so. Elsewhere than on Unix there is no last word.
pub fn end_on_signal(last_word: impl Fn() -> String + Send + 'static) {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        use std::io::Write;
        let heard = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !is_ignored(*signal));
        let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) else { return };
        // Without a thread signals are heard no longer, and do what they did.
        let _unheard = std::thread::Builder::new().spawn(move || {
            if signals.forever().next().is_some() {
                let _unheard = writeln!(std::io::stderr().lock(), "{}", super::one_line(&last_word()));
                std::process::exit(INTERRUPTED)
            }
        });
    }
    #[cfg(not(unix))]
    drop(last_word);
}

/// Whether the program was started with a signal ignored; where the system does not tell, a hangup.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    match mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()) {
        Some(mask) => mask >> (signal - 1) & 1 == 1,
        None => signal == signal_hook::consts::SIGHUP,
    }
}
