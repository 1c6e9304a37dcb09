//! Tables of measured quantities, as aligned text, CSV or JSON.

use super::one_line;
use crate::sensor::{Measurement, NoError};
use serde::Serialize;
use std::io::{self, Write};

/// The form of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Aligned columns to read.
    Text,
    /// Comma-separated values with a header; every bit is kept.
    Csv,
    /// An object with the version of its form, the run, and a list of objects, the rows; every bit is kept.
    Json,
}

/// The version of a table as JSON: 1 was the rows alone, 2 called the numbers of bins i, j and k.
const FORMAT: u32 = 3;

/// What the numbers of a table were made with, the same in all rows: columns behind theirs as CSV, an object beside them as JSON.
/// None of what the method does not ask.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RunInfo {
    /// The method.
    pub with: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Orders that count, beside each sensor's own.
    pub orders: String,
    /// Paths a sensor or bin.
    pub samples: Option<u64>,
    /// Whether weight windows split and end them.
    pub weight_windows: Option<bool>,
    /// Photons that said where light comes from, for paths to be led there.
    pub guide: Option<u64>,
    /// Photons emitted, for all maps together.
    pub photons: Option<u64>,
    /// Independent maps.
    pub maps: Option<u64>,
    /// Radius of an estimate \[L\].
    pub radius: Option<f64>,
    /// Photons of an estimate.
    pub k: Option<usize>,
    /// The farthest that they are sought \[L\].
    pub max_radius: Option<f64>,
    /// Radius about whole rays that are read at once \[L\].
    pub ray_radius: Option<f64>,
    /// Which nearest photon sets the radius that each has about rays, at most that one.
    pub ray_k: Option<usize>,
    /// The same about rays across which flights pass, as beams \[L\].
    pub beam_radius: Option<f64>,
    /// In how many dimensions beams are blurred.
    pub beam_blur: Option<String>,
    /// How far they go.
    pub beam_length: Option<String>,
    /// Whether fluence is read from them too.
    pub beam_fluence: Option<bool>,
    /// Where rays that are read at once end, if not cut at faces.
    pub ray_ends: Option<String>,
    /// Whether light scattered twice and more is read from planes of flights.
    pub planes: Option<bool>,
    /// Whether these radii are those of the first map, and shrink from map to map.
    pub progressive: Option<bool>,
    /// How an estimate weights its photons.
    pub kernel: Option<String>,
    /// What it does where a medium ends.
    pub boundary: Option<String>,
    /// Which photons behind walls it leaves out.
    pub reject: Option<String>,
    /// Version of the program.
    pub version: String,
    /// Revision of its sources, where it is known.
    pub revision: Option<String>,
}

/// Writes rows in the given form; where sensors have bins, with the numbers of the bin along each axis and its middle. CSV and JSON
/// tell of their run.
///
/// # Errors
/// Those of the writer.
pub fn write_rows(
    out: &mut dyn Write,
    rows: &[Measurement],
    run: &RunInfo,
    format: Format,
) -> io::Result<()> {
    if rows.iter().any(|row| row.bin.is_some()) {
        return write_bins(out, rows, run, format);
    }
    match format {
        Format::Text => write_text(out, rows),
        Format::Csv if rows.is_empty() => {
            writeln!(out, "{},why,{}", COLUMNS.join(","), RUN_COLUMNS.join(","))
        }
        Format::Csv => write_csv(out, rows.iter().map(|row| (row, run))),
        Format::Json => write_json(out, &Document { format: FORMAT, run, rows }),
    }
}

/// A table as JSON.
#[derive(Serialize)]
struct Document<'a, T> {
    format: u32,
    run: &'a RunInfo,
    rows: T,
}

const COLUMNS: [&str; 6] = ["sensor", "quantity", "unit", "mean", "std_error", "n"];

