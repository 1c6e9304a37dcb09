//! Progress and remaining time on stderr, where it is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use turbid::transport::Progress;

/// A bar that counts histories.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar for so many histories; hidden where stderr is no terminal.
    pub fn new(histories: u64) -> Self {
        let bar = ProgressBar::new(histories);
        let template = "{bar:40} {percent:>3} %  {human_pos} of {human_len} histories, {eta} left";
        Bar(match ProgressStyle::with_template(template) {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        })
    }

    /// A bar for one stage of several, with its name; hidden where stderr is no terminal.
    pub fn stage(name: &'static str, steps: u64) -> Self {
        let bar = Bar::new(steps);
        let template = "{msg:>10} {bar:40} {percent:>3} %  {human_pos} of {human_len}, {eta} left";
        Bar(match ProgressStyle::with_template(template) {
            Ok(style) => bar.0.with_style(style).with_message(name),
            Err(_) => bar.0,
        })
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn stage(&self, name: &'static str, steps: u64) {
        self.0.reset();
        self.0.set_length(steps);
        self.0.set_message(name);
    }

    fn advance(&self, steps: u64) {
        self.0.inc(steps);
    }
}
