//! What surrounds a plot: box, grid, ticks, labels, heading, colour bar; and how much room that takes.

use crate::axis::Axis;
use crate::extent::{Spans, colors};
use crate::figure::Panel;
use crate::layer::{Align, Heatmap, Layer};
use crate::mark::{Mark, Paint, Rect, Text};
use crate::number::power_of_ten;
use crate::plot::Plot;
use crate::scale::Span;
use crate::style::HATCH;
use crate::text::{DIGIT, Fonts, LEADING, NORMAL, SMALL, plain};
use crate::ticks::{Tick, Ticks, ticks};

const TICK: f64 = 3.0;
const MINOR_TICK: f64 = 1.7;
/// Distance between a tick and its label, and between labels and the axis label [pt].
const GAP: f64 = 2.5;
/// Least distance between neighbouring tick labels along x [pt].
const LABEL_GAP: f64 = 6.0;
/// Least distance of ticks along y [pt].
const ROW: f64 = 15.0;
/// Ticks nearer than this run together; the minor ones are then left out [pt].
const CLOSEST: f64 = 0.9;
const BAR_GAP: f64 = 6.0;
const BAR: f64 = 7.0;
const INK: Paint = Paint::solid((60, 60, 60));
const GRID: Paint = Paint::solid((228, 228, 228));

/// One axis with its ticks and the lines of its label.
pub(crate) struct AxisFrame {
    pub(crate) span: Span,
    pub(crate) ticks: Ticks,
    pub(crate) label: Vec<String>,
    /// Width of the widest tick label.
    widest: f64,
}

impl AxisFrame {
    /// Ticks and label for an axis of this length.
    fn new(axis: &Axis, span: Span, length: f64, across: bool, fonts: &Fonts) -> Self {
        let width = |t: &Tick| fonts.width(&t.label, SMALL, false);
        let places =
            |t: &Ticks| t.major.iter().map(|m| length * span.unit_of_transformed(m.at)).collect::<Vec<_>>();
        let fits = |t: &Ticks| {
            let at = places(t);
            (1..at.len()).all(|i| {
                let room = if across {
                    0.5 * (width(&t.major[i - 1]) + width(&t.major[i])) + LABEL_GAP
                } else {
                    ROW
                };
                at[i] - at[i - 1] >= room
            })
        };
        let ticks = if axis.names.is_empty() {
            (2..=8).rev().map(|most| ticks(&span, most)).find(fits).unwrap_or_else(|| ticks(&span, 2))
        } else {
            let mut major: Vec<Tick> = axis
                .names
                .iter()
                .filter(|n| span.contains(n.0))
                .map(|n| Tick { at: span.scale.forward(n.0), label: n.1.clone() })
                .collect();
            major.sort_by(|a, b| a.at.total_cmp(&b.at));
            Ticks { major, ..Ticks::default() }
        };
        let mut ticks = ticks;
        if closest(&ticks) * length / (span.high - span.low) < CLOSEST {
            ticks.minor.clear();
        }
        let widest = ticks.major.iter().map(width).fold(0.0, f64::max);
        let label = fonts.wrap(&heading(axis, ticks.exponent), NORMAL, false, length.max(60.0));
        Self { span, ticks, label, widest }
    }

    /// Room beside a vertical axis, ticks included.
    fn beside(&self) -> f64 {
        let label =
            if self.label.is_empty() { 0.0 } else { GAP + self.label.len() as f64 * NORMAL * LEADING };
        TICK + GAP + self.widest + label
    }

    /// Room under a horizontal axis.
    fn under(&self) -> f64 {
        let label =
            if self.label.is_empty() { 0.0 } else { GAP + self.label.len() as f64 * NORMAL * LEADING };
        TICK + GAP + SMALL + label
    }

    /// How far the outermost tick labels reach beyond either end of an axis of this length.
    fn overhang(&self, length: f64, fonts: &Fonts) -> (f64, f64) {
        let reach = |t: Option<&Tick>, end: f64| {
            t.map_or(0.0, |t| {
                (0.5 * fonts.width(&t.label, SMALL, false)
                    - length * (self.span.unit_of_transformed(t.at) - end).abs())
                .max(0.0)
            })
        };
        (reach(self.ticks.major.first(), 0.0), reach(self.ticks.major.last(), 1.0))
    }
}

/// The least distance of two ticks, in transformed numbers.
fn closest(ticks: &Ticks) -> f64 {
    let mut at: Vec<f64> = ticks.major.iter().map(|t| t.at).chain(ticks.minor.iter().copied()).collect();
    at.sort_by(f64::total_cmp);
    at.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min)
}

