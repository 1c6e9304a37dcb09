//! `exact --cases`: a table of questions, each medium solved once.

mod critical;
mod fresnel;
mod half_space;
mod infinite;
mod kernel;
mod row;
mod slab;
mod sphere;

use crate::answer::shortest;
use crate::format::{Format, aligned, printed};
use crate::text::one_line;
use anyhow::{Context, Error, Result, anyhow, bail};
use row::{COLUMNS, Row};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::path::Path;
use turbid_analytic::Value;

/// A value, or why there is none.
pub type Answered = std::result::Result<Value, String>;

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
    let mut media = Media::default();
    let mut refused: Vec<(u64, String)> = Vec::new();
    for i in order {
        let row = &rows[i];
        answers[i] = Some(match media.answer_typed(row) {
            Err(error) if error.is::<turbid_analytic::Error>() => {
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

/// All that has been solved so far.
#[derive(Default)]
struct Media {
    slabs: slab::Slabs,
    fresnel_slabs: fresnel::FresnelSlabs,
    half_spaces: half_space::HalfSpaces,
    spheres: sphere::Spheres,
    critical: critical::Bodies,
    infinite: infinite::Media,
}

impl Media {
    fn answer(&mut self, row: &Row) -> Result<Answered> {
        match row.text("geometry") {
            "slab" | "slabXY" => slab::answer(row, &mut self.slabs),
            "slab_fresnel" => fresnel::answer(row, &mut self.fresnel_slabs),
            "halfspace" => half_space::answer(row, &mut self.half_spaces),
            "sphere" => sphere::answer(row, &mut self.spheres),
            "critical_slab" | "critical_sphere" => critical::answer(row, &mut self.critical),
            "infinite" => infinite::answer(row, &mut self.infinite),
            "kernel" => kernel::answer(row),
            other => Ok(Err(format!("geometry {other} is not answered here; allowed: {GEOMETRIES}"))),
        }
    }

    /// Answers with a bound that holds for the decimals in the row.
    fn answer_typed(&mut self, row: &Row) -> Result<Answered> {
        let mut answer = self.answer(row)?;
        if let (Ok(value), Some(typed)) = (&mut answer, row.typed()) {
            typed.widen(&mut [value], |to| Ok(self.answer(&row.moved("w", to))?.ok().map(|v| vec![v])))?;
        }
        Ok(answer)
    }
}

const GEOMETRIES: &str =
    "slab, slabXY, slab_fresnel, halfspace, sphere, infinite, critical_slab, critical_sphere, kernel";

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
