//! The figure of the edge and the wall.

use super::results::Edges;
use super::{BEHIND, DEPTHS, SIZES};
use crate::harness::{FigureFiles, percent, percent_bar};
use turbid::estimators::boundary::Rejection;
use turbid_figure::{Axis, Dash, Figure, Line, Panel, Points, Scale, Width};

/// Error below the open edge and light behind the wall, against distance.
pub fn edges(edges: &Edges) -> anyhow::Result<FigureFiles> {
    let mut edge = Panel::new(
        Axis::linear("depth below the edge", "mfp").with_range(-0.01, 0.31),
        Axis::linear("error of the estimate", "%").with_range(-60.0, 5.0),
    )
    .with_title("edge of the medium");
    for (class, size) in SIZES.into_iter().enumerate() {
        let own: Vec<_> = edges.edge.iter().filter(|e| e.0 == size).collect();
        let x = DEPTHS.to_vec();
        edge = edge
            .with(
                Line::new(
                    size.title(),
                    class,
                    x.clone(),
                    own.iter().map(|e| percent(e.2.predicted)).collect(),
                )
                .with_dash(Dash::Solid),
            )
            .with(
                Points::new(
                    size.title(),
                    class,
                    x,
                    own.iter().map(|e| percent(e.2.measured.mean())).collect(),
                )
                .with_y_interval(own.iter().map(|e| percent_bar(&e.2.measured)).collect()),
            );
    }
    let mut wall = Panel::new(
        Axis::linear("distance behind the wall", "mfp").with_range(0.0, 0.16),
        Axis::new("light found in the dark", "%", Scale::Linear).with_range(0.0, 70.0),
    )
    .with_title("thin wall");
    for (class, size) in SIZES.into_iter().enumerate() {
        for (rejection, dash) in [(Rejection::Off, Dash::Solid), (Rejection::FacingBehind, Dash::Dotted)] {
            let own: Vec<_> = edges.wall.iter().filter(|w| w.0 == size && w.1 == rejection).collect();
            let label = match rejection {
                Rejection::Off => size.title(),
                _ => format!("{}, incoming direction looked at", size.title()),
            };
            let x = BEHIND.to_vec();
            let predicted = own.iter().map(|w| percent(w.3.predicted)).collect();
            wall = wall.with(Line::new(&label, class, x.clone(), predicted).with_dash(dash)).with(
                Points::new(&label, class, x, own.iter().map(|w| percent(w.3.measured.mean())).collect())
                    .with_y_interval(own.iter().map(|w| percent_bar(&w.3.measured)).collect()),
            );
        }
    }
    let figure =
        Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(vec![edge, wall]) };
    let caption = "Left: error of the estimate below the open edge of a foggy room, in per cent of the exact fluence there. \
                   Right: light that gathers find in the dark behind the thin wall at the room's end, in per cent of \
                   the fluence on its lit side, without a look at the incoming direction (solid) and with it (dotted). \
                   Points are measured, with 95 % intervals over maps; lines are predicted before the run.";
    FigureFiles::draw("edges", caption, &figure)
}
