//! The picture of a set: values of both, and differences over combined errors.

use super::comparison::{Comparison, Row};
use super::set::{Plot, Set};
use turbid_figure::{Along, Axis, Figure, Legend, Line, Panel, Points, Rule, Scale, Width};

/// Differences beyond so many errors are drawn at the border.
const FAR: f64 = 8.0;

/// Relative differences up to so many per cent are drawn on a linear part of their axis.
const NEAR: f64 = 0.01;

/// The figure of a set.
pub fn figure(set: &Set, comparisons: &[Comparison]) -> Figure {
    let values = match set.plot {
        Plot::Curves { x, y, is_log } => curves(comparisons, x, y, is_log),
        Plot::Rows => rows(comparisons),
    };
    let x = match set.plot {
        Plot::Curves { x, .. } => Axis::linear(x.0, x.1),
        Plot::Rows => Axis::linear("Row of the table", ""),
    };
    let mut panels = vec![values.with_legend(Legend::Right)];
    if comparisons.iter().any(|c| c.chi_squared().1 > 0) {
        panels.push(scores(comparisons, x).with_legend(Legend::Right));
    }
    let heights = [0.42, 0.22][..panels.len()].to_vec();
    Figure { width: Width::Double, heights, ..Figure::new(panels) }
}

/// Cases in their order.
fn cases(comparisons: &[Comparison]) -> Vec<&str> {
    let mut found: Vec<&str> = Vec::new();
    for row in comparisons.iter().flat_map(|c| &c.rows) {
        if !found.contains(&row.case.as_str()) {
            found.push(&row.case);
        }
    }
    found
}

/// Half a 95 per cent interval.
fn half(error: Option<f64>) -> f64 {
    1.96 * error.unwrap_or(0.0)
}

fn curves(comparisons: &[Comparison], x: (&str, &str), y: (&str, &str), is_log: bool) -> Panel {
    let scale = if is_log { Scale::LogClipped } else { Scale::Linear };
    let mut panel = Panel::new(Axis::linear(x.0, x.1), Axis::new(y.0, y.1, scale));
    let cases = cases(comparisons);
    let count = cases.len();
    for (class, case) in cases.into_iter().enumerate() {
        let of = |c: &Comparison| -> Vec<Row> {
            let mut rows: Vec<Row> = c.rows.iter().filter(|row| row.case == case).cloned().collect();
            rows.sort_by(|a, b| a.at.total_cmp(&b.at));
            rows
        };
        // The first comparison that has the case has the most rows or the smallest errors: it is the line.
        let mut answers = comparisons.iter().map(|c| (&c.by, of(c))).filter(|(_, rows)| !rows.is_empty());
        let Some((_, line)) = answers.next() else { continue };
        // A line that jumps between quantities of one abscissa would be no curve.
        for quantity in line.chunk_by(|a, b| a.quantity == b.quantity && b.at > a.at) {
            let at = quantity.iter().map(|row| row.at).collect();
            panel = panel.with(Line::new(case, class, at, quantity.iter().map(|row| row.ours).collect()));
        }
        let theirs: Vec<(f64, f64)> = line.iter().filter_map(|row| Some((row.at, row.theirs?))).collect();
        if !theirs.is_empty() {
            // Lines are ours, markers theirs: one entry for both.
            let (x, y) = theirs.into_iter().unzip();
            panel = panel.with(Points::new("", class, x, y));
        }
        // With more curves than these nobody could tell them apart; differences are below in any case.
        for (i, (by, rows)) in answers.filter(|_| count <= 2).enumerate() {
            let (x, y) = rows.iter().map(|row| (row.at, row.ours)).unzip();
            let bars =
                rows.iter().map(|row| (row.ours - half(row.our_error), row.ours + half(row.our_error)));
            let label = format!("{case}, {by}");
            panel = panel.with(Points::new(label, class + 3 + i, x, y).with_y_interval(bars.collect()));
        }
    }
    panel
}

/// Above this ratio of sizes relative differences are drawn on a logarithmic axis.
const MANY_DECADES: f64 = 300.0;

/// Abscissa, relative difference and half its interval \[%\].
fn relative(c: &Comparison) -> Vec<(f64, f64, f64)> {
    let of = |row: &Row| Some((row.at, 100.0 * row.relative()?, 196.0 * row.combined()? / row.theirs?.abs()));
    c.rows.iter().filter_map(of).collect()
}

fn rows(comparisons: &[Comparison]) -> Panel {
    let found: Vec<Vec<(f64, f64, f64)>> = comparisons.iter().map(relative).collect();
    let sizes = || found.iter().flatten().map(|(_, y, bar)| y.abs() + bar);
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let is_log = most > MANY_DECADES * least;
    let scale = if is_log { Scale::SymLog { threshold: NEAR } } else { Scale::Linear };
    let axis = Axis::new("Ours over theirs, less 1", "%", scale);
    let mut panel = Panel::new(Axis::linear("Row of the table", ""), axis);
    for (class, (c, found)) in comparisons.iter().zip(&found).enumerate() {
        let x = found.iter().map(|f| f.0).collect();
        let y = found.iter().map(|f| f.1).collect();
        let bars = found.iter().map(|f| (f.1 - f.2, f.1 + f.2)).collect();
        if !found.is_empty() {
            panel = panel.with(Points::new(&c.by, class, x, y).with_y_interval(bars));
        }
    }
    panel.with(Rule::new(Along::Horizontal(0.0)))
}

fn scores(comparisons: &[Comparison], x: Axis) -> Panel {
    let mut panel = Panel::new(x, Axis::linear("Difference over its error", "").with_range(-FAR, FAR));
    for (class, c) in comparisons.iter().enumerate() {
        let (x, y): (Vec<f64>, Vec<f64>) = c.rows.iter().filter_map(|row| Some((row.at, row.z()?))).unzip();
        if !x.is_empty() {
            panel = panel.with(Points::new(&c.by, class, x, y));
        }
    }
    panel.with(Rule::new(Along::Horizontal(-2.0))).with(Rule::new(Along::Horizontal(2.0)))
}