const RUN_COLUMNS: [&str; 25] = [
    "with",
    "seed",
    "orders",
    "samples",
    "weight_windows",
    "guide",
    "photons",
    "maps",
    "radius",
    "k",
    "max_radius",
    "ray_radius",
    "ray_k",
    "beam_radius",
    "beam_blur",
    "beam_length",
    "beam_fluence",
    "ray_ends",
    "planes",
    "progressive",
    "kernel",
    "boundary",
    "reject",
    "version",
    "revision",
];

fn write_text(out: &mut dyn Write, rows: &[Measurement]) -> io::Result<()> {
    let mut lines = vec![COLUMNS.map(str::to_string)];
    for r in rows {
        let numbers =
            (format!("{:.6e}", r.mean), r.std_error.map_or_else(|| word(r), |e| format!("{e:.1e}")));
        lines.push([
            r.sensor.clone(),
            r.quantity.clone(),
            r.unit.to_string(),
            numbers.0,
            numbers.1,
            r.n.to_string(),
        ]);
    }
    write_aligned(out, &lines, 3)
}

/// A row with its bin; what has none has no numbers there.
#[derive(Serialize)]
struct BinRow<'a> {
    sensor: &'a str,
    quantity: &'a str,
    unit: &'static str,
    bin_i: Option<usize>,
    bin_j: Option<usize>,
    bin_k: Option<usize>,
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    mean: f64,
    std_error: Option<f64>,
    n: u64,
    why: Option<NoError>,
}

const BIN_COLUMNS: [&str; 12] =
    ["sensor", "quantity", "unit", "bin_i", "bin_j", "bin_k", "x", "y", "z", "mean", "std_error", "n"];

fn write_bins<'a>(
    out: &mut dyn Write,
    rows: &'a [Measurement],
    run: &RunInfo,
    format: Format,
) -> io::Result<()> {
    let index = |r: &Measurement, axis: usize| r.bin.map(|bin| bin.index[axis]);
    let middle = |r: &Measurement, axis: usize| r.bin.and_then(|bin| bin.middle).map(|p| p[axis]);
    let whole = |r: &'a Measurement| BinRow {
        sensor: &r.sensor,
        quantity: &r.quantity,
        unit: r.unit,
        bin_i: index(r, 0),
        bin_j: index(r, 1),
        bin_k: index(r, 2),
        x: middle(r, 0),
        y: middle(r, 1),
        z: middle(r, 2),
        mean: r.mean,
        std_error: r.std_error,
        n: r.n,
        why: r.no_error,
    };
    match format {
        Format::Csv => write_csv(out, rows.iter().map(|row| (whole(row), run))),
        Format::Json => write_json(
            out,
            &Document { format: FORMAT, run, rows: rows.iter().map(whole).collect::<Vec<_>>() },
        ),
        Format::Text => {
            let number = |n: Option<usize>| n.map_or_else(String::new, |n| n.to_string());
            let place = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.4}"));
            let line = |row: usize| {
                let Some(r) = row.checked_sub(1).map(|row| &rows[row]) else {
                    return BIN_COLUMNS.map(str::to_string);
                };
                [
                    r.sensor.clone(),
                    r.quantity.clone(),
                    r.unit.to_string(),
                    number(index(r, 0)),
                    number(index(r, 1)),
                    number(index(r, 2)),
                    place(middle(r, 0)),
                    place(middle(r, 1)),
                    place(middle(r, 2)),
                    format!("{:.6e}", r.mean),
                    r.std_error.map_or_else(|| word(r), |e| format!("{e:.1e}")),
                    r.n.to_string(),
                ]
            };
            write_aligned_lines(out, rows.len() + 1, line, 3)
        }
    }
}

/// What stands in the place of a standard error that is not known.
fn word(r: &Measurement) -> String {
    r.no_error.map_or_else(String::new, |why| why.word().into())
}

