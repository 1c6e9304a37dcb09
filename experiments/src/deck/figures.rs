//! The figures.

use super::conclude::{Edges, Picture};
use super::edge::{BEHIND, DEPTHS, SIZES};
use crate::harness::{FigureFiles, bar};
use turbid::estimators::boundary::Rejection;
use turbid_figure::{Along, Axis, Dash, Figure, Line, Panel, Points, Rule, Scale, Width};

/// Noise and mean error of marched pixels against the number of photons an estimate.
pub fn pixels(pictures: &[Picture]) -> anyhow::Result<FigureFiles> {
    let x: Vec<f64> = pictures.iter().map(|p| p.k as f64).collect();
    let k = || Axis::log("photons an estimate", "").with_range(8.0, 620.0);
    let interval = |p: &Picture| {
        let interval = p.noise.interval(0.95);
        (interval.low, interval.high)
    };
    let noise = Panel::new(k(), Axis::log("noise of a pixel", "%").with_range(0.3, 10.0))
        .with(Rule::new(Along::Horizontal(5.0)).with_label("works well"))
        .with(Line::new("predicted", 0, x.clone(), pictures.iter().map(|p| p.predicted).collect()))
        .with(
            Points::new("measured", 0, x.clone(), pictures.iter().map(|p| p.noise.value()).collect())
                .with_y_interval(pictures.iter().map(interval).collect()),
        );
    let bias = Panel::new(k(), Axis::linear("mean error of the picture", "%").with_range(-2.0, 2.0))
        .with(Rule::new(Along::Horizontal(1.0)))
        .with(Rule::new(Along::Horizontal(-1.0)).with_label("works well"))
        .with(
            Points::new("measured", 0, x, pictures.iter().map(|p| p.bias.mean()).collect())
                .with_y_interval(pictures.iter().map(|p| bar(&p.bias)).collect()),
        );
    let figure =
        Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(vec![noise, bias]) };
    let caption = "A box of fog, its multiple scattering marched through a volume map: noise of a pixel between independent \
                   maps (left) and mean error of the picture against paths (right), per cent of the whole pixel, against \
                   the number of photons an estimate, with 95 % intervals over maps. The line is predicted before the \
                   run, as though the light were even. Rules: at most 5 and 1 per cent.";
    FigureFiles::draw("pixels", caption, &figure)
}

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
                Line::new(size.title(), class, x.clone(), own.iter().map(|e| e.2.predicted).collect())
                    .with_dash(Dash::Solid),
            )
            .with(
                Points::new(size.title(), class, x, own.iter().map(|e| e.2.measured.mean()).collect())
                    .with_y_interval(own.iter().map(|e| bar(&e.2.measured)).collect()),
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
                Rejection::Off => size.title().to_string(),
                _ => format!("{}, incoming direction looked at", size.title()),
            };
            let x = BEHIND.to_vec();
            let predicted = own.iter().map(|w| w.3.predicted).collect();
            wall = wall.with(Line::new(&label, class, x.clone(), predicted).with_dash(dash)).with(
                Points::new(&label, class, x, own.iter().map(|w| w.3.measured.mean()).collect())
                    .with_y_interval(own.iter().map(|w| bar(&w.3.measured)).collect()),
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