/// `label [10³ unit]`.
fn heading(axis: &Axis, exponent: i32) -> String {
    match (exponent, axis.unit.as_str()) {
        (0, "") => axis.label.clone(),
        (0, unit) => format!("{} [{unit}]", axis.label),
        (k, "") => format!("{} [{}]", axis.label, power_of_ten(k)),
        (k, unit) => format!("{} [{} {unit}]", axis.label, power_of_ten(k)),
    }
}

/// Everything around one plot.
pub(crate) struct Frame {
    pub(crate) x: AxisFrame,
    pub(crate) y: AxisFrame,
    bar: Option<AxisFrame>,
    title: Vec<String>,
    /// Room on each side [pt], legends apart.
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

fn map(panel: &Panel) -> Option<&Heatmap> {
    panel.layers.iter().find_map(|l| if let Layer::Heatmap(map) = l { Some(map) } else { None })
}

impl Frame {
    /// The frame of a plot of this size.
    pub(crate) fn new(panel: &Panel, spans: &Spans, width: f64, height: f64, fonts: &Fonts) -> Self {
        let x = AxisFrame::new(&panel.x, spans.x, width, true, fonts);
        let y = AxisFrame::new(&panel.y, spans.y, height, false, fonts);
        let bar = map(panel).map(|m| AxisFrame::new(&m.quantity, colors(m), height, false, fonts));
        let title = fonts.wrap(&panel.title, NORMAL, true, width);
        let overhang = x.overhang(width, fonts);
        let bar_room = bar.as_ref().map_or(0.0, |b| BAR_GAP + BAR + b.beside() + 1.0);
        Self {
            left: y.beside().max(overhang.0),
            right: bar_room.max(overhang.1),
            top: if title.is_empty() { 0.5 * SMALL } else { 3.0 + title.len() as f64 * NORMAL * LEADING },
            bottom: x.under(),
            x,
            y,
            bar,
            title,
        }
    }

    /// Grid, under the data.
    pub(crate) fn draw_under(&self, plot: &Plot, panel: &Panel, marks: &mut Vec<Mark>) {
        if map(panel).is_some() {
            return;
        }
        let r = &plot.rect;
        let mut line = |points| marks.push(Mark::Stroke { points, width: 0.4, paint: GRID });
        for t in &self.x.ticks.major {
            let x = plot.x_at(self.x.span.unit_of_transformed(t.at));
            line(vec![(x, r.top), (x, r.bottom())]);
        }
        for t in &self.y.ticks.major {
            let y = plot.y_at(self.y.span.unit_of_transformed(t.at));
            line(vec![(r.left, y), (r.right(), y)]);
        }
    }