/// Writes lines of cells in aligned columns, the first `words` of them flush left and the others flush right; see [`one_line`].
///
/// # Errors
/// Those of the writer.
pub fn write_aligned<const N: usize>(
    out: &mut dyn Write,
    lines: &[[String; N]],
    words: usize,
) -> io::Result<()> {
    write_aligned_lines(out, lines.len(), |line| lines[line].clone(), words)
}

/// The same of lines that are made when they are asked for, twice, so that many of them take no memory.
fn write_aligned_lines<const N: usize>(
    out: &mut dyn Write,
    lines: usize,
    line: impl Fn(usize) -> [String; N],
    words: usize,
) -> io::Result<()> {
    let line = |number: usize| line(number).map(|cell| one_line(&cell));
    let mut widths = [0; N];
    for number in 0..lines {
        let cells = line(number);
        widths.iter_mut().zip(&cells).for_each(|(width, cell)| *width = cell.chars().count().max(*width));
    }
    for number in 0..lines {
        let mut text = String::new();
        for (column, (cell, width)) in line(number).iter().zip(widths).enumerate() {
            let cell = if column < words { format!("{cell:<width$}  ") } else { format!("{cell:>width$}  ") };
            text.push_str(&cell);
        }
        writeln!(out, "{}", text.trim_end())?;
    }
    Ok(())
}

/// Writes any rows as CSV, with a header from their field names; every bit of an f64 is kept.
///
/// # Errors
/// Those of the writer, and rows that are not flat.
pub fn write_csv<T: Serialize>(out: &mut dyn Write, rows: impl IntoIterator<Item = T>) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    for row in rows {
        csv.serialize(row).map_err(into_io)?;
    }
    csv.flush()
}

/// The error of the writer underneath, so that a closed pipe still looks like one.
fn into_io(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(cause) => cause,
        kind => io::Error::other(format!("{kind:?}")),
    }
}

