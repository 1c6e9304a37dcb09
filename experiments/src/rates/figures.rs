//! The figure: mean squared error against photons, and against the radius.

use super::cases::{BLURRED, INSIDE, radii};
use super::results::{Point, ladder};
use crate::harness::{FigureFiles, positive_bar};
use crate::theory::Curve;
use turbid::stats::Moments;
use turbid_figure::{Axis, Dash, Figure, Legend, Line, Panel, Points, Scale, Width};

/// Left: against the number of photons. Right: against the radius, inside.
pub fn rates(points: &[Point], curves: &[Curve], sizes: &[u64]) -> anyhow::Result<FigureFiles> {
    let axis = |label: &str| Axis::new(label, "", Scale::Log);
    let x: Vec<f64> = sizes.iter().map(|&n| n as f64).collect();
    let mut left = Panel::new(Axis::log("photons emitted", ""), axis("mean squared error"))
        .with_title("against photons")
        .with_legend(Legend::Below);
    let mut add = |label: &str, class: usize, measured: &[Moments], predicted: Vec<f64>| {
        let y = measured.iter().map(Moments::mean).collect();
        let bars = measured.iter().map(positive_bar).collect();
        let panel = left.clone().with(Line::new(label, class, x.clone(), predicted).with_dash(Dash::Solid));
        left = panel.with(Points::new(label, class, x.clone(), y).with_y_interval(bars));
    };
    let fixed =
        |place: usize| -> Vec<&Point> { sizes.iter().map(|&n| ladder(points, n, INSIDE)[place]).collect() };
    let squared = |chosen: &[&Point]| -> (Vec<Moments>, Vec<f64>) {
        (chosen.iter().map(|p| p.squared()).collect(), chosen.iter().map(|p| p.theory.squared()).collect())
    };
    add("lit face, best radius", 3, &curves[2].measured, curves[2].predicted.clone());
    for (class, place) in [(2, BLURRED), (1, curves[1].chosen[0])] {
        let (measured, predicted) = squared(&fixed(place));
        add(&format!("depth 1, radius {:.2}", radii()[place]), class, &measured, predicted);
    }
    add("depth 1, best radius", 0, &curves[0].measured, curves[0].predicted.clone());
    // The slope alone, a little below the best.
    let (first, limit) = (x[0], curves[0].limit.0);
    let slope = x.iter().map(|n| 0.6 * curves[0].predicted[0] * libm::pow(n / first, limit)).collect();
    left = left.with(Line::theory("slope −4/7", x.clone(), slope).with_dash(Dash::Dotted));
    let mut right = Panel::new(Axis::log("radius", "mfp"), axis("mean squared error"))
        .with_title("against radius, depth 1")
        .with_legend(Legend::Below);
    for (class, &photons) in sizes.iter().enumerate() {
        let own = ladder(points, photons, INSIDE);
        let line = own.iter().map(|p| p.theory.squared()).collect();
        let label = format!("{photons} photons");
        right = right.with(Line::new(&label, class, radii(), line).with_dash(Dash::Solid));
        let moments: Vec<Moments> = own.iter().map(|p| p.squared()).collect();
        let y = moments.iter().map(Moments::mean).collect();
        let bars = moments.iter().map(positive_bar).collect();
        right = right.with(Points::new(&label, class, radii(), y).with_y_interval(bars));
    }
    let figure = Figure { width: Width::Double, columns: 2, ..Figure::new(vec![left, right]) };
    let caption = "Mean squared error of the fluence of uncollided photons, over the square of the exact one: measured \
                   (points, 95 % intervals over cells) and predicted before the run (lines). Left: at the best radius \
                   it falls with the slope −4/7 of theory; at a fixed radius as one over the photons until the blur is all \
                   that is left; at the untreated lit face it stays near a quarter, since half of each ball is empty. \
                   Right: noise falls with the radius and blur grows with it; the best radius shrinks as photons \
                   are added.";
    FigureFiles::draw("rates", caption, &figure)
}
