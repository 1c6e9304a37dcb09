//! What memory a run may take.

use super::shared::parse_count;
use anyhow::bail;
use turbid::memory::{free, in_words, used};

/// What a run may take.
#[derive(clap::Args)]
pub struct Memory {
    /// Memory that the run may take, such as 500M or 2G (powers of ten), instead of what is free; what does not fit is
    /// refused before it begins.
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<u64>,
}

/// Bytes on the command line.
fn parse_size(text: &str) -> Result<u64, String> {
    const ALLOWED: &str = "allowed: a number of bytes, or of k, M, G or T, such as 500M or 2G";
    let end = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[end.len()..] {
        "" | "B" => 1.0,
        "k" | "K" | "kB" | "KB" => 1e3,
        "M" | "MB" => 1e6,
        "G" | "GB" => 1e9,
        "T" | "TB" => 1e12,
        _ => return Err(ALLOWED.to_string()),
    };
    let whole = parse_count(end).ok().map(|n| n as f64).or_else(|| end.parse::<f64>().ok());
    match whole.map(|n| n * unit) {
        Some(bytes) if (1.0..=9e15).contains(&bytes) => Ok(bytes as u64),
        _ => Err(ALLOWED.to_string()),
    }
}

/// The largest number of two digits that is not above another one, at least 1, as it is written on the command line.
pub fn rounded_down(number: f64) -> String {
    if number < 100.0 {
        return format!("{}", number.floor().max(1.0));
    }
    let scale = libm::pow(10.0, libm::log10(number).floor() - 1.0);
    let down = (number / scale).floor() * scale;
    if down < 1e5 { format!("{down}") } else { format!("{down:e}") }
}

/// How many passes would fit where `part` of what a pass holds does: a tenth more, since the number of photons is a pilot's.
pub fn passes_that_fit(passes: u64, part: f64) -> f64 {
    (1.1 * passes as f64 / part).ceil()
}

impl Memory {
    /// Bytes that are left for the work, as far as is known.
    fn left(&self) -> Option<f64> {
        match self.memory {
            Some(given) => Some(given as f64 - used().unwrap_or(0.0)),
            None => free(),
        }
    }

    /// Refuses work that takes more memory than there is.
    ///
    /// # Arguments
    /// `what` takes so many `bytes`, `fixed` of them whatever is asked for; `fits` says what to ask for instead, given the
    /// part of the rest that fits
    pub fn check(
        &self,
        what: &str,
        bytes: f64,
        fixed: f64,
        fits: impl FnOnce(f64) -> String,
    ) -> anyhow::Result<()> {
        let Some(left) = self.left().filter(|left| bytes > *left) else { return Ok(()) };
        let (takes, has) = (in_words(bytes), in_words(left.max(0.0)));
        let whose = if self.memory.is_some() { "left by --memory" } else { "free" };
        if let Some(given) = self.memory.filter(|_| left <= 0.0) {
            let held = in_words(given as f64 - left);
            bail!(
                "--memory is {}, and the program itself takes {held}; allowed: more",
                in_words(given as f64)
            );
        }
        let part = (left - fixed) / (bytes - fixed);
        if part.is_nan() || part <= 0.0 {
            bail!(
                "{what} takes about {takes} of memory, {has} are {whose}; allowed: more --memory, or fewer pixels and sensors"
            );
        }
        bail!("{what} takes about {takes} of memory, {has} are {whose}; allowed: {}", fits(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("2G"), Ok(2_000_000_000));
        assert_eq!(parse_size("1.5GB"), Ok(1_500_000_000));
        assert_eq!(parse_size("500M"), Ok(500_000_000));
        assert_eq!(parse_size("1e6"), Ok(1_000_000));
        for bad in ["", "G", "-1G", "0", "nan", "inf", "1e30", "2X", "2 G"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_that_fit() {
        let pairs = [(0.2, "1"), (7.9, "7"), (99.9, "99"), (1299.0, "1200"), (123_456.0, "1.2e5")];
        for (number, text) in pairs {
            assert_eq!(rounded_down(number), text);
            assert!(parse_count(text).is_ok());
        }
    }
}
