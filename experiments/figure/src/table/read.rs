//! From the file to a figure.

use super::header::{FigureLine, Header, PanelLine};
use super::layers::layer;
use super::rows::Rows;
use super::{Column, KEYS};
use crate::check;
use crate::error::Error;
use crate::figure::Figure;
use crate::text::Fonts;
use std::collections::BTreeMap;

/// The figure of a file, and its description.
pub(crate) fn read(text: &str) -> Result<(Figure, String), Error> {
    // Some programs put a mark of the encoding first.
    let text = text.trim_start_matches('\u{feff}');
    let header = Header::read(text)?;
    let description = match header.description {
        Some(value) => value.parse()?,
        None => String::new(),
    };
    let figure_line = header.required(header.figure, "figure")?;
    let mut rows = table(text, &header)?;
    let fonts = Fonts::load()?;
    let mut panels = Vec::new();
    for (p, value) in header.panels.iter().enumerate() {
        let mut panel = value.parse::<PanelLine>()?.panel();
        check::frame(p + 1, &panel, &fonts).map_err(|e| at_line(value.line, &e))?;
        for (l, look) in header.layers[p].iter().enumerate() {
            let Some(own) = rows.remove(&(p + 1, l + 1)) else {
                return Err(Error::Csv {
                    line: look.line,
                    column: None,
                    problem: format!("no row has panel {} and layer {}; allowed: one or more", p + 1, l + 1),
                });
            };
            let layer = layer(look, &own)?;
            check::layer(p + 1, &panel, &layer, &fonts).map_err(|e| {
                let line = e.row().and_then(|row| own.lines.get(row).copied());
                at_line(line.unwrap_or(look.line), &e)
            })?;
            panel.layers.push(layer);
        }
        panels.push(panel);
    }
    let figure = figure_line.parse::<FigureLine>()?.figure(panels);
    check::figure(&figure, &fonts).map_err(|e| at_line(figure_line.line, &e))?;
    Ok((figure, description))
}

fn at_line(line: usize, error: &Error) -> Error {
    Error::Csv { line, column: None, problem: error.to_string() }
}

/// The rows by panel and layer.
fn table(text: &str, header: &Header<'_>) -> Result<BTreeMap<(usize, usize), Rows>, Error> {
    let body: usize = text.split_inclusive('\n').take(header.lines).map(str::len).sum();
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .from_reader(&text.as_bytes()[body..]);
    let mut names: Option<Vec<String>> = None;
    let mut layers: BTreeMap<(usize, usize), Rows> = BTreeMap::new();
    for record in reader.records() {
        let line = |position: Option<&csv::Position>| {
            header.lines + position.map_or(1, |p| usize::try_from(p.line()).unwrap_or(usize::MAX))
        };
        let record = record.map_err(|e| Error::Csv {
            line: line(e.position()),
            column: None,
            problem: "the row cannot be read; allowed: UTF-8, cells parted by commas".to_owned(),
        })?;
        let line = line(record.position());
        let problem = |problem: String| Error::Csv { line, column: None, problem };
        let cells: Vec<&str> = record.iter().collect();
        let Some(names) = &names else {
            names = Some(head(&cells).map_err(problem)?);
            continue;
        };
        if cells.len() != names.len() {
            return Err(problem(format!("the row has {} cells; allowed: {}", cells.len(), names.len())));
        }
        let cell = |name: &str| names.iter().position(|n| n == name).map_or("", |i| cells[i]);
        let count = |name: &str| {
            let text = cell(name).trim();
            let wrong = || problem(format!("column {name} is {text:?}; allowed: a whole number from 1"));
            text.parse::<usize>().ok().filter(|n| *n > 0).ok_or_else(wrong)
        };
        let key = (count("panel")?, count("layer")?);
        let is_known = header.layers.get(key.0 - 1).is_some_and(|layers| key.1 <= layers.len());
        if !is_known {
            let (p, l) = key;
            return Err(problem(format!(
                "there is no layer {p}.{l}; allowed: those with a line # layer {p}.{l}: ..."
            )));
        }
        let rows = layers.entry(key).or_default();
        for (name, own) in [("kind", &mut rows.kind), ("label", &mut rows.label)] {
            if rows.lines.is_empty() {
                *own = cell(name).to_owned();
            } else if own != cell(name) {
                let first = rows.lines[0];
                return Err(problem(format!(
                    "column {name} is {:?}; allowed: {own:?}, as in line {first} of the same layer",
                    cell(name)
                )));
            }
        }
        let mut numbers = [None; 7];
        for column in Column::ALL {
            let text = cell(column.name()).trim();
            if text.is_empty() {
                continue;
            }
            match text.parse::<f64>() {
                Ok(v) if v.is_finite() => numbers[column as usize] = Some(v),
                _ => {
                    let name = column.name();
                    return Err(problem(format!(
                        "column {name} is {text:?}; allowed: a finite number or nothing"
                    )));
                }
            }
        }
        rows.lines.push(line);
        rows.numbers.push(numbers);
    }
    match names {
        Some(_) => Ok(layers),
        None => Err(Error::Csv {
            line: header.lines + 1,
            column: None,
            problem: format!("the table is missing; allowed: a row of names, {} among them", KEYS.join(", ")),
        }),
    }
}

/// The names of the columns, checked.
fn head(cells: &[&str]) -> Result<Vec<String>, String> {
    let known = || KEYS.into_iter().chain(Column::ALL.map(Column::name));
    for (i, name) in cells.iter().enumerate() {
        if !known().any(|k| k == *name) || cells[..i].contains(name) {
            let names: Vec<&str> = known().collect();
            return Err(format!("there is no column {name:?}; allowed, once each: {}", names.join(", ")));
        }
    }
    match KEYS.iter().find(|k| !cells.contains(k)) {
        Some(missing) => {
            Err(format!("column {missing} is missing; allowed: {} and numbers", KEYS.join(", ")))
        }
        None => Ok(cells.iter().map(|c| (*c).to_owned()).collect()),
    }
}
