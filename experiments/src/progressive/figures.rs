//! The figure: mean squared error against the number of maps, by schedule.

use super::cases::{QUERIES, schedules};
use super::results::{Point, sequence};
use crate::harness::{FigureFiles, positive_bar};
use turbid::stats::Moments;
use turbid_figure::{Axis, Dash, Figure, Legend, Line, Panel, Points, Scale, Width};

/// A panel for each kind of question.
pub fn progressive(points: &[Point]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for query in QUERIES {
        let error = Axis::new("mean squared error", "", Scale::Log);
        let mut panel =
            Panel::new(Axis::log("maps", ""), error).with_title(query.title()).with_legend(Legend::Below);
        for schedule in schedules(query) {
            let class = schedule as usize;
            let own = sequence(points, query, schedule);
            let x: Vec<f64> = own.iter().map(|p| p.maps as f64).collect();
            let line = own.iter().map(|p| p.theory.squared()).collect();
            let moments: Vec<Moments> = own.iter().map(|p| p.squared()).collect();
            let y = moments.iter().map(Moments::mean).collect();
            panel =
                panel.with(Line::new(schedule.title(), class, x.clone(), line).with_dash(Dash::Solid)).with(
                    Points::new(schedule.title(), class, x, y)
                        .with_y_interval(moments.iter().map(positive_bar).collect()),
                );
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, ..Figure::new(panels) };
    let caption = "Mean squared error of the mean over maps, over the square of the exact value, measured (points, 95 % intervals over sequences) and \
                   predicted before the run (lines). Where radii shrink by their own power it falls as the number of maps to −4/7, −2/3, −4/5, \
                   beside the best fixed radius for all photons, which must know their number; where they stay the blur stays; where they \
                   shrink as those of balls it falls too slowly."
        .to_string();
    FigureFiles::draw("progressive", &caption, &figure)
}
