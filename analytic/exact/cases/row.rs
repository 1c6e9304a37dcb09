//! One question of a table: its cells by column name.

use anyhow::{Result, anyhow};

/// The columns of a table of cases.
pub const COLUMNS: [&str; 14] =
    ["id", "geometry", "tau", "a", "w", "g", "n", "mu0", "t", "r", "mu", "dphi", "extra", "quantity"];

/// One question.
pub struct Row {
    /// Line of the file, from 1.
    pub line: u64,
    /// Cells in the order of [`COLUMNS`], each in one line: all that is said of them goes on from here.
    pub fields: [String; COLUMNS.len()],
}

impl Row {
    /// A cell without blanks around it, or the value of a name in the column `extra`; empty where there is none.
    pub fn text(&self, name: &str) -> &str {
        match COLUMNS.iter().position(|column| *column == name) {
            Some(i) => self.fields[i].trim(),
            None => self.extra(name).unwrap_or_default(),
        }
    }

    /// All names in the column `extra`.
    pub fn extras(&self) -> impl Iterator<Item = &str> {
        self.text("extra").split(';').filter_map(|pair| Some(pair.split_once('=')?.0.trim()))
    }

    /// A `name=value` of the column `extra`.
    pub fn extra(&self, name: &str) -> Option<&str> {
        let pairs = self.text("extra").split(';').filter_map(|pair| pair.split_once('='));
        pairs.map(|(n, value)| (n.trim(), value.trim())).find(|p| p.0 == name).map(|p| p.1)
    }

    /// A number that must be there.
    pub fn number(&self, name: &str) -> Result<f64> {
        let text = self.text(name);
        let place = if COLUMNS.contains(&name) { "" } else { " in extra" };
        text.parse().map_err(|_| anyhow!("{name}{place} is '{text}'; allowed: a number"))
    }

    /// A number, or what stands for an empty cell.
    pub fn number_or(&self, name: &str, default: f64) -> Result<f64> {
        if self.text(name).is_empty() { Ok(default) } else { self.number(name) }
    }
}
