//! One question of a table: its cells by column name.

use crate::answer::shortest;
use crate::read::{dimension, incidence};
use crate::typed::Typed;
use anyhow::{Result, anyhow, bail};
use turbid_analytic::{Dimension, Incidence};

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
    /// A cell, without blanks around it.
    pub fn text(&self, column: &str) -> &str {
        COLUMNS.iter().position(|c| *c == column).map_or("", |i| self.fields[i].trim())
    }

    /// The same question with another number in one column.
    pub fn moved(&self, column: &str, to: f64) -> Self {
        let mut fields = self.fields.clone();
        if let Some(i) = COLUMNS.iter().position(|c| *c == column) {
            fields[i] = shortest(to);
        }
        Row { line: self.line, fields }
    }

    /// The parameters that rounding touches; cells that do not matter may be empty.
    pub fn typed(&self) -> Option<Typed> {
        let cell = |column: &str| self.text(column).parse::<f64>().ok();
        Some(match self.text("geometry") {
            "kernel" => return None,
            "critical_slab" | "critical_sphere" => Typed { secondaries: cell("w"), ..Typed::default() },
            _ => Typed {
                albedo: cell("w"),
                g: if self.extra("phase").is_some() { None } else { Some(cell("g").unwrap_or(0.0)) },
                index: cell("n"),
                size: cell("tau").or(cell("a")),
                places: cell("t").into_iter().chain(cell("r")).collect(),
                ..Typed::default()
            },
        })
    }

    /// A number that must be there.
    pub fn number(&self, column: &str) -> Result<f64> {
        let text = self.text(column);
        text.parse().map_err(|_| anyhow!("{column} is '{text}'; allowed: a number"))
    }

    /// A number, or what stands for an empty cell.
    pub fn number_or(&self, column: &str, default: f64) -> Result<f64> {
        if self.text(column).is_empty() { Ok(default) } else { self.number(column) }
    }

    /// A `name=value` of the column `extra`.
    pub fn extra(&self, name: &str) -> Option<&str> {
        let pairs = self.text("extra").split(';').filter_map(|pair| pair.split_once('='));
        pairs.map(|(n, value)| (n.trim(), value.trim())).find(|p| p.0 == name).map(|p| p.1)
    }

    /// A number in the column `extra` that must be there.
    pub fn extra_number(&self, name: &str) -> Result<f64> {
        let text = self.extra(name).unwrap_or("");
        text.parse().map_err(|_| anyhow!("{name} in extra is '{text}'; allowed: a number"))
    }

    /// A whole number in the column `extra`, if it is there.
    pub fn extra_whole(&self, name: &str, allowed: std::ops::RangeInclusive<u32>) -> Result<Option<u32>> {
        let Some(text) = self.extra(name) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(n)
                if n.fract() == 0.0
                    && (f64::from(*allowed.start())..=f64::from(*allowed.end())).contains(&n) =>
            {
                Ok(Some(n as u32))
            }
            _ => {
                bail!("{name} in extra is '{text}'; allowed: {} to {}, whole", allowed.start(), allowed.end())
            }
        }
    }

    /// The dimension in the column `extra`.
    pub fn dimension(&self) -> Result<Dimension> {
        dimension(self.extra("d").unwrap_or("")).map_err(|e| anyhow!("{e}"))
    }

    /// How the light falls, from this column.
    pub fn incidence(&self, column: &str) -> Result<Incidence> {
        incidence(self.text(column)).map_err(|e| anyhow!("{e}"))
    }
}
