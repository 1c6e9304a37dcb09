//! Tables of others: CSV with a line of names, read strictly.

use anyhow::{Context, bail, ensure};
use std::collections::BTreeMap;

/// Most rows that a table may have.
const MOST_ROWS: usize = 100_000;

/// A table of published numbers.
#[derive(Debug, Clone)]
pub struct Published {
    name: String,
    columns: BTreeMap<String, usize>,
    /// Line of the file, then its fields.
    rows: Vec<(u64, Vec<String>)>,
}

/// A row of a table.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    table: &'a Published,
    line: u64,
    fields: &'a [String],
}

impl Published {
    /// Reads a table; `name` is what messages call it, `needed` the columns that it must have.
    ///
    /// # Errors
    /// One line that names the table, and the line and column, for a missing or repeated column, a row of another length, no row
    /// or too many
    pub fn read(name: &str, text: &str, needed: &[&str]) -> anyhow::Result<Self> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().with_context(|| name.to_string())?.clone();
        let mut columns = BTreeMap::new();
        for (index, column) in header.iter().enumerate() {
            ensure!(
                columns.insert(column.to_string(), index).is_none(),
                "{name}, line 1: two columns are called {column}; allowed: one"
            );
        }
        for column in needed {
            ensure!(
                columns.contains_key(*column),
                "{name}, line 1: there is no column {column}; needed: {}",
                needed.join(", ")
            );
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            // The position in bytes that the reader's own text has tells nobody anything.
            let record = match record {
                Ok(record) => record,
                Err(error) => match error.kind() {
                    csv::ErrorKind::UnequalLengths { pos, expected_len, len } => bail!(
                        "{name}, line {}: {len} fields; needed: {expected_len}, as in line 1",
                        pos.as_ref().map_or(0, csv::Position::line)
                    ),
                    csv::ErrorKind::Utf8 { pos, .. } => bail!(
                        "{name}, line {}: not UTF-8; allowed: plain text",
                        pos.as_ref().map_or(0, csv::Position::line)
                    ),
                    _ => return Err(error).context(name.to_string()),
                },
            };
            ensure!(rows.len() < MOST_ROWS, "{name}: more than {MOST_ROWS} rows; allowed: at most so many");
            let line = record.position().map_or(0, csv::Position::line);
            rows.push((line, record.iter().map(str::to_string).collect()));
        }
        ensure!(!rows.is_empty(), "{name}: no rows; needed: at least one below the names of the columns");
        Ok(Published { name: name.to_string(), columns, rows })
    }

    /// Its rows.
    pub fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        self.rows.iter().map(|(line, fields)| Entry { table: self, line: *line, fields })
    }
}

impl<'a> Entry<'a> {
    /// The text of a column.
    ///
    /// # Errors
    /// If the table has no such column
    pub fn text(&self, column: &str) -> anyhow::Result<&'a str> {
        let index = self.table.columns.get(column);
        let index = index.with_context(|| format!("{}: there is no column {column}", self.table.name))?;
        Ok(&self.fields[*index])
    }

    /// The number of a column.
    ///
    /// # Errors
    /// One line that names table, line and column, unless it is a finite number
    pub fn number(&self, column: &str) -> anyhow::Result<f64> {
        let number = self.text(column)?.parse::<f64>().ok().filter(|x| x.is_finite());
        number.with_context(|| self.refused(column, "a finite number"))
    }

    /// The number of a column that is an error.
    ///
    /// # Errors
    /// As [`Entry::number`], unless it is at least 0
    pub fn not_negative(&self, column: &str) -> anyhow::Result<f64> {
        let number = Some(self.number(column)?).filter(|&x| x >= 0.0);
        number.with_context(|| self.refused(column, "at least 0"))
    }

    /// A line that says where and what a column is, and what is allowed.
    pub fn refused(&self, column: &str, allowed: &str) -> String {
        let text = self.text(column).unwrap_or_default();
        format!(
            "{}, line {}: {column} is {}; allowed: {allowed}",
            self.table.name,
            self.line,
            turbid::output::one_line(if text.is_empty() { "empty" } else { text })
        )
    }

    /// A fraction such as 10/99, or a number.
    ///
    /// # Errors
    /// As [`Entry::number`]
    pub fn fraction(&self, column: &str) -> anyhow::Result<f64> {
        match self.text(column)?.split_once('/').map(|(a, b)| (a.parse::<f64>(), b.parse::<f64>())) {
            Some((Ok(a), Ok(b))) if (a / b).is_finite() => Ok(a / b),
            _ => self.number(column),
        }
    }

    /// A rounded number and the standard deviation of its rounding: a unit of the last digit over the root of 12.
    ///
    /// # Errors
    /// As [`Entry::number`]
    pub fn rounded(&self, column: &str) -> anyhow::Result<(f64, f64)> {
        let value = self.number(column)?;
        let text = self.text(column)?.to_ascii_lowercase();
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
        let power: i32 = power.parse().with_context(|| format!("{}, line {}", self.table.name, self.line))?;
        Ok((value, libm::exp10(f64::from(power) - decimals as f64) / libm::sqrt(12.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_read_from_the_digits() {
        let table = Published::read("t", "a,b\n0.48652,10/99\n8.97798e-01,2\n", &["a"]).unwrap();
        let entries: Vec<Entry> = table.entries().collect();
        let unit = |i: usize| entries[i].rounded("a").unwrap().1 * libm::sqrt(12.0);
        assert!((unit(0) / 1e-5 - 1.0).abs() < 1e-12 && (unit(1) / 1e-6 - 1.0).abs() < 1e-12);
        assert!((entries[0].fraction("b").unwrap() - 10.0 / 99.0).abs() < 1e-16);
        assert!((entries[1].fraction("b").unwrap() - 2.0).abs() < 1e-16);
    }

    /// Each gets one line that says where.
    #[test]
    fn hostile_tables() {
        let million = format!("a,b\n{}", "1,2\n".repeat(1_000_000));
        for (text, words) in [
            ("", "there is no column a"),
            ("b,c\n1,2\n", "there is no column a; needed: a, b"),
            ("a,a\n1,2\n", "two columns are called a"),
            ("a,b\n", "no rows"),
            ("a,b\n1,2\n1\n", "line 3: 1 fields; needed: 2"),
            ("a,b\n1,2\nNaN,2\n", "line 3: a is NaN; allowed: a finite number"),
            ("a,b\n1,2\n,2\n", "line 3: a is empty"),
            ("a,b\ninf,2\n", "line 2: a is inf"),
            ("a,b\n\"x\ny\",2\n", "a is x"),
            (&million, "more than 100000 rows"),
        ] {
            let read = Published::read("t.csv", text, &["a", "b"]);
            let error =
                read.and_then(|t| t.entries().map(|e| e.number("a")).collect::<anyhow::Result<Vec<_>>>());
            let error = format!("{:#}", error.unwrap_err());
            assert!(error.contains(words) && error.starts_with("t.csv"), "{error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
