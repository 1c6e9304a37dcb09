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
    // The first comparison has the most rows or the smallest errors: it is the line.
    let Some((first, others)) = comparisons.split_first() else { return panel };
    let count = cases(comparisons).len();
    for (class, case) in cases(comparisons).into_iter().enumerate() {
        let of = |c: &'_ Comparison| -> Vec<Row> {
            let mut rows: Vec<Row> = c.rows.iter().filter(|row| row.case == case).cloned().collect();
            rows.sort_by(|a, b| a.at.total_cmp(&b.at));
            rows
        };
        let line = of(first);
        // A line that jumps between quantities of one abscissa would be no curve.
        for quantity in line.chunk_by(|a, b| a.quantity == b.quantity && b.at > a.at) {
            let at = quantity.iter().map(|row| row.at).collect();
            panel = panel.with(Line::new(case, class, at, quantity.iter().map(|row| row.ours).collect()));
        }
        let theirs: Vec<(f64, f64)> = line.iter().filter_map(|row| Some((row.at, row.theirs?))).collect();
        if !theirs.is_empty() {
            let (x, y) = theirs.into_iter().unzip();
            // Lines are ours, markers theirs: one entry for both.
            panel = panel.with(Points::new("", class, x, y));
        }
        // With more curves than these nobody could tell them apart; differences are below in any case.
        for other in others.iter().filter(|_| count <= 2) {
            let rows = of(other);
            let (x, y) = rows.iter().map(|row| (row.at, row.ours)).unzip();
            let bars =
                rows.iter().map(|row| (row.ours - half(row.our_error), row.ours + half(row.our_error)));
            if !rows.is_empty() {
                let label = format!("{case}, {}", other.by);
                panel = panel.with(Points::new(label, class + 3, x, y).with_y_interval(bars.collect()));
            }
        }
    }
    panel
}

fn rows(comparisons: &[Comparison]) -> Panel {
    let axis = Axis::new("Ours over theirs, less 1", "%", Scale::SymLog { threshold: NEAR });
    let mut panel = Panel::new(Axis::linear("Row of the table", ""), axis);
    for (class, c) in comparisons.iter().enumerate() {
        let found: Vec<(f64, f64, f64)> = c
            .rows
            .iter()
            .filter_map(|row| {
                let relative = 100.0 * row.relative()?;
                Some((row.at, relative, 100.0 * 1.96 * row.combined()? / row.theirs?.abs()))
            })
            .collect();
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
