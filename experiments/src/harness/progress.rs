//! Progress with remaining time, on standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use turbid::output::one_line;

/// Time between lines where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(10);

/// Says one line on standard error. Nobody listening is no error.
pub fn say(text: &str) {
    let _unheard = writeln!(std::io::stderr().lock(), "{}", one_line(text));
}

/// Progress of the cells, by their cost.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    start: Instant,
    total: f64,
    cells: usize,
    state: Mutex<State>,
}

struct State {
    done: f64,
    cells: usize,
    last: Instant,
}

impl Progress {
    pub(super) fn new(cells: usize, total: f64) -> Self {
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
        let state = Mutex::new(State { done: 0.0, cells: 0, last: now });
        Progress { bar, start: now, total, cells, state }
    }

    /// One more cell is done.
    pub(super) fn advance(&self, cost: f64) {
        let Ok(mut state) = self.state.lock() else { return };
        state.done += cost;
        state.cells += 1;
        let share = if self.total > 0.0 { (state.done / self.total).min(1.0) } else { 1.0 };
        if let Some(bar) = &self.bar {
            bar.set_message(format!("cell {} of {}", state.cells, self.cells));
            bar.set_position((share * 1000.0) as u64);
        } else if state.last.elapsed() >= INTERVAL {
            state.last = Instant::now();
            let left = self.start.elapsed().as_secs_f64() * (1.0 - share) / share.max(1e-9);
            say(&format!(
                "  cell {} of {}, {:.0} % done, about {} left",
                state.cells,
                self.cells,
                100.0 * share,
                duration(left)
            ));
        }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
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