    /// Box, ticks, labels and heading, over the data.
    pub(crate) fn draw_over(&self, plot: &Plot, panel: &Panel, marks: &mut Vec<Mark>) {
        let r = &plot.rect;
        outline(r, marks);
        let mut tick = |a: (f64, f64), b: (f64, f64)| {
            marks.push(Mark::Stroke { points: vec![a, b], width: 0.6, paint: INK })
        };
        for t in &self.x.ticks.major {
            let x = plot.x_at(self.x.span.unit_of_transformed(t.at));
            tick((x, r.bottom()), (x, r.bottom() + TICK));
        }
        for &t in &self.x.ticks.minor {
            let x = plot.x_at(self.x.span.unit_of_transformed(t));
            tick((x, r.bottom()), (x, r.bottom() + MINOR_TICK));
        }
        for t in &self.x.ticks.major {
            let at =
                (plot.x_at(self.x.span.unit_of_transformed(t.at)), r.bottom() + TICK + GAP + DIGIT * SMALL);
            marks.push(Mark::Text(plain(&t.label, at, Align::Middle, SMALL)));
        }
        let base = r.bottom() + TICK + GAP + SMALL + GAP;
        for (i, line) in self.x.label.iter().enumerate() {
            let at = (r.left + 0.5 * r.width, base + (i as f64 + 0.85) * NORMAL * LEADING - 0.15 * NORMAL);
            marks.push(Mark::Text(plain(line, at, Align::Middle, NORMAL)));
        }
        vertical(&self.y, r, r.left, -1.0, marks);
        let top = r.top - self.top + 0.5;
        for (i, line) in self.title.iter().enumerate() {
            let at = (r.left, top + (i as f64 + 0.8) * NORMAL * LEADING);
            marks.push(Mark::Text(Text { bold: true, ..plain(line, at, Align::Start, NORMAL) }));
        }
        if let (Some(frame), Some(map)) = (&self.bar, map(panel)) {
            color_bar(frame, map, r, marks);
        }
    }
}

fn outline(r: &Rect, marks: &mut Vec<Mark>) {
    let mut points = r.corners();
    points.extend([points[0], points[1]]);
    marks.push(Mark::Stroke { points, width: 0.6, paint: INK });
}

/// Ticks, numbers and label of a vertical axis at x, to the left (-1) or to the right (+1) of it.
fn vertical(axis: &AxisFrame, r: &Rect, x: f64, side: f64, marks: &mut Vec<Mark>) {
    let place = |t: f64| r.bottom() - r.height * axis.span.unit_of_transformed(t);
    let majors = axis.ticks.major.iter().map(|t| (t.at, TICK));
    for (t, length) in majors.chain(axis.ticks.minor.iter().map(|&t| (t, MINOR_TICK))) {
        let y = place(t);
        marks.push(Mark::Stroke { points: vec![(x, y), (x + side * length, y)], width: 0.6, paint: INK });
    }
    // Numbers end at their ticks, on either side of a plot: digits then line up.
    let end = if side < 0.0 { x - TICK - GAP } else { x + TICK + GAP + axis.widest };
    for t in &axis.ticks.major {
        let at = (end, place(t.at) + 0.5 * DIGIT * SMALL);
        marks.push(Mark::Text(plain(&t.label, at, Align::End, SMALL)));
    }
    let lines = axis.label.len() as f64;
    for (i, line) in axis.label.iter().enumerate() {
        let from_ticks = if side < 0.0 { lines - 1.0 - i as f64 } else { i as f64 };
        let near = TICK + GAP + axis.widest + GAP + from_ticks * NORMAL * LEADING;
        // Baselines of upright text lie to the right of its letters.
        let base = if side < 0.0 { x - near - 0.2 * NORMAL } else { x + near + 0.9 * NORMAL };
        let at = (base, r.top + 0.5 * r.height);
        marks.push(Mark::Text(Text { upright: true, ..plain(line, at, Align::Middle, NORMAL) }));
    }
}

/// The colours with their numbers; ends are pointed where values lie beyond the range.
fn color_bar(frame: &AxisFrame, map: &Heatmap, plot: &Rect, marks: &mut Vec<Mark>) {
    const STEPS: u32 = 128;
    let bar = Rect { left: plot.right() + BAR_GAP, top: plot.top, width: BAR, height: plot.height };
    let at = |u: f64| bar.bottom() - u * bar.height;
    for i in 0..STEPS {
        let (u, v) = (f64::from(i) / f64::from(STEPS), f64::from(i + 1) / f64::from(STEPS));
        // Each step reaches under the next, or seams would show.
        let top = (at(v) - 1.0).max(bar.top);
        let points = vec![(bar.left, at(u)), (bar.left, top), (bar.right(), top), (bar.right(), at(u))];
        marks.push(Mark::Area { points, paint: Paint::solid(map.shading.rgb(0.5 * (u + v))) });
    }
    let (distance, width) = HATCH;
    for n in 0..(bar.height / distance) as usize {
        let y = bar.bottom() - (n as f64 + 0.5) * distance;
        if let Some(rgb) = map.shading.hatch((bar.bottom() - y) / bar.height) {
            let points = vec![(bar.left, y), (bar.right(), y)];
            marks.push(Mark::Stroke { points, width, paint: Paint::solid(rgb) });
        }
    }
    outline(&bar, marks);
    let middle = bar.left + 0.5 * bar.width;
    let beyond = |high: bool| {
        map.values
            .iter()
            .any(|&v| if high { frame.span.unit(v) > 1.0 + 1e-9 } else { frame.span.unit(v) < -1e-9 })
    };
    for (high, y, tip, u) in
        [(true, bar.top, bar.top - 5.0, 1.0), (false, bar.bottom(), bar.bottom() + 5.0, 0.0)]
    {
        if beyond(high) {
            let points = vec![(bar.left, y), (middle, tip), (bar.right(), y)];
            marks.push(Mark::Area { points: points.clone(), paint: Paint::solid(map.shading.rgb(u)) });
            marks.push(Mark::Stroke { points, width: 0.6, paint: INK });
        }
    }
    vertical(frame, &bar, bar.right(), 1.0, marks);
}
