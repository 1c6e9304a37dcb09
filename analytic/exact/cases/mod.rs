//! `exact --cases`: a table of questions, each medium solved once.

mod closed;
mod geometry;
mod row;

use crate::answer::shortest;
use crate::asker::Asker;
use crate::format::{Format, aligned, printed};
use crate::text::one_line;
use crate::usage;
use anyhow::{Context, Error, Result, anyhow, bail};
use geometry::{GEOMETRIES, Geometry};
use row::{COLUMNS, Row};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::path::Path;
use turbid_analytic::Value;

/// A value, or why there is none.
type Answered = std::result::Result<Value, String>;

/// Reads the questions, answers them, writes them in the order of the file.
///
/// A parameter out of range leaves its row without a value, with the reason as its note; the first such row comes back
/// as the error to end with, once the other rows are written. A cell that cannot be read stops at once.
pub fn answer(path: &Path, format: Format, output: &mut Vec<u8>) -> Result<Option<Error>> {
    let name = path.display();
    let rows = read(path)?;
    // What a medium has solved serves all its rows: answer by medium, print in the order of the file.
    let mut order: Vec<usize> = (0..rows.len()).collect();
    let medium =
        |i: usize| ["geometry", "tau", "a", "n", "w", "g", "extra"].map(|column| rows[i].text(column));
    order.sort_by(|&a, &b| medium(a).cmp(&medium(b)));
    let mut answers: Vec<Option<Answered>> = rows.iter().map(|_| None).collect();
    let mut reader = Reader::default();
    let mut refused: Vec<(u64, String)> = Vec::new();
    for i in order {
        let row = &rows[i];
        answers[i] = Some(match reader.answer(row) {
            Err(error) if error.is::<turbid_analytic::Error>() || error.is::<Unanswered>() => {
                refused.push((row.line, format!("{error:#}")));
                Err(format!("{error:#}"))
            }
            answer => answer.with_context(|| format!("{name}:{}", row.line))?,
        });
    }
    let more = match refused.len() {
        0 | 1 => String::new(),
        n => format!(" (and {} more: their notes say why)", n - 1),
    };
    let first = refused.into_iter().min().map(|(line, why)| anyhow!("{name}:{line}: {why}{more}"));
    let mut answered = Vec::new();
    for (row, answer) in rows.iter().zip(answers) {
        match answer {
            Some(answer) => answered.push(Line { row, answer }),
            None => bail!("{name}:{}: no answer was made", row.line),
        }
    }
    write(&answered, format, output)?;
    Ok(first)
}

/// A question that was understood and that has no answer: it costs its row alone.
#[derive(Debug, thiserror::Error)]
#[error("{0:#}")]
struct Unanswered(Error);

/// Rows become questions here, and what they solve serves the next.
#[derive(Default)]
struct Reader {
    asker: Asker,
}

impl Reader {
    /// Answers with a bound that holds for the decimals in the row.
    fn answer(&mut self, row: &Row) -> Result<Answered> {
        if let Some(value) = closed::answer(row)? {
            return Ok(Ok(value));
        }
        let name = row.text("geometry");
        let Some(geometry) = GEOMETRIES.iter().find(|geometry| geometry.name == name) else {
            let allowed = GEOMETRIES.map(|geometry| geometry.name).join(", ");
            return Ok(Err(format!("geometry {name} is not answered here; allowed: {allowed}")));
        };
        let asked = match geometry.words(row)? {
            Ok(asked) => asked,
            Err(note) => return Ok(Err(note)),
        };
        let said =
            |error: &clap::Error| usage::of_cell(error, |option| geometry.column(option), Geometry::counts);
        let command = self.asker.command(asked.words, said)?;
        let answer = self.asker.answer(&command, Some(asked.wanted)).map_err(Unanswered)?;
        let value = answer.rows.first().map(|row| row.value);
        Ok(value.ok_or(asked.absent))
    }
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let name = path.display();
    let bytes = crate::input::read(path)?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let headers = reader.headers().map_err(|error| misread(&name.to_string(), &error))?.clone();
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = headers
            .iter()
            .position(|h| h.trim() == column)
            .ok_or_else(|| anyhow!("{name}:1: no column '{column}'; needed: {}", COLUMNS.join(",")))?;
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| misread(&name.to_string(), &error))?;
        let line = record.position().map_or(0, csv::Position::line);
        rows.push(Row { line, fields: places.map(|p| one_line(record.get(p).unwrap_or(""))) });
    }
    Ok(rows)
}

/// Which line cannot be read, and why.
fn misread(name: &str, error: &csv::Error) -> anyhow::Error {
    let line = error.position().map_or(0, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            anyhow!("{name}:{line}: {len} cells; allowed: {expected_len}, as in the first line")
        }
        csv::ErrorKind::Utf8 { .. } => anyhow!("{name}:{line}: not text; allowed: UTF-8"),
        _ => anyhow!("{name}:{line}: {error}"),
    }
}

/// A question beside its answer.
struct Line<'a> {
    row: &'a Row,
    answer: Answered,
}

impl Line<'_> {
    fn note(&self) -> &str {
        self.answer.as_ref().err().map_or("", String::as_str)
    }
}

