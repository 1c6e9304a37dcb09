//! What is refused before anything is drawn.

use crate::axis::{Axis, Scale};
use crate::error::Error;
use crate::figure::{Figure, Panel};
use crate::layer::{Along, At, Layer};
use crate::scale::NARROWEST;
use crate::text::Fonts;

/// Greatest width of a page \[mm\]: a poster's column.
const WIDEST: f64 = 500.0;

/// Checks every number, length and text of the figure.
pub(crate) fn figure(figure: &Figure, fonts: &Fonts) -> Result<(), Error> {
    if figure.panels.is_empty() || figure.columns == 0 {
        return Err(Error::Empty { place: "the figure".to_owned() });
    }
    let place = || "the figure".to_owned();
    let positive = |what, value: f64| {
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(Error::Size { place: place(), what, value })
        }
    };
    let millimetres = figure.width.millimetres();
    positive("width", millimetres)?;
    if millimetres > WIDEST {
        return Err(Error::Wide { millimetres, allowed: WIDEST });
    }
    for &h in &figure.heights {
        positive("height of a row", h)?;
    }
    let rows = figure.panels.len().div_ceil(figure.columns);
    if !figure.heights.is_empty() {
        length(&place(), "heights", figure.heights.len(), rows)?;
    }
    fonts.check(&figure.title)?;
    figure.panels.iter().enumerate().try_for_each(|(i, p)| panel(i + 1, p, fonts))
}

fn panel(number: usize, panel: &Panel, fonts: &Fonts) -> Result<(), Error> {
    frame(number, panel, fonts)?;
    if panel.layers.is_empty() {
        return Err(Error::Empty { place: format!("panel {number}") });
    }
    panel.layers.iter().try_for_each(|l| layer(number, panel, l, fonts))
}

/// Checks the heading and the axes of a panel.
pub(crate) fn frame(number: usize, panel: &Panel, fonts: &Fonts) -> Result<(), Error> {
    let place = format!("panel {number}");
    fonts.check(&panel.title)?;
    axis(&place, "x", &panel.x, fonts)?;
    axis(&place, "y", &panel.y, fonts)
}

/// Checks one layer of a panel.
pub(crate) fn layer(number: usize, panel: &Panel, layer: &Layer, fonts: &Fonts) -> Result<(), Error> {
    fonts.check(layer.label())?;
    let place = match layer.label() {
        "" => format!("panel {number}, {}", layer.kind()),
        label => format!("panel {number}, {} \"{label}\"", layer.kind()),
    };
    data(&place, panel, layer, fonts)
}

fn axis(place: &str, name: &'static str, axis: &Axis, fonts: &Fonts) -> Result<(), Error> {
    fonts.check(&axis.label)?;
    fonts.check(&axis.unit)?;
    for (i, (at, text)) in axis.names.iter().enumerate() {
        fonts.check(text)?;
        number(place, "names", i, *at, axis)?;
    }
    if let Scale::SymLog { threshold } = axis.scale
        && !(threshold.is_finite() && threshold > 0.0)
    {
        return Err(Error::Size {
            place: place.to_owned(),
            what: "threshold of the symmetric logarithm",
            value: threshold,
        });
    }
    if let Some((low, high)) = axis.range {
        // Compared on the scale: limits that differ may still share a logarithm.
        let room = axis.scale.forward(high) - axis.scale.forward(low);
        if !((high - low).is_finite() && room.is_finite() && room > NARROWEST) {
            return Err(Error::Range { place: place.to_owned(), axis: name, low, high });
        }
    }
    Ok(())
}