/// Writes any value as indented JSON with a final newline; every bit of a finite f64 is kept.
///
/// # Errors
/// Those of the writer.
pub fn write_json<T: Serialize + ?Sized>(out: &mut dyn Write, value: &T) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, value)?;
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Bin;

    fn row(mean: f64, std_error: f64) -> Measurement {
        Measurement {
            sensor: "probe, centre".into(),
            quantity: "fluence".into(),
            unit: "W/L^2",
            mean,
            std_error: (std_error > 0.0).then_some(std_error),
            n: 64,
            no_error: None,
            bin: None,
            spread: crate::sensor::Spread::default(),
        }
    }

    fn in_bins() -> [Measurement; 3] {
        let bin = |index, middle| Measurement { bin: Some(Bin { index, middle }), ..row(1.0 / 3.0, 0.1) };
        [bin([1, 2, 0], Some([0.1, -2.0, 1e-300])), bin([0, 0, 0], None), row(2.0, 0.0)]
    }

    #[test]
    fn bins_have_columns_of_their_own() {
        let text = |format| text(&in_bins(), format);
        let csv = text(Format::Csv);
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], [&BIN_COLUMNS.join(","), "why", &RUN_COLUMNS.join(",")].join(","));
        let names: std::collections::BTreeSet<&str> = lines[0].split(',').collect();
        assert_eq!(names.len(), lines[0].split(',').count(), "two columns of one name");
        let run = ",,light,7,0..,,,,1000,,,50,,,,,,,,,,,cone,,,0.1.0,";
        assert_eq!(
            lines[1],
            format!("\"probe, centre\",fluence,W/L^2,1,2,0,0.1,-2.0,1e-300,0.3333333333333333,0.1,64{run}")
        );
        assert_eq!(
            lines[2],
            format!("\"probe, centre\",fluence,W/L^2,0,0,0,,,,0.3333333333333333,0.1,64{run}")
        );
        assert_eq!(lines[3], format!("\"probe, centre\",fluence,W/L^2,,,,,,,2.0,,64{run}"));
        let json: serde_json::Value = serde_json::from_str(&text(Format::Json)).unwrap();
        assert_eq!((json["format"].as_u64(), json["run"]["seed"].as_u64()), (Some(3), Some(7)));
        assert!(json["run"]["radius"].is_null() && json["run"]["kernel"] == "cone");
        let json = &json["rows"];
        assert_eq!((json[0]["bin_j"].as_u64(), json[0]["z"].as_f64()), (Some(2), Some(1e-300)));
        assert!(json[1]["x"].is_null() && json[2]["bin_i"].is_null());
        let table = text(Format::Text);
        assert!(table.lines().next().unwrap().contains(" bin_i  bin_j  bin_k "), "{table}");
        assert_eq!(table.lines().count(), 4);
    }

    fn run() -> RunInfo {
        RunInfo {
            with: "light".into(),
            seed: 7,
            orders: "0..".into(),
            photons: Some(1000),
            k: Some(50),
            kernel: Some("cone".into()),
            version: "0.1.0".into(),
            ..RunInfo::default()
        }
    }

    fn text(rows: &[Measurement], format: Format) -> String {
        let mut out = Vec::new();
        write_rows(&mut out, rows, &run(), format).unwrap();
        String::from_utf8(out).unwrap()
    }

    const AWKWARD: [f64; 7] =
        [0.1, 1.0 / 3.0, 5e-324, 1.797_693_134_862_315_7e308, -0.0, 1e-12, 123_456_789.123_456_79];

    #[test]
    fn csv_keeps_every_bit() {
        for x in AWKWARD.into_iter().chain([f64::INFINITY, f64::NAN]) {
            let text = text(&[row(x, 1.0)], Format::Csv);
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            assert_eq!(reader.headers().unwrap(), [&COLUMNS[..], &["why"], &RUN_COLUMNS].concat());
            let record = reader.records().next().unwrap().unwrap();
            assert_eq!(&record[0], "probe, centre");
            let back: f64 = record[3].parse().unwrap();
            assert!(back.to_bits() == x.to_bits() || x.is_nan() && back.is_nan());
        }
    }

    #[test]
    fn a_missing_error_has_its_word() {
        for why in [NoError::OneMap, NoError::Nothing, NoError::TooFew, NoError::HeavyTail] {
            let rows = [Measurement { no_error: Some(why), ..row(1.0, 0.0) }];
            assert!(text(&rows, Format::Csv).contains(&format!(",,64,{},light", why.word())));
            assert!(text(&rows, Format::Json).contains(&format!("\"why\": \"{}\"", why.word())));
        }
    }

    #[test]
    fn json_keeps_every_bit_and_knows_no_error_from_an_error_of_zero() {
        for x in AWKWARD {
            let value: serde_json::Value = serde_json::from_str(&text(&[row(x, 1.0)], Format::Json)).unwrap();
            assert_eq!(value["rows"][0]["mean"].as_f64().unwrap().to_bits(), x.to_bits());
        }
        assert!(text(&[row(1.0, 0.0)], Format::Json).contains("\"std_error\": null"));
    }

    #[test]
    fn text_is_aligned() {
        let text = text(&[row(0.25, 1e-3), row(-12.5, 2e-10)], Format::Text);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|l| l.len() == lines[0].len()), "{text}");
        assert!(lines[1].contains("2.500000e-1") && lines[1].contains("1.0e-3"));
    }

    #[test]
    fn no_rows_are_still_a_table() {
        let columns = [&COLUMNS.join(","), "why", &RUN_COLUMNS.join(",")].join(",");
        assert_eq!(text(&[], Format::Csv), format!("{columns}\n"));
        assert!(text(&[], Format::Json).contains("\"rows\": []"));
    }

    #[test]
    fn a_closed_pipe_is_recognised_through_csv_and_json() {
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        for format in [Format::Text, Format::Csv, Format::Json] {
            let error = write_rows(&mut Closed, &[row(1.0, 1.0)], &run(), format).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::BrokenPipe, "{format:?}");
        }
    }
}
