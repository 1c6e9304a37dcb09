//! The figure of the marched pixels.

use super::results::Picture;
use crate::harness::{FigureFiles, percent, percent_bar};
use turbid_figure::{Along, Axis, Figure, Line, Panel, Points, Rule, Width};

/// Noise and mean error of marched pixels against the number of photons an estimate.
pub fn pixels(pictures: &[Picture]) -> anyhow::Result<FigureFiles> {
    let x: Vec<f64> = pictures.iter().map(|p| p.k as f64).collect();
    let k = || Axis::log("photons an estimate", "").with_range(8.0, 620.0);
    let interval = |p: &Picture| {
        let interval = p.noise.interval(0.95);
        (percent(interval.low), percent(interval.high))
    };
    let noise = Panel::new(k(), Axis::log("noise of a pixel", "%").with_range(0.3, 10.0))
        .with(Rule::new(Along::Horizontal(5.0)).with_label("works well"))
        .with(Line::new("predicted", 0, x.clone(), pictures.iter().map(|p| percent(p.predicted)).collect()))
        .with(
            Points::new(
                "measured",
                0,
                x.clone(),
                pictures.iter().map(|p| percent(p.noise.value())).collect(),
            )
            .with_y_interval(pictures.iter().map(interval).collect()),
        );
    let bias = Panel::new(k(), Axis::linear("mean error of the picture", "%").with_range(-2.0, 2.0))
        .with(Rule::new(Along::Horizontal(1.0)))
        .with(Rule::new(Along::Horizontal(-1.0)).with_label("works well"))
        .with(
            Points::new("measured", 0, x, pictures.iter().map(|p| percent(p.bias.mean())).collect())
                .with_y_interval(pictures.iter().map(|p| percent_bar(&p.bias)).collect()),
        );
    let figure =
        Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(vec![noise, bias]) };
    let caption = "A box of fog, its multiple scattering marched through a volume map: noise of a pixel between independent \
                   maps (left) and mean error of the picture against paths (right), per cent of the whole pixel, against \
                   the number of photons an estimate, with 95 % intervals over maps. The line is predicted before the \
                   run, as though the light were even. Rules: at most 5 and 1 per cent.";
    FigureFiles::draw("pixels", caption, &figure)
}
