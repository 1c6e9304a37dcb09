//! The figures: error against the last radius, and how far off answers are.

use super::cases::{Estimator, FIRST, QUERIES, STOPS, photons, radius, thresholds, work};
use super::results::{Answer, Level, Tail, find};
use crate::harness::{FigureFiles, Settings, bar, positive_bar};
use crate::setups::uncollided::Case;
use turbid::stats::Moments;
use turbid_figure::{Along, Axis, Dash, Figure, Legend, Line, Panel, Points, Rule, Scale, Width};

/// Mean squared error against the last radius, at equal photons.
pub fn stopped(answers: &[Answer], settings: &Settings) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for query in QUERIES {
        let x = Axis::log("last radius", "mfp").with_range(0.04, 1.0);
        let mut panel =
            Panel::new(x, Axis::new("mean squared error", "", Scale::Log)).with_title(query.title());
        let fine: Vec<f64> =
            (0..=64).map(|i| FIRST * libm::exp2(f64::from(i) / 16.0 - f64::from(STOPS))).collect();
        let plain = |&r: &f64| Ok(Case::new(query, photons(settings), r)?.squared());
        let line = fine.iter().map(plain).collect::<anyhow::Result<Vec<f64>>>()?;
        panel = panel.with(Line::new("plain", 0, fine, line).with_dash(Dash::Solid));
        let ladder = |of: fn(u32) -> Estimator, from: u32| -> Vec<(u32, &Answer)> {
            (from..=STOPS).filter_map(|k| Some((k, find(answers, query, of(k))?))).collect()
        };
        for (class, label, own) in [
            (0, "plain", ladder(Estimator::Plain, 0)),
            (1, "telescoping sum from 0.8 mfp", ladder(Estimator::Stopped, 1)),
        ] {
            let x: Vec<f64> = own.iter().map(|(k, _)| radius(*k)).collect();
            if class == 1 {
                let line = own.iter().map(|(_, a)| a.expected.squared).collect();
                panel = panel.with(Line::new(label, class, x.clone(), line).with_dash(Dash::Solid));
            }
            let moments: Vec<Moments> = own.iter().map(|(_, a)| a.squared()).collect();
            let y = moments.iter().map(Moments::mean).collect();
            let bars = moments.iter().map(positive_bar).collect();
            panel = panel.with(Points::new(label, class, x, y).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = format!(
        "Mean squared error, over the square of the exact value, of {} photons: plain estimates of one radius, and sums that start at 0.8 mean free \
         paths and halve the radius at each level down to the one on the axis; measured (points, 95 % intervals over cells) and predicted \
         before the run (lines, of sums straight between the levels). Where noise rules, a sum has the plain estimate's error times the price \
         of its levels; nowhere is it below the lowest point of the plain curve.",
        photons(settings)
    );
    FigureFiles::draw("stopped", &caption, &figure)
}

/// Left: magnitudes of differences of one number of photons. Right: how far off answers of equal work are.
pub fn drawn(levels: &[Level], tails: &[Tail], settings: &Settings) -> anyhow::Result<FigureFiles> {
    let mut left = Panel::new(
        Axis::linear("level", "").with_range(-0.3, 7.3),
        Axis::linear("mean magnitude of the difference", "").with_range(0.0, 2.0),
    )
    .with_title("one number of photons")
    .with_legend(Legend::Below);
    let y = Axis::new("part of the answers beyond", "%", Scale::LogClipped).with_range(0.1, 120.0);
    let x = Axis::log("distance over the plain root mean square", "").with_range(0.11, 40.0);
    let mut right = Panel::new(x, y).with_title("equal photons").with_legend(Legend::Below);
    right = right.with(Rule::new(Along::Vertical(1.0)).with_dash(Dash::Dotted));
    for (class, query) in QUERIES.into_iter().enumerate() {
        let own: Vec<&Level> = levels.iter().filter(|l| l.query == query).collect();
        let x: Vec<f64> = own.iter().map(|l| f64::from(l.level)).collect();
        let line = own.iter().map(|l| l.predicted).collect();
        left = left.with(Line::new(query.title(), class, x.clone(), line).with_dash(Dash::Solid));
        let moments: Vec<Moments> = own.iter().map(|l| l.moments()).collect();
        let y = moments.iter().map(Moments::mean).collect();
        let bars = moments.iter().map(positive_bar).collect();
        left = left.with(Points::new(query.title(), class, x, y).with_y_interval(bars));
        for tail in tails.iter().filter(|t| t.query == query) {
            let (label, dash) = match tail.estimator {
                Estimator::Drawn => (format!("{}, sums", query.title()), Dash::Solid),
                _ => (format!("{}, plain", query.title()), Dash::Dashed),
            };
            let parts: Vec<Moments> = (0..thresholds().len()).map(|i| tail.beyond(i)).collect();
            let y: Vec<f64> = parts.iter().map(|m| 100.0 * m.mean()).collect();
            if tail.estimator == Estimator::Drawn {
                let bars = parts.iter().map(bar).map(|(low, high)| (100.0 * low, 100.0 * high)).collect();
                right = right.with(Points::new(&label, class, thresholds(), y.clone()).with_y_interval(bars));
            }
            right = right.with(Line::new(label, class, thresholds(), y).with_dash(dash));
        }
    }
    let figure = Figure { width: Width::Double, columns: 2, ..Figure::new(vec![left, right]) };
    let caption = format!(
        "Left: mean magnitude of the difference between the estimates of two radii, 0.8 mean free paths halved level times and once more, over the \
         exact value, from the same few photons at every level (1,000 for places, 100 for rays): measured (points, 95 % intervals over cells) and \
         predicted (lines). It tends to 2 (1 − 2^-c) and does not fall: a sum over levels of one number of photons has no mean. Right: part of \
         the answers that are farther from the exact value than a multiple of the root mean square error of the plain estimate at its best \
         radius: unbiased sums whose levels are drawn at random (points with 95 % intervals over cells, solid lines) and that plain estimate \
         (dashed), {} photons each on average. At the dotted line a normal error is beyond in 32 %; the sums are in more than half of all \
         answers, and their tails are heavier by far.",
        work(settings)
    );
    FigureFiles::draw("drawn", &caption, &figure)
}
