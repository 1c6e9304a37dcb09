//! The rows of one layer, as a file gives them.

use super::{Column, Numbers};
use crate::error::Error;

/// Rows with the lines they stand in.
#[derive(Default)]
pub(super) struct Rows {
    pub kind: String,
    pub label: String,
    pub lines: Vec<usize>,
    pub numbers: Vec<Numbers>,
}

impl Rows {
    pub(super) fn problem(&self, row: usize, problem: String) -> Error {
        Error::Csv { line: self.lines.get(row).copied().unwrap_or_default(), column: None, problem }
    }

    /// The numbers of a column, one in each row.
    pub(super) fn column(&self, column: Column) -> Result<Vec<f64>, Error> {
        let one = |(row, numbers): (usize, &Numbers)| {
            numbers[column as usize].ok_or_else(|| {
                let (name, kind) = (column.name(), &self.kind);
                self.problem(
                    row,
                    format!("column {name} is empty; allowed: a number in every row of a {kind} layer"),
                )
            })
        };
        self.numbers.iter().enumerate().map(one).collect()
    }

    /// (low, high) of every row.
    pub(super) fn intervals(&self, low: Column, high: Column) -> Result<Vec<(f64, f64)>, Error> {
        Ok(self.column(low)?.into_iter().zip(self.column(high)?).collect())
    }

    /// (low, high) of every row, or of none.
    pub(super) fn optional(&self, low: Column, high: Column) -> Result<Option<Vec<(f64, f64)>>, Error> {
        if self.is_empty(low) && self.is_empty(high) { Ok(None) } else { self.intervals(low, high).map(Some) }
    }

    pub(super) fn is_empty(&self, column: Column) -> bool {
        self.numbers.iter().all(|n| n[column as usize].is_none())
    }

    /// Refuses numbers in other columns than these: they would be lost.
    pub(super) fn only(&self, allowed: &[Column]) -> Result<(), Error> {
        for (row, numbers) in self.numbers.iter().enumerate() {
            let other = |c: &&Column| !allowed.contains(c) && numbers[**c as usize].is_some();
            if let Some(column) = Column::ALL.iter().find(other) {
                let names: Vec<&str> = allowed.iter().map(|c| c.name()).collect();
                return Err(self.problem(
                    row,
                    format!(
                        "column {} is filled; allowed for a {} layer: {}",
                        column.name(),
                        self.kind,
                        names.join(", ")
                    ),
                ));
            }
        }
        Ok(())
    }

    /// The single row of a rule or a note.
    pub(super) fn single(&self) -> Result<&Numbers, Error> {
        match self.numbers.as_slice() {
            [only] => Ok(only),
            _ => Err(self.problem(1, format!("a second row; allowed for a {} layer: one", self.kind))),
        }
    }
}
