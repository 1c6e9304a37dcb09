//! The figure of the pictures.

use super::SIDE;
use super::data::{Currency, Fit};
use super::results::{Crossing, Pictures, middle};
use crate::harness::{Curves, FigureFiles, Point, percent};
use turbid_figure::{Along, Axis, Figure, Line, Panel, Points, Rule, Width};

/// Samples a pixel that have points.
const NUMBERS: [f64; 3] = [1.0, 8.0, 64.0];
const PIXELS: f64 = (SIDE * SIDE) as f64;

/// A root mean square over the mean, in per cent.
fn over(square: f64, mean: f64) -> f64 {
    percent(square.sqrt() / mean)
}

/// A curve of the error [%] against cost, from one sample a pixel to 4096.
fn curve(error: impl Fn(f64) -> f64, cost: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    (0..=48).map(|i| libm::exp2(0.25 * f64::from(i))).map(|n| (cost(n), error(n))).unzip()
}

fn panel(pictures: &Pictures, currency: Currency, crossing: &Crossing) -> Panel {
    let fit = pictures.fit(currency);
    let resampled: Vec<Fit> = pictures.resampled(currency).collect();
    let unit = match currency {
        Currency::Rays => ("work", "rays"),
        Currency::Seconds => ("CPU time", "s"),
    };
    let mut panel =
        Panel::new(Axis::log(unit.0, unit.1), Axis::log("error", "% of the mean").with_range(2.0, 250.0))
            .with(Rule::new(Along::Horizontal(percent(crossing.at))).with_label("paths are cheaper below"));
    let paths = fit.paths;
    let error = |fit: &Fit, n: f64| over(fit.paths.noise / n, fit.mean);
    let (x, y) = curve(|n| error(&fit, n), |n| PIXELS * n * paths.sample);
    panel = panel.with(Line::new("paths", 0, x, y));
    let x = NUMBERS.map(|n| PIXELS * n * paths.sample).to_vec();
    let bars = NUMBERS.map(|n| {
        let i = middle(resampled.iter().map(|f| error(f, n)).collect());
        (i.low, i.high)
    });
    let y = NUMBERS.map(|n| error(&fit, n)).to_vec();
    panel = panel.with(Points::new("paths", 0, x, y).with_y_interval(bars.to_vec()));
    for (i, size) in pictures.sizes.iter().enumerate() {
        let label = format!("map of {} photons, k = {}", size.photons, size.k);
        let maps = fit.maps[i];
        let error = |fit: &Fit, n: f64| over(fit.maps[i].square(n), fit.mean);
        let cost = |n: f64| maps.fill + PIXELS * n * maps.sample;
        let (x, y) = curve(|n| error(&fit, n), cost);
        let bars = NUMBERS.map(|n| {
            let i = middle(resampled.iter().map(|f| error(f, n)).collect());
            (i.low, i.high)
        });
        panel = panel.with(Line::new(&label, i + 1, x, y)).with(
            Points::new(&label, i + 1, NUMBERS.map(cost).to_vec(), NUMBERS.map(|n| error(&fit, n)).to_vec())
                .with_y_interval(bars.to_vec()),
        );
    }
    panel
}

/// Error against cost, in CPU time and in work.
pub fn cost(pictures: &Pictures, seconds: &Crossing, rays: &Crossing) -> anyhow::Result<FigureFiles> {
    let panels = vec![panel(pictures, Currency::Seconds, seconds), panel(pictures, Currency::Rays, rays)];
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = format!(
        "A picture of {SIDE} x {SIDE} pixels of a box of fog by photon maps of several sizes and by paths: root mean square \
         error of a pixel against CPU time of this machine (left) and work (right), for 1, 8 and 64 samples per pixel \
         (points, with bootstrap intervals of 95 % over maps) and all between (lines). Maps start later, for they have to be \
         filled, then fall to the error that all samples of one map share. The rule is the error below which \
         paths are cheaper than every map."
    );
    FigureFiles::draw("equal-error", &caption, &figure)
}

/// Error against CPU time of maps that no other beats in both, and of paths.
pub fn curves(pictures: &Pictures) -> Curves {
    let fit = pictures.fit(Currency::Seconds);
    let resampled: Vec<Fit> = pictures.resampled(Currency::Seconds).collect();
    let mut maps: Vec<Point> = Vec::new();
    for (i, of_size) in fit.maps.iter().enumerate() {
        for n in NUMBERS {
            let error = |fit: &Fit| fit.maps[i].square(n).sqrt() / fit.mean;
            let interval = middle(resampled.iter().map(error).collect());
            let seconds = of_size.fill + PIXELS * n * of_size.sample;
            maps.push(Point { seconds, error: error(&fit), interval: (interval.low, interval.high) });
        }
    }
    maps.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut least = f64::INFINITY;
    maps.retain(|point| {
        let is_better = point.error < least;
        least = least.min(point.error);
        is_better
    });
    let (seconds, errors) =
        curve(|n| (fit.paths.noise / n).sqrt() / fit.mean, |n| PIXELS * n * fit.paths.sample);
    Curves { maps, untreated: Vec::new(), paths: seconds.into_iter().zip(errors).collect() }
}
