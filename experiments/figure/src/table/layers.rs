//! Each kind of layer as a look and rows, and back.

use super::header::{Json, json};
use super::rows::Rows;
use super::{Column, Numbers, numbers};
use crate::axis::Axis;
use crate::error::Error;
use crate::layer::{Align, Along, At, Band, Heatmap, Histogram, Layer, Line, Note, Points, Rule};
use crate::palette::{Color, Dash, Marker, Shading};
use Column::{Value, X, XHigh, XLow, Y, YHigh, YLow};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PointsLook {
    color: Color,
    marker: Marker,
}

/// Of lines and rules.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LineLook {
    color: Color,
    dash: Dash,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BandLook {
    color: Color,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HistogramLook {
    color: Color,
    #[serde(default)]
    below: usize,
    #[serde(default)]
    above: usize,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HeatmapLook {
    shading: Shading,
    quantity: Axis,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Frame {
    Data,
    Fraction,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NoteLook {
    at: Frame,
    align: Align,
}

/// What the layer looks like, as JSON.
pub(super) fn look(layer: &Layer) -> Result<String, Error> {
    match layer {
        Layer::Points(l) => json(&PointsLook { color: l.color, marker: l.marker }),
        Layer::Line(l) => json(&LineLook { color: l.color, dash: l.dash }),
        Layer::Band(l) => json(&BandLook { color: l.color }),
        Layer::Histogram(l) => json(&HistogramLook { color: l.color, below: l.below, above: l.above }),
        Layer::Rule(l) => json(&LineLook { color: l.color, dash: l.dash }),
        Layer::Heatmap(l) => json(&HeatmapLook { shading: l.shading, quantity: l.quantity.clone() }),
        Layer::Note(l) => {
            let at = if matches!(l.at, At::Data(..)) { Frame::Data } else { Frame::Fraction };
            json(&NoteLook { at, align: l.align })
        }
    }
}

/// The numbers of the layer, row by row.
pub(super) fn rows(layer: &Layer) -> Vec<Numbers> {
    match layer {
        Layer::Points(l) => (0..l.x.len())
            .map(|i| {
                let mut row = vec![(X, l.x[i]), (Y, l.y[i])];
                if let Some(v) = &l.x_interval {
                    row.extend([(XLow, v[i].0), (XHigh, v[i].1)]);
                }
                if let Some(v) = &l.y_interval {
                    row.extend([(YLow, v[i].0), (YHigh, v[i].1)]);
                }
                numbers(&row)
            })
            .collect(),
        Layer::Line(l) => l.x.iter().zip(&l.y).map(|(&x, &y)| numbers(&[(X, x), (Y, y)])).collect(),
        Layer::Band(l) => {
            let row = |(&x, v): (&f64, &(f64, f64))| numbers(&[(X, x), (YLow, v.0), (YHigh, v.1)]);
            l.x.iter().zip(&l.interval).map(row).collect()
        }
        Layer::Histogram(l) => {
            let row = |(e, &y): (&[f64], &f64)| numbers(&[(XLow, e[0]), (XHigh, e[1]), (Y, y)]);
            l.edges.windows(2).zip(&l.heights).map(row).collect()
        }
        Layer::Rule(l) => vec![match l.along {
            Along::Horizontal(y) => numbers(&[(Y, y)]),
            Along::Vertical(x) => numbers(&[(X, x)]),
            Along::Diagonal => numbers(&[]),
        }],
        Layer::Heatmap(l) => {
            let cells = l.y_edges.windows(2).flat_map(|y| l.x_edges.windows(2).map(move |x| (x, y)));
            let row = |((x, y), &v): ((&[f64], &[f64]), &f64)| {
                numbers(&[(XLow, x[0]), (XHigh, x[1]), (YLow, y[0]), (YHigh, y[1]), (Value, v)])
            };
            cells.zip(&l.values).map(row).collect()
        }
        Layer::Note(l) => {
            let (At::Data(x, y) | At::Fraction(x, y)) = l.at;
            vec![numbers(&[(X, x), (Y, y)])]
        }
    }
}

/// The layer of a look and rows.
pub(super) fn layer(look: &Json<'_>, rows: &Rows) -> Result<Layer, Error> {
    let label = rows.label.clone();
    match rows.kind.as_str() {
        "points" => {
            let PointsLook { color, marker } = look.parse()?;
            rows.only(&[X, Y, XLow, XHigh, YLow, YHigh])?;
            let (x_interval, y_interval) = (rows.optional(XLow, XHigh)?, rows.optional(YLow, YHigh)?);
            let (x, y) = (rows.column(X)?, rows.column(Y)?);
            Ok(Points { label, color, marker, x, y, x_interval, y_interval }.into())
        }
        "line" => {
            let LineLook { color, dash } = look.parse()?;
            rows.only(&[X, Y])?;
            Ok(Line { label, color, dash, x: rows.column(X)?, y: rows.column(Y)? }.into())
        }
        "band" => {
            let BandLook { color } = look.parse()?;
            rows.only(&[X, YLow, YHigh])?;
            Ok(Band { label, color, x: rows.column(X)?, interval: rows.intervals(YLow, YHigh)? }.into())
        }
        "histogram" => {
            let HistogramLook { color, below, above } = look.parse()?;
            rows.only(&[XLow, XHigh, Y])?;
            let edges = edges(rows, &rows.intervals(XLow, XHigh)?, "x")?;
            Ok(Histogram { label, color, edges, heights: rows.column(Y)?, below, above }.into())
        }
        "rule" => {
            let LineLook { color, dash } = look.parse()?;
            rows.only(&[X, Y])?;
            let along = match rows.single()? {
                [None, Some(y), ..] => Along::Horizontal(*y),
                [Some(x), None, ..] => Along::Vertical(*x),
                [None, None, ..] => Along::Diagonal,
                _ => {
                    let allowed = "x of a vertical rule, y of a horizontal one, or neither where y = x";
                    return Err(rows.problem(0, format!("a rule has x and y; allowed: {allowed}")));
                }
            };
            Ok(Rule { label, color, dash, along }.into())
        }
        "heatmap" => {
            let HeatmapLook { shading, quantity } = look.parse()?;
            rows.only(&[XLow, XHigh, YLow, YHigh, Value])?;
            if !label.is_empty() {
                return Err(rows.problem(
                    0,
                    "a heatmap has a label; allowed: none, its look has the quantity".to_owned(),
                ));
            }
            let (x_edges, y_edges) = grid(rows)?;
            Ok(Heatmap { x_edges, y_edges, values: rows.column(Value)?, shading, quantity }.into())
        }
        "note" => {
            let NoteLook { at, align } = look.parse()?;
            rows.only(&[X, Y])?;
            rows.single()?;
            let (x, y) = (rows.column(X)?[0], rows.column(Y)?[0]);
            let at = if matches!(at, Frame::Data) { At::Data(x, y) } else { At::Fraction(x, y) };
            Ok(Note { text: label, at, align }.into())
        }
        other => Err(rows.problem(
            0,
            format!("kind is {other:?}; allowed: points, line, band, histogram, rule, heatmap, note"),
        )),
    }
}

/// The edges of bins that follow each other.
fn edges(rows: &Rows, bins: &[(f64, f64)], axis: &str) -> Result<Vec<f64>, Error> {
    let mut out = Vec::new();
    for (row, &(low, high)) in bins.iter().enumerate() {
        if low >= high {
            return Err(rows
                .problem(row, format!("a bin from {low} to {high}; allowed: {axis}_low below {axis}_high")));
        }
        match out.last() {
            None => out.extend([low, high]),
            Some(&end) if end == low => out.push(high),
            Some(&end) => {
                return Err(rows.problem(
                    row,
                    format!("{axis}_low is {low}; allowed: {end}, where the row before ends"),
                ));
            }
        }
    }
    Ok(out)
}

/// The edges of the columns and rows of a heat map.
fn grid(rows: &Rows) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let (x, y) = (rows.intervals(XLow, XHigh)?, rows.intervals(YLow, YHigh)?);
    let columns = y.iter().take_while(|v| **v == y[0]).count();
    let x_edges = edges(rows, &x[..columns], "x")?;
    for (row, (cell, first)) in x.iter().zip(x[..columns].iter().cycle()).enumerate() {
        let line = row - row % columns;
        if cell != first || y[row] != y[line] {
            return Err(rows.problem(
                row,
                format!(
                    "a cell at x from {} to {}, y from {} to {}; allowed: x from {} to {}, y from {} to {}, since \
                     cells run from left to right, then upwards",
                    cell.0, cell.1, y[row].0, y[row].1, first.0, first.1, y[line].0, y[line].1
                ),
            ));
        }
    }
    if y.len() % columns != 0 {
        let text = format!("the last row of cells has {}; allowed: {columns}", y.len() % columns);
        return Err(rows.problem(y.len() - 1, text));
    }
    let lines: Vec<(f64, f64)> = y.iter().step_by(columns).copied().collect();
    let mut out = Vec::new();
    for (i, &(low, high)) in lines.iter().enumerate() {
        if low >= high || out.last().is_some_and(|&end: &f64| end != low) {
            return Err(rows.problem(
                i * columns,
                format!("y from {low} to {high}; allowed: from where the row of cells below ends, upwards"),
            ));
        }
        if i == 0 {
            out.push(low);
        }
        out.push(high);
    }
    Ok((x_edges, out))
}
