//! Progress and remaining time on stderr: a bar on a terminal, else a line every ten seconds.

use super::quiet::is_quiet;
use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};
use turbid::transport::Progress;

/// Time between two lines where stderr is no terminal.
const EVERY: Duration = Duration::from_secs(10);

/// When this program last told of its progress, or began: stages share it, so that many short ones are told too.
static TOLD: Mutex<Option<Instant>> = Mutex::new(None);

/// A bar that counts histories, or lines instead of it.
pub struct Bar {
    bar: ProgressBar,
    lines: Option<Mutex<Stage>>,
    /// Where the bar counts thousandths of seconds of processors: when it began, and how many it knows of.
    clock: Option<Mutex<(ProcessTime, u64)>>,
}

/// How far a stage is.
struct Stage {
    name: &'static str,
    steps: u64,
    /// What all steps are, in words.
    of: String,
    done: u64,
    start: Instant,
}

/// What nobody can spoil: a thread that died while it held the lock left a whole value behind.
fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl Stage {
    fn new(name: &'static str, steps: u64) -> Self {
        Stage { name, steps, of: steps.to_string(), done: 0, start: Instant::now() }
    }

    /// The line, so long after the stage began.
    fn line(&self, elapsed: Duration) -> String {
        let part = self.done as f64 / self.steps.max(1) as f64;
        let left = elapsed.as_secs_f64() * (1.0 - part).max(0.0) / part;
        let left = if left.is_finite() { in_words(left) } else { "unknown time".to_string() };
        format!("turbid: {}: {:.0} % of {}, {left} left", self.name, 100.0 * part.min(1.0), self.of)
    }
}

/// Seconds in words.
pub fn in_words(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..120 => format!("{whole} s"),
        120..7200 => format!("{} min", whole.div_ceil(60)),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

/// Whether a line is due, told last at `told`; the first call only begins.
fn is_due(told: &mut Option<Instant>, now: Instant) -> bool {
    let last = *told.get_or_insert(now);
    let is_due = now.duration_since(last) >= EVERY;
    if is_due {
        *told = Some(now);
    }
    is_due
}

impl Bar {
    /// A bar for so many histories.
    pub fn new(histories: u64) -> Self {
        Self::styled(
            "histories",
            histories,
            "{bar:40} {percent:>3} %  {human_pos} of {human_len} histories, {eta} left",
        )
    }

    /// A bar for one stage of several, with its name.
    pub fn stage(name: &'static str, steps: u64) -> Self {
        Self::styled(name, steps, "{msg:>10} {bar:40} {percent:>3} %  {human_pos} of {human_len}, {eta} left")
    }

    /// A bar for a stage that may take so many seconds of processors from now on, whatever steps are told.
    pub fn timed(name: &'static str, seconds: f64) -> Self {
        let template = "{msg:>10} {bar:40} {percent:>3} %  of the time, {eta} left";
        let bar = Self::styled(name, (1e3 * seconds) as u64, template);
        if let Some(lines) = &bar.lines {
            locked(lines).of = format!("{} of processors", in_words(seconds));
        }
        Bar { clock: Some(Mutex::new((ProcessTime::now(), 0))), ..bar }
    }

    fn styled(name: &'static str, steps: u64, template: &str) -> Self {
        let bar = if is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(steps) };
        bar.set_length(steps);
        let bar = match ProgressStyle::with_template(template) {
            Ok(style) => bar.with_style(style).with_message(name),
            Err(_) => bar,
        };
        let has_lines = !is_quiet() && !std::io::stderr().is_terminal();
        is_due(&mut locked(&TOLD), Instant::now());
        Bar { bar, lines: has_lines.then(|| Mutex::new(Stage::new(name, steps))), clock: None }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn stage(&self, name: &'static str, steps: u64) {
        // Time goes on through all stages.
        if self.clock.is_some() {
            return;
        }
        self.bar.reset();
        self.bar.set_length(steps);
        self.bar.set_message(name);
        if let Some(lines) = &self.lines {
            *locked(lines) = Stage::new(name, steps);
        }
    }

    fn advance(&self, steps: u64) {
        let steps = self.clock.as_ref().map_or(steps, |clock| {
            let (start, told) = &mut *locked(clock);
            let spent = start.elapsed().as_millis() as u64;
            spent.saturating_sub(std::mem::replace(told, spent))
        });
        self.bar.inc(steps);
        let Some(lines) = &self.lines else { return };
        let mut stage = locked(lines);
        stage.done += steps;
        if is_due(&mut locked(&TOLD), Instant::now()) {
            // Progress that cannot be told is no reason to stop.
            let _ = writeln!(std::io::stderr().lock(), "{}", stage.line(stage.start.elapsed()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_what_is_left() {
        let stage = |done| Stage { done, ..Stage::new("emission", 4_000_000) };
        let after = Duration::from_secs(30);
        assert_eq!(stage(1_000_000).line(after), "turbid: emission: 25 % of 4000000, 90 s left");
        assert_eq!(stage(4_000_000).line(after), "turbid: emission: 100 % of 4000000, 0 s left");
        assert_eq!(stage(0).line(after), "turbid: emission: 0 % of 4000000, unknown time left");
        let timed = Stage { of: "60 s of processors".into(), ..stage(1_000_000) };
        assert_eq!(timed.line(after), "turbid: emission: 25 % of 60 s of processors, 90 s left");
        assert_eq!(in_words(119.4), "119 s");
        assert_eq!((in_words(130.0), in_words(9000.0)), ("3 min".to_string(), "2.5 h".to_string()));
    }

    /// Every ten seconds, whatever happens between; short runs say nothing.
    #[test]
    fn a_line_every_ten_seconds() {
        let (start, mut told) = (Instant::now(), None);
        let due: Vec<u64> =
            (0..100).filter(|s| is_due(&mut told, start + Duration::from_millis(350 * s))).collect();
        assert_eq!(due, [29, 58, 87]);
    }
}