impl Serialize for Line<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", self.row.text("id"))?;
        for column in COLUMNS.iter().skip(1).filter(|column| !self.row.text(column).is_empty()) {
            // Numbers as numbers; words such as `diffuse` as words.
            match self.row.text(column).parse::<f64>() {
                Ok(number) if number.is_finite() => map.serialize_entry(column, &number)?,
                _ => map.serialize_entry(column, self.row.text(column))?,
            }
        }
        match &self.answer {
            Ok(value) => {
                map.serialize_entry("value", &value.value)?;
                map.serialize_entry("error", &value.error)?;
                map.serialize_entry("method", value.method)?;
            }
            Err(note) => {
                map.serialize_entry("value", &None::<f64>)?;
                map.serialize_entry("note", note)?;
            }
        }
        map.end()
    }
}

fn write(lines: &[Line<'_>], format: Format, output: &mut Vec<u8>) -> Result<()> {
    match format {
        Format::Json => {
            serde_json::to_writer_pretty(&mut *output, lines)?;
            output.push(b'\n');
        }
        Format::Csv => {
            let mut writer = csv::Writer::from_writer(output);
            let head = ["id", "value", "error", "method", "note"].into_iter();
            writer.write_record(head.chain(COLUMNS.into_iter().skip(1)))?;
            for line in lines {
                let cells = match &line.answer {
                    Ok(v) => [format!("{:e}", v.value), shortest(v.error), v.method.to_string()],
                    Err(_) => Default::default(),
                };
                let [value, error, method] = &cells;
                let known = [line.row.text("id"), value, error, method, line.note()].into_iter();
                writer
                    .write_record(known.chain(COLUMNS.iter().skip(1).map(|column| line.row.text(column))))?;
            }
            writer.flush()?;
        }
        Format::Table => {
            let cells = |line: &Line<'_>| {
                let mut cells = ["id", "quantity"].map(|column| line.row.text(column).to_string()).to_vec();
                cells.extend(match &line.answer {
                    Ok(v) => {
                        let (value, error) = printed(*v);
                        [value, error, v.method.to_string()]
                    }
                    Err(note) => [String::new(), String::new(), note.clone()],
                });
                cells
            };
            let head = ["id", "quantity", "value", "error", "how known"];
            aligned(&head, &lines.iter().map(cells).collect::<Vec<_>>(), output)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row with something in every cell, and in every name of `extra`; some of it replaced.
    fn row(geometry: &str, quantity: &str, other: &[(&str, &str)]) -> Row {
        let (w, n) = match geometry {
            "critical_slab" | "critical_sphere" => ("1.3", "1"),
            "slab_fresnel" => ("0.9", "1.5"),
            _ => ("0.9", "1"),
        };
        let mut cells = vec![
            ("id", "1"),
            ("geometry", geometry),
            ("tau", "1"),
            ("a", "1.0"),
            ("w", w),
            ("g", "0"),
            ("n", n),
            ("mu0", "0.5"),
            ("t", "5e-1"),
            ("r", "0.5"),
            ("mu", "0.25"),
            ("dphi", "0"),
            ("quantity", quantity),
            ("kernel", "uniform"),
            ("d", "3.0"),
            ("b_r", "0.1"),
            ("x_over_r", "0.1"),
            ("s", "1"),
            ("layers", "tau=1,albedo=0.9,index=1.4|tau=0,albedo=0,index=1.5"),
            ("ground", "0.5"),
            ("ground_index", "1.5"),
        ];
        for &(name, text) in other {
            cells.retain(|cell| cell.0 != name);
            cells.push((name, text));
        }
        let extra = cells.iter().filter(|(name, _)| !COLUMNS.contains(name));
        let extra: Vec<String> = extra.map(|(name, text)| format!("{name}={text}")).collect();
        let fields = COLUMNS.map(|column| match cells.iter().find(|cell| cell.0 == column) {
            Some((_, text)) => text.to_string(),
            None => extra.join("; "),
        });
        Row { line: 2, fields }
    }

    #[test]
    fn every_quantity_of_every_geometry_is_answered() {
        let mut reader = Reader::default();
        let mut count = 0;
        for geometry in &GEOMETRIES {
            for name in geometry.names() {
                let (quantity, other) = match name.strip_suffix(" by order") {
                    Some(quantity) => (quantity, [("order", "1.0")].as_slice()),
                    None => (name, [].as_slice()),
                };
                let value = reader.answer(&row(geometry.name, quantity, other)).unwrap();
                let value = value.unwrap_or_else(|note| panic!("{} {name}: {note}", geometry.name));
                assert!(value.value.is_finite() && value.error.is_finite(), "{} {name}", geometry.name);
                count += 1;
            }
        }
        assert_eq!(count, 120);
    }

    /// Of every column that a geometry takes: a word in place of a number, two values, and a word that is an option.
    #[test]
    fn every_column_of_every_geometry_is_read() {
        let mut reader = Reader::default();
        for geometry in &GEOMETRIES {
            for column in geometry.column_names().filter(|column| *column != "order") {
                let quantity = geometry.names().next().unwrap();
                for text in ["x", "0.1,0.2", "--help"] {
                    let said = reader.answer(&row(geometry.name, quantity, &[(column, text)])).unwrap_err();
                    let said = said.to_string();
                    assert!(
                        said.contains(&format!("is '{text}'; allowed: ")),
                        "{} {column}: {said}",
                        geometry.name
                    );
                }
            }
        }
    }
}
