//! How far a study is: who is told, and may end it; a terminal with the remaining time.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use turbid::output::one_line;

/// Time between lines where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(10);

/// Says one line on standard error. Nobody listening is no error.
pub fn say(text: &str) {
    let _unheard = writeln!(std::io::stderr().lock(), "{}", one_line(text));
}

/// Who is told how far a study is, and may end it.
pub trait Watch: Sync {
    /// A line about what is to come.
    fn say(&self, line: &str);

    /// So many cells are to be measured.
    fn begin(&self, cells: usize);

    /// One more cell is done, which was this part of the cost of all.
    fn advance(&self, part: f64);

    /// No cell is measured any more.
    fn finish(&self);

    /// Whether no further cell shall be begun: those in work are finished and kept, and nothing is concluded.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Tells standard error: a bar where there is a terminal, else a line now and then.
#[derive(Default)]
pub struct Terminal(Mutex<Option<Progress>>);

impl Terminal {
    fn with(&self, told: impl FnOnce(&mut Option<Progress>)) {
        told(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Watch for Terminal {
    fn say(&self, line: &str) {
        say(line);
    }

    fn begin(&self, cells: usize) {
        self.with(|progress| *progress = Some(Progress::new(cells)));
    }

    fn advance(&self, part: f64) {
        self.with(|progress| progress.iter_mut().for_each(|progress| progress.advance(part)));
    }

    fn finish(&self) {
        self.with(|progress| progress.iter().for_each(Progress::finish));
    }
}

/// Progress of the cells, by their cost.
struct Progress {
    bar: Option<ProgressBar>,
    start: Instant,
    cells: usize,
    /// Part of the cost that is done, and cells.
    done: (f64, usize),
    last: Instant,
}

impl Progress {
    fn new(cells: usize) -> Self {
        let bar = (std::io::stderr().is_terminal() && cells > 0).then(|| {
            let bar = ProgressBar::new(1000);
            let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left");
            if let Ok(style) = style {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        });
        let now = Instant::now();
        Progress { bar, start: now, cells, done: (0.0, 0), last: now }
    }

    fn advance(&mut self, part: f64) {
        self.done.0 += part;
        self.done.1 += 1;
        let (share, cells) = (self.done.0.min(1.0), self.done.1);
        if let Some(bar) = &self.bar {
            bar.set_message(format!("cell {cells} of {}", self.cells));
            bar.set_position((share * 1000.0) as u64);
        } else if self.last.elapsed() >= INTERVAL {
            self.last = Instant::now();
            let left = self.start.elapsed().as_secs_f64() * (1.0 - share) / share.max(1e-9);
            let left = duration(left);
            say(&format!("  cell {cells} of {}, {:.0} % done, about {left} left", self.cells, 100.0 * share));
        }
    }

    /// Takes the bar away.
    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Seconds in the unit a person would use.
pub(crate) fn duration(seconds: f64) -> String {
    // The sum of no f64 is -0.
    match seconds.abs() {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
