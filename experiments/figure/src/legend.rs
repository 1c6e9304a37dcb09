//! Legends: what stands in them, how large they are, where nothing is in their way.

use crate::crowd::Look;
use crate::figure::Corner;
use crate::layer::{Align, Layer};
use crate::mark::{Mark, Paint, Point, Rect};
use crate::style::{LINE, RULE, light, stroke};
use crate::text::{DIGIT, Fonts, LEADING, SMALL, plain};

const SWATCH: f64 = 17.0;
const GAP: f64 = 4.0;
const PADDING: f64 = 3.0;
const BETWEEN_COLUMNS: f64 = 9.0;
/// Distance from the border of the plot [pt].
const INSET: f64 = 4.0;

/// A label with everything that is drawn for it.
struct Entry<'a> {
    lines: Vec<String>,
    layers: Vec<&'a Layer>,
}

/// A legend of known size.
pub(crate) struct Legend<'a> {
    entries: Vec<Entry<'a>>,
    columns: usize,
    /// Width of each column, heights of rows.
    column: f64,
    rows: Vec<f64>,
}

impl<'a> Legend<'a> {
    /// The legend of these layers in this width, in as many columns as fit if `wide`; none without labels.
    pub(crate) fn new(
        layers: impl Iterator<Item = &'a Layer>,
        width: f64,
        wide: bool,
        fonts: &Fonts,
    ) -> Option<Self> {
        let mut labels: Vec<(&str, Vec<&Layer>)> = Vec::new();
        for layer in layers.filter(|l| !l.label().is_empty()) {
            match labels.iter_mut().find(|e| e.0 == layer.label()) {
                Some(entry) if entry.1.iter().any(|other| same_look(other, layer)) => {}
                Some(entry) => entry.1.push(layer),
                None => labels.push((layer.label(), vec![layer])),
            }
        }
        let room = width - SWATCH - GAP - 2.0 * PADDING;
        let entries: Vec<Entry<'_>> = labels
            .into_iter()
            .map(|(label, layers)| Entry { lines: fonts.wrap(label, SMALL, false, room), layers })
            .collect();
        let text =
            entries.iter().flat_map(|e| &e.lines).map(|l| fonts.width(l, SMALL, false)).fold(0.0, f64::max);
        let column = SWATCH + GAP + text;
        let most = ((width - 2.0 * PADDING + BETWEEN_COLUMNS) / (column + BETWEEN_COLUMNS)).floor().max(1.0)
            as usize;
        let lines = if wide { entries.len().div_ceil(most.min(entries.len().max(1))) } else { entries.len() };
        // No more columns than the rows need: 5 entries in 2 rows are 3 and 2.
        let columns = entries.len().div_ceil(lines.max(1));
        let rows = entries
            .chunks(columns.max(1))
            .map(|row| row.iter().map(|e| e.lines.len()).max().unwrap_or(1) as f64 * SMALL * LEADING + 1.0)
            .collect();
        (!entries.is_empty()).then_some(Self { entries, columns, column, rows })
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    pub(crate) fn width(&self) -> f64 {
        self.columns as f64 * (self.column + BETWEEN_COLUMNS) - BETWEEN_COLUMNS + 2.0 * PADDING
    }

    pub(crate) fn height(&self) -> f64 {
        self.rows.iter().sum::<f64>() + 2.0 * PADDING - 1.0
    }

    /// Draws it with this top left corner, on opaque paper where `boxed`.
    pub(crate) fn draw(&self, (left, top): Point, boxed: bool, marks: &mut Vec<Mark>) {
        let rect = Rect { left, top, width: self.width(), height: self.height() };
        if boxed {
            marks.push(Mark::Area { points: rect.corners(), paint: Paint { alpha: 0.9, ..Paint::PAPER } });
            let mut points = rect.corners();
            points.extend([points[0], points[1]]);
            marks.push(Mark::Stroke { points, width: 0.4, paint: Paint::solid((190, 190, 190)) });
        }
        let mut y = top + PADDING;
        for (row, height) in self.entries.chunks(self.columns).zip(&self.rows) {
            for (i, entry) in row.iter().enumerate() {
                let x = left + PADDING + i as f64 * (self.column + BETWEEN_COLUMNS);
                let middle = y + 0.5 * SMALL * LEADING;
                for layer in &entry.layers {
                    swatch(layer, Rect { left: x, top: middle - 3.0, width: SWATCH, height: 6.0 }, marks);
                }
                for (j, line) in entry.lines.iter().enumerate() {
                    let base = middle + 0.5 * DIGIT * SMALL + j as f64 * SMALL * LEADING;
                    marks.push(Mark::Text(plain(line, (x + SWATCH + GAP, base), Align::Start, SMALL)));
                }
            }
            y += height;
        }
    }

    /// Its top left corner at this place in the plot.
    pub(crate) fn place(&self, plot: &Rect, corner: Corner) -> Point {
        let (left, right) = (plot.left + INSET, plot.right() - INSET - self.width());
        let (top, bottom) = (plot.top + INSET, plot.bottom() - INSET - self.height());
        let middle = (0.5 * (left + right), 0.5 * (top + bottom));
        match corner {
            Corner::TopRight => (right, top),
            Corner::TopLeft => (left, top),
            Corner::BottomRight => (right, bottom),
            Corner::BottomLeft => (left, bottom),
            Corner::Top => (middle.0, top),
            Corner::Bottom => (middle.0, bottom),
            Corner::Right => (right, middle.1),
            Corner::Left => (left, middle.1),
        }
    }

    /// The first corner or side, in the order of the list, where it covers no obstacle.
    pub(crate) fn free_corner(&self, plot: &Rect, obstacles: &[Point]) -> Option<Corner> {
        const ORDER: [Corner; 8] = [
            Corner::TopRight,
            Corner::TopLeft,
            Corner::BottomRight,
            Corner::BottomLeft,
            Corner::Top,
            Corner::Bottom,
            Corner::Right,
            Corner::Left,
        ];
        if self.width() > 0.75 * plot.width || self.height() > 0.6 * plot.height {
            return None;
        }
        ORDER.into_iter().find(|&corner| {
            let (left, top) = self.place(plot, corner);
            let rect = Rect { left, top, width: self.width(), height: self.height() }.grown(INSET);
            !obstacles.iter().any(|&p| rect.contains(p))
        })
    }
}

/// Whether two layers would draw the same swatch, so that a shared legend shows it once.
fn same_look(a: &Layer, b: &Layer) -> bool {
    match (a, b) {
        (Layer::Points(a), Layer::Points(b)) => (a.color, a.marker) == (b.color, b.marker),
        (Layer::Line(a), Layer::Line(b)) => (a.color, a.dash) == (b.color, b.dash),
        (Layer::Rule(a), Layer::Rule(b)) => (a.color, a.dash) == (b.color, b.dash),
        (Layer::Band(a), Layer::Band(b)) => a.color == b.color,
        (Layer::Histogram(a), Layer::Histogram(b)) => a.color == b.color,
        _ => false,
    }
}

fn swatch(layer: &Layer, rect: Rect, marks: &mut Vec<Mark>) {
    let middle = rect.top + 0.5 * rect.height;
    let center = (rect.left + 0.5 * rect.width, middle);
    let across = [(rect.left, middle), (rect.right(), middle)];
    match layer {
        Layer::Points(l) => {
            let paint = Paint::solid(l.color.rgb());
            if l.y_interval.is_some() {
                let points = vec![(center.0, rect.top - 1.0), (center.0, rect.bottom() + 1.0)];
                marks.push(Mark::Stroke { points, width: 0.6, paint });
            }
            if l.x_interval.is_some() {
                let points = vec![(center.0 - 4.5, middle), (center.0 + 4.5, middle)];
                marks.push(Mark::Stroke { points, width: 0.6, paint });
            }
            marks.push(Look::FEW.symbol(l, center));
        }
        Layer::Line(l) => stroke(&rect, &across, LINE, l.color, l.dash, marks),
        Layer::Rule(l) => stroke(&rect, &across, RULE, l.color, l.dash, marks),
        Layer::Band(l) => marks.push(Mark::Area { points: rect.corners(), paint: light(l.color) }),
        Layer::Histogram(l) => {
            marks.push(Mark::Area { points: rect.corners(), paint: light(l.color) });
            let mut points = rect.corners();
            points.extend([points[0], points[1]]);
            marks.push(Mark::Stroke { points, width: 0.8, paint: Paint::solid(l.color.rgb()) });
        }
        Layer::Heatmap(_) | Layer::Note(_) => {}
    }
}
