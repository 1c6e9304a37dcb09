//! The figures.

use super::cases::{LADDER, Method, RAMP};
use super::expected::expected;
use super::rays::{Profile, Way};
use super::results::{CaseResult, find};
use crate::harness::{FigureFiles, percent, percent_bar};
use turbid_figure::{Axis, Dash, Figure, Line, Panel, Points, Scale, Width};

/// Methods of the figures, in the order of their colours: without delta tracking, and without the residual over the least, which
/// is next to ratio tracking.
const SHOWN: [Method; 7] = [
    Method::Ratio,
    Method::Local,
    Method::Combs,
    Method::LocalCombs,
    Method::ResidualMean,
    Method::Series,
    Method::Telescoped,
];

/// All figures.
pub fn all(results: &[CaseResult]) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![work(results)?, combs(results)?, marches(results)?])
}

/// Variance times look-ups against the optical depth, through noise and cloud.
fn work(results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for profile in [Profile::Noise, Profile::Cloud] {
        let ways: Vec<Way> = Way::all().into_iter().filter(|w| w.profile == profile).collect();
        let x = Axis::log("optical depth", "").with_range(0.08, 40.0);
        let y = Axis::new("relative variance × look-ups", "", Scale::LogClipped).with_range(1e-4, 1e5);
        let mut panel = Panel::new(x, y).with_title(profile.name());
        for (class, method) in SHOWN.into_iter().enumerate() {
            let chosen: Vec<&CaseResult> = ways.iter().filter_map(|w| find(results, *w, method)).collect();
            let depths =
                |chosen: &[&CaseResult]| chosen.iter().map(|r| r.case().way.depth).collect::<Vec<f64>>();
            let predicted: Vec<f64> = chosen.iter().map(|r| r.expected.work()).collect();
            panel = panel
                .with(Line::new(method.title(), class, depths(&chosen), predicted).with_dash(Dash::Solid));
            // Where rare values carry the variance, cells do not tell it.
            let known: Vec<&CaseResult> = chosen.into_iter().filter(|r| r.is_shown()).collect();
            if known.is_empty() {
                continue;
            }
            let measured = known.iter().map(|r| r.work().value()).collect();
            let bars = known.iter().map(|r| (r.work_interval().low, r.work_interval().high)).collect();
            panel = panel
                .with(Points::new(method.title(), class, depths(&known), measured).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = "What a relative variance of 1 costs in look-ups of the density, against the optical depth of a ray aslant \
                   through a grid of random values (left) and through a cloud (right): predicted before the run (lines, straight \
                   between the depths), and measured where few values do not carry the variance (points, 95 % intervals over cells). \
                   The lower, the better.";
    FigureFiles::draw("work", caption, &figure)
}

/// Relative variance against look-ups: combs of any number of teeth beside the methods that choose it.
fn combs(results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for profile in
        [Profile::Ramp, Profile::Step, Profile::Peak, Profile::Sine, Profile::Noise, Profile::Cloud]
    {
        let way = Way { profile, depth: 2.0 };
        let line = way.line()?;
        let x = Axis::log("look-ups", "").with_range(0.8, 100.0);
        let y = Axis::new("relative variance", "", Scale::LogClipped).with_range(1e-5, 10.0);
        let mut panel = Panel::new(x, y).with_title(way.title());
        let any = [1, 2, 3, 4, 6, 8, 12, 16, 32, 64].map(|n| expected(&line, &Method::combs(&line, n)));
        // A comb in step with the density has no variance at all.
        let any: Vec<_> = any.into_iter().filter(|e| e.squared > 1e-9).collect();
        let curve = Line::new(
            Method::Combs.title(),
            2,
            any.iter().map(|e| e.look_ups).collect(),
            any.iter().map(|e| e.squared).collect(),
        );
        panel = panel.with(curve.with_dash(Dash::Solid));
        for (class, method) in SHOWN.into_iter().enumerate().take(5) {
            // Where the bounds meet nothing is looked up, and nothing varies.
            let Some(r) = find(results, way, method).filter(|r| r.expected.squared > 1e-9) else {
                continue;
            };
            let n = r.squared.len() as f64;
            let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
            let interval = turbid::stats::positive_interval(
                &r.squared,
                |s| s.iter().sum::<f64>() / s.len() as f64,
                0.95,
            );
            let points = Points::new(method.title(), class, vec![mean(&r.look_ups)], vec![mean(&r.squared)]);
            panel = panel.with(points.with_y_interval(vec![(interval.low, interval.high)]));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = "Relative variance of one estimate against the look-ups that it makes, on rays of optical depth 2: measured \
                   (points, 95 % intervals over cells), and predicted for unbiased ray marching by combs of 1 to 64 places \
                   (lines). Where the density is smooth, combs gain with every look-up more than tracking could; at jumps and peaks \
                   they must be finer than those, and in step with waves (sine, three places) they fail.";
    FigureFiles::draw("combs", caption, &figure)
}

/// Bias of marches and what the jackknife leaves of it.
fn marches(results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let axis = Axis::new("bias", "%", Scale::SymLog { threshold: 1.0 }).with_range(-20.0, 100.0);
    let mut panel = Panel::new(Axis::log("places at random", "").with_range(1.7, 38.0), axis);
    for (class, label) in ["march", "jackknife"].into_iter().enumerate() {
        let method = if class == 0 { Method::March } else { Method::Jackknife };
        let chosen: Vec<&CaseResult> =
            LADDER.iter().filter_map(|&n| find(results, RAMP, method(n))).collect();
        let x: Vec<f64> = chosen.iter().map(|r| r.expected.look_ups).collect();
        let predicted = chosen.iter().map(|r| percent(r.expected.bias)).collect();
        panel = panel.with(Line::new(label, class, x.clone(), predicted).with_dash(Dash::Solid));
        let measured = chosen.iter().map(|r| percent(r.mean.error.mean())).collect();
        let bars = chosen.iter().map(|r| percent_bar(&r.mean.error)).collect();
        panel = panel.with(Points::new(label, class, x, measured).with_y_interval(bars));
    }
    let caption = "Bias of the transmittance of mu = 4x, optical depth 2, by marches of places at random and by their jackknife: \
                   measured (points, 95 % intervals over cells) and predicted (lines, straight between the numbers of places). \
                   Marches are bright, by one over the number of places; the jackknife leaves a bias of the next order. Linear \
                   within ±1 %.";
    FigureFiles::draw("marches", caption, &Figure::new(vec![panel]))
}
