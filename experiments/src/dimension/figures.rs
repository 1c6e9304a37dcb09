//! The figure: mean squared error against photons, against the radius, and against time.

use super::cases::radii;
use super::results::{Answer, Point, ladder};
use crate::harness::{FigureFiles, positive_bar};
use crate::setups::uncollided::Query;
use turbid::stats::Moments;
use turbid_figure::{Axis, Dash, Figure, Legend, Line, Panel, Points, Scale, Width};

/// Left: at the best radius, against photons. Middle: against the radius, at the most photons. Right: against time.
pub fn dimension(points: &[Point], answers: &[Answer], sizes: &[u64]) -> anyhow::Result<FigureFiles> {
    let error = || Axis::new("mean squared error", "", Scale::Log);
    let x: Vec<f64> = sizes.iter().map(|&n| n as f64).collect();
    let mut photons = Panel::new(Axis::log("photons emitted", ""), error())
        .with_title("best radius")
        .with_legend(Legend::Below);
    let mut radius = Panel::new(Axis::log("radius", "mfp"), error()).with_legend(Legend::Below);
    let mut time = Panel::new(Axis::log("CPU time of a map and 10,000 rays", "s"), error())
        .with_title("best radius, against time")
        .with_legend(Legend::Below);
    for (class, answer) in answers.iter().enumerate() {
        let (curve, title) = (&answer.curve, answer.query.title());
        let y: Vec<f64> = curve.measured.iter().map(Moments::mean).collect();
        let bars: Vec<(f64, f64)> = curve.measured.iter().map(positive_bar).collect();
        let marks = |x: Vec<f64>| Points::new(title, class, x, y.clone()).with_y_interval(bars.clone());
        photons = photons
            .with(Line::new(title, class, x.clone(), curve.predicted.clone()).with_dash(Dash::Solid))
            .with(marks(x.clone()));
        if answer.query.is_ray() {
            let seconds = answer.picture();
            time = time
                .with(Line::new(title, class, seconds.clone(), y.clone()).with_dash(Dash::Solid))
                .with(marks(seconds));
        }
        if let Some(&most) = sizes.last() {
            let own = ladder(points, answer.query, most);
            let line = own.iter().map(|p| p.theory.squared()).collect();
            let moments: Vec<Moments> = own.iter().map(|p| p.squared()).collect();
            let y = moments.iter().map(Moments::mean).collect();
            radius = radius
                .with_title(format!("{most} photons"))
                .with(Line::new(title, class, radii(), line).with_dash(Dash::Solid))
                .with(
                    Points::new(title, class, radii(), y)
                        .with_y_interval(moments.iter().map(positive_bar).collect()),
                );
        }
    }
    let figure = Figure { width: Width::Double, columns: 3, ..Figure::new(vec![photons, radius, time]) };
    let slopes: Vec<String> =
        Query::ALL.iter().zip(answers).map(|(q, a)| format!("{} {}", q.title(), a.curve.limit.1)).collect();
    let caption = format!(
        "Mean squared error, over the square of the exact value, of light that has not been scattered, in a field that falls as an \
         exponential across the rays: measured (points, 95 % intervals over cells) and predicted before the run (lines). Left: at the \
         best radius; with ever more photons the slopes are {}. Middle: noise falls with the radius as its powers −3 (a place among points), −2 (a \
         place among beams, a ray among points) and −1 (a ray among beams), and the blur grows with its fourth. Right: what the same errors take in time, where a ray asks (lines join the \
         points).",
        slopes.join(", ")
    );
    FigureFiles::draw("dimension", &caption, &figure)
}