fn data(place: &str, panel: &Panel, layer: &Layer, fonts: &Fonts) -> Result<(), Error> {
    let (x, y) = (&panel.x, &panel.y);
    match layer {
        Layer::Points(l) => {
            numbers(place, "x", &l.x, x)?;
            numbers(place, "y", &l.y, y)?;
            length(place, "y", l.y.len(), l.x.len())?;
            if let Some(intervals) = &l.x_interval {
                length(place, "x_interval", intervals.len(), l.x.len())?;
                self::intervals(place, "x_interval", intervals, x)?;
            }
            if let Some(intervals) = &l.y_interval {
                length(place, "y_interval", intervals.len(), l.x.len())?;
                self::intervals(place, "y_interval", intervals, y)?;
            }
            filled(place, &l.x)
        }
        Layer::Line(l) => {
            numbers(place, "x", &l.x, x)?;
            numbers(place, "y", &l.y, y)?;
            length(place, "y", l.y.len(), l.x.len())?;
            filled(place, &l.x)
        }
        Layer::Band(l) => {
            numbers(place, "x", &l.x, x)?;
            length(place, "interval", l.interval.len(), l.x.len())?;
            intervals(place, "interval", &l.interval, y)?;
            filled(place, &l.x)
        }
        Layer::Histogram(l) => {
            edges(place, "edges", &l.edges, x)?;
            length(place, "heights", l.heights.len(), l.edges.len().saturating_sub(1))?;
            numbers(place, "heights", &l.heights, y)?;
            filled(place, &l.heights)
        }
        Layer::Rule(l) => match l.along {
            Along::Horizontal(v) => number(place, "y", 0, v, y),
            Along::Vertical(v) => number(place, "x", 0, v, x),
            Along::Diagonal => Ok(()),
        },
        Layer::Heatmap(l) => {
            edges(place, "x_edges", &l.x_edges, x)?;
            edges(place, "y_edges", &l.y_edges, y)?;
            let cells = l.x_edges.len().saturating_sub(1) * l.y_edges.len().saturating_sub(1);
            length(place, "values", l.values.len(), cells)?;
            axis(place, "the colour bar", &l.quantity, fonts)?;
            numbers(place, "values", &l.values, &l.quantity)?;
            filled(place, &l.values)
        }
        Layer::Note(l) => {
            fonts.check(&l.text)?;
            let linear = Axis::linear("", "");
            let (at, x, y) = match l.at {
                At::Data(a, b) => ((a, b), x, y),
                At::Fraction(a, b) => ((a, b), &linear, &linear),
            };
            number(place, "at", 0, at.0, x)?;
            number(place, "at", 1, at.1, y)
        }
    }
}

fn number(place: &str, column: &'static str, index: usize, value: f64, axis: &Axis) -> Result<(), Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite { place: place.to_owned(), column, index, value });
    }
    if axis.scale == Scale::Log && value <= 0.0 {
        return Err(Error::NotPositive { place: place.to_owned(), column, index, value });
    }
    Ok(())
}

fn numbers(place: &str, column: &'static str, values: &[f64], axis: &Axis) -> Result<(), Error> {
    values.iter().enumerate().try_for_each(|(i, &v)| number(place, column, i, v, axis))
}

fn intervals(place: &str, column: &'static str, values: &[(f64, f64)], axis: &Axis) -> Result<(), Error> {
    for (index, &(low, high)) in values.iter().enumerate() {
        number(place, column, index, low, axis)?;
        number(place, column, index, high, axis)?;
        if low > high {
            return Err(Error::Interval { place: place.to_owned(), column, index, low, high });
        }
    }
    Ok(())
}

fn edges(place: &str, column: &'static str, values: &[f64], axis: &Axis) -> Result<(), Error> {
    numbers(place, column, values, axis)?;
    match values.windows(2).position(|w| w[1] <= w[0]) {
        Some(i) => Err(Error::Edges { place: place.to_owned(), column, index: i + 1 }),
        None => Ok(()),
    }
}

fn length(place: &str, column: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Length { place: place.to_owned(), column, found, expected })
    }
}

fn filled(place: &str, values: &[f64]) -> Result<(), Error> {
    if values.is_empty() { Err(Error::Empty { place: place.to_owned() }) } else { Ok(()) }
}
