//! The figures.

use super::intervals::Kind;
use super::measure::{SIZES, alarm_name, case, null_case};
use super::nulls::{LEVELS, Population};
use super::results::{p_values, uniformity};
use crate::harness::{Cells, FigureFiles, bar, percent, percent_bar};
use turbid_figure::{Along, Axis, Color, Figure, Legend, Line, Panel, Points, Rule, Scale, Width};

/// All figures.
pub fn all(cells: &Cells) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![coverage(cells)?, p_values_figure(cells)?, alarms(cells)?])
}

/// Coverage against the number of maps.
fn coverage(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::log("number of maps", "").with_range(7.0, 80.0),
        Axis::linear("coverage of 95 % intervals", "%").with_range(90.0, 97.0),
    )
    .with(Rule::new(Along::Horizontal(95.0)).with_label("95 %"));
    let series = |name: &str, class: usize, kind: Kind, quantity: &str| -> anyhow::Result<Points> {
        let (mut x, mut y, mut bars) = (Vec::new(), Vec::new(), Vec::new());
        for maps in SIZES {
            let moments = cells.moments(&case(kind, maps), quantity)?;
            // Beside each other, not on top.
            x.push(maps as f64 * (1.0 + 0.025 * (class as f64 - 3.0)));
            y.push(percent(moments.mean()));
            bars.push(percent_bar(&moments));
        }
        Ok(Points::new(name, class, x, y).with_y_interval(bars))
    };
    for (class, kind) in Kind::ALL.into_iter().enumerate() {
        panel = panel.with(series(kind.title(), class, kind, "coverage")?);
    }
    let wrong = "wrong: normal quantile, fixed radius";
    let by_normal = series(wrong, Kind::ALL.len(), Kind::Radius, "coverage by normal")?;
    panel = panel.with(Points { color: Color::Grey, ..by_normal });
    let figure = Figure { width: Width::Double, ..Figure::new(vec![panel.with_legend(Legend::Right)]) };
    let caption = "How often the laboratory's 95 % intervals contain the exact value, against the number of maps behind \
                   them (8, 16, 32 and 64, drawn side by side), with 95 % intervals over batches of repeats. Student's t makes up for few maps where numbers \
                   are nearly normal; the normal quantile, shown for a fixed radius, does not. Prices and other \
                   numbers made of squares are skewed: of few maps they cover when they are refitted on their logarithm, and too seldom as they are.";
    FigureFiles::draw("coverage", caption, &figure)
}

/// Distribution of one p-value a repeat, less the uniform one.
fn p_values_figure(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::linear("p-value", "").with_range(0.0, 1.0),
        Axis::linear("share of p-values below, less p", "").with_range(-0.06, 0.06),
    );
    let mut n = 1;
    for (class, kind) in Kind::MADE.into_iter().enumerate() {
        let mut values = p_values(cells, kind);
        values.sort_by(f64::total_cmp);
        n = uniformity(cells, kind).1.max(1);
        let grid: Vec<f64> = (0..=200).map(|i| 0.005 * f64::from(i)).collect();
        let below = |p: f64| values.partition_point(|v| *v <= p) as f64 / n as f64 - p;
        let y = grid.iter().map(|p| below(*p)).collect();
        panel = panel.with(Line::new(kind.title(), class, grid, y));
    }
    // Kolmogorov's distance that right values exceed once in a hundred.
    let limit = 1.628 / (n as f64).sqrt();
    panel = panel
        .with(Rule::new(Along::Horizontal(limit)).with_label("exceeded once in 100"))
        .with(Rule::new(Along::Horizontal(-limit)));
    let figure = Figure { width: Width::Double, ..Figure::new(vec![panel.with_legend(Legend::Right)]) };
    let caption = "The share of p-values at most p, less p itself, one p-value a repeat: zero for uniform ones. A line \
                   of right p-values leaves the band between the rules once in a hundred studies.";
    FigureFiles::draw("p-values", caption, &figure)
}

/// False alarms against the level.
fn alarms(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::log("level of the test", "").with_range(5e-6, 2e-2),
        Axis::new("alarms on right data over those promised", "", Scale::LogClipped).with_range(0.4, 20.0),
    )
    .with(Rule::new(Along::Horizontal(1.0)).with_label("as promised"));
    for (class, population) in Population::ALL.into_iter().enumerate() {
        let (mut x, mut y, mut bars) = (Vec::new(), Vec::new(), Vec::new());
        for level in LEVELS {
            let moments = cells.moments(&null_case(population), &alarm_name(level))?;
            if moments.mean() > 0.0 {
                let (low, high) = bar(&moments);
                x.push(level * (1.0 + 0.08 * (class as f64 - 1.0)));
                y.push(moments.mean() / level);
                bars.push((low / level, high / level));
            }
        }
        panel = panel.with(Points::new(population.title(), class, x, y).with_y_interval(bars));
    }
    let figure = Figure { width: Width::Double, ..Figure::new(vec![panel.with_legend(Legend::Right)]) };
    let caption = "Alarms of Student's t test on right data, means of 64 numbers, over the number that the level \
                   promises, with 95 % intervals. Normal numbers keep the promise far into the tail; skewed ones break \
                   it there, and the more so the smaller the level.";
    FigureFiles::draw("alarms", caption, &figure)
}
