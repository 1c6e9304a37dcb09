//! From a figure to the file.

use super::header::{FigureLine, PanelLine, json};
use super::layers::{look, rows};
use super::{Column, KEYS, VERSION};
use crate::error::Error;
use crate::figure::Figure;
use crate::layer::Layer;
use std::fmt::Write;

/// The text of the file.
pub(crate) fn write(figure: &Figure, description: &str) -> Result<String, Error> {
    let mut out = header(figure, description)?;
    let layers = || {
        let panels = figure.panels.iter().enumerate();
        panels.flat_map(|(p, panel)| {
            panel.layers.iter().enumerate().map(move |(l, layer)| (p + 1, l + 1, layer))
        })
    };
    let is_used =
        |c: &Column| layers().any(|(.., layer)| rows(layer).iter().any(|row| row[*c as usize].is_some()));
    let columns: Vec<Column> = Column::ALL.into_iter().filter(is_used).collect();

    let failed = |e: csv::Error| Error::Backend(e.to_string());
    let mut table = csv::Writer::from_writer(Vec::new());
    let [before @ .., last] = KEYS;
    let names = before.into_iter().chain(columns.iter().map(|c| c.name())).chain([last]);
    table.write_record(names).map_err(failed)?;
    for (panel, number, layer) in layers() {
        let label = if let Layer::Note(note) = layer { &note.text } else { layer.label() };
        for row in rows(layer) {
            let keys = [panel.to_string(), number.to_string(), layer.kind().to_owned()];
            // Debug is the shortest text that reads back to the same bits, with an exponent where that is shorter.
            let cells =
                columns.iter().map(|c| row[*c as usize].map_or_else(String::new, |v| format!("{v:?}")));
            table.write_record(keys.into_iter().chain(cells).chain([label.to_owned()])).map_err(failed)?;
        }
    }
    let bytes = table.into_inner().map_err(|e| Error::Backend(e.to_string()))?;
    out.push_str(&String::from_utf8(bytes).map_err(|e| Error::Backend(e.to_string()))?);
    Ok(out)
}

fn header(figure: &Figure, description: &str) -> Result<String, Error> {
    let mut out = String::new();
    let mut line = |key: String, value: String| {
        writeln!(out, "# {key}: {value}").map_err(|e| Error::Backend(e.to_string()))
    };
    line("turbid figure".to_owned(), VERSION.to_string())?;
    line("description".to_owned(), json(&description)?)?;
    line("figure".to_owned(), json(&FigureLine::of(figure))?)?;
    for (p, panel) in figure.panels.iter().enumerate() {
        line(format!("panel {}", p + 1), json(&PanelLine::of(panel))?)?;
        for (l, layer) in panel.layers.iter().enumerate() {
            line(format!("layer {}.{}", p + 1, l + 1), look(layer)?)?;
        }
    }
    Ok(out)
}
