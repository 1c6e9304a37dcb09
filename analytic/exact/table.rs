//! A small table: quantity, value, error, how known.

use std::io::{self, Write};
use turbid_analytic::Value;

/// Rows in the order in which they were added.
#[derive(Default)]
pub struct Table {
    rows: Vec<[String; 4]>,
}

impl Table {
    /// Adds a row.
    pub fn add(&mut self, quantity: impl Into<String>, value: Value) {
        let error = format!("{:.1e}", value.error);
        self.rows.push([quantity.into(), format!("{:e}", value.value), error, value.method.into()]);
    }

    /// Prints aligned columns.
    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let head = ["quantity", "value", "error", "how known"].map(String::from);
        let rows = || std::iter::once(&head).chain(&self.rows);
        let width = |c: usize| rows().map(|r| r[c].chars().count()).max().unwrap_or(0);
        let (a, b, c) = (width(0), width(1), width(2));
        for [quantity, value, error, method] in rows() {
            writeln!(out, "{quantity:a$}  {value:b$}  {error:c$}  {method}")?;
        }
        Ok(())
    }
}
