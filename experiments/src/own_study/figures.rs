//! The figures of one scene: error against the size of the gather, against photons, and against CPU time.

use super::data::{Data, Half, Setting};
use super::words;
use crate::harness::{Estimate, FigureFiles, percent};
use turbid_figure::{Axis, Dash, Figure, Legend, Line, Panel, Points, Width};

/// Families that a figure tells apart.
const MOST_FAMILIES: usize = 5;

/// Scenes that are drawn; the rest is in results.csv.
pub const MOST_SCENES: usize = 6;

/// The 95 per cent interval of an error, kept above zero for logarithmic axes \[%\].
fn interval(estimate: &Estimate) -> (f64, f64) {
    let interval = estimate.interval(0.95);
    let low = interval.low.max(0.02 * estimate.value());
    (percent(low), percent(interval.high))
}

/// Whether an error goes on logarithmic axes, with an interval.
fn is_drawn((x, error): &(f64, Estimate)) -> bool {
    *x > 0.0 && error.value() > 0.0 && error.std_error().is_finite()
}

/// Points and a line of errors.
fn with_errors(panel: Panel, label: &str, class: usize, at: Vec<(f64, Estimate)>) -> Panel {
    let at: Vec<_> = at.into_iter().filter(is_drawn).collect();
    if at.is_empty() {
        return panel;
    }
    let x: Vec<f64> = at.iter().map(|(x, _)| *x).collect();
    let y: Vec<f64> = at.iter().map(|(_, e)| percent(e.value())).collect();
    let bars = at.iter().map(|(_, e)| interval(e)).collect();
    let panel = if x.len() > 1 { panel.with(Line::new(label, class, x.clone(), y.clone())) } else { panel };
    panel.with(Points::new(label, class, x, y).with_y_interval(bars))
}

fn title(data: &Data) -> String {
    if data.point.label.is_empty() { String::new() } else { format!("{}: ", data.point.label) }
}

/// The figures of one scene, of this number.
///
/// # Errors
/// If one cannot be drawn
pub fn of_scene(data: &Data, number: usize, target: f64) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(costs(data, number, target)?.into_iter().chain(sizes(data, number)?).collect())
}

/// Error against the size of the gather, at the most photons.
fn sizes(data: &Data, number: usize) -> anyhow::Result<Option<FigureFiles>> {
    let Some(&(photons, _)) = data.stored.last() else { return Ok(None) };
    let mut panels = Vec::new();
    let families: Vec<String> = data.families().into_iter().take(MOST_FAMILIES).collect();
    for (is_fixed, label, unit) in [(true, "radius", "L"), (false, "k", "")] {
        let mut panel = Panel::new(Axis::log(label, unit), Axis::log("RMS error", "%"))
            .with_title(if is_fixed { "fixed radius" } else { "k nearest" })
            .with_legend(Legend::Below);
        let mut has_points = false;
        for (class, family) in families.iter().enumerate() {
            let own: Vec<&Setting> = data
                .settings
                .iter()
                .filter(|s| s.photons == photons && words::is_fixed(s.estimator) == is_fixed)
                .filter(|s| words::family(s.estimator) == *family)
                .collect();
            // One size alone is no ladder.
            if own.len() < 2 {
                continue;
            }
            let mut at: Vec<(f64, Estimate)> =
                own.iter().map(|s| (words::size(s.estimator), s.rmse(Half::Both))).collect();
            has_points |= at.iter().any(is_drawn);
            at.sort_by(|a, b| a.0.total_cmp(&b.0));
            let short = family.split_once(", ").map_or(family.as_str(), |(_, rest)| rest);
            panel = with_errors(panel, short, class, at);
            if let Some(best) = data.best(family).into_iter().find(|s| s.photons == photons) {
                let at = vec![(words::size(best.estimator), best.rmse(Half::Both))];
                panel = with_errors(panel, "best of each", MOST_FAMILIES, at);
            }
        }
        if has_points {
            panels.push(panel);
        }
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let width = if panels.len() > 1 { Width::Double } else { Width::Single };
    let figure = Figure { width, columns: panels.len(), ..Figure::new(panels) };
    let caption = format!(
        "{}root mean square error over places of maps of {photons} photons, relative to the reference, against the size of the \
         gather, with 95 % intervals over maps. Small gathers are noisy, large ones blur; the best of each kind, chosen by \
         half of the maps, is marked.",
        title(data)
    );
    FigureFiles::draw(&format!("sizes-scene{number:03}"), &caption, &figure).map(Some)
}

/// Error against photons and against CPU time; none where the maps are too few to tell any error.
fn costs(data: &Data, number: usize, target: f64) -> anyhow::Result<Option<FigureFiles>> {
    let mut panels = Vec::new();
    if data.stored.len() > 1 {
        let mut panel = Panel::new(Axis::log("photons emitted", ""), Axis::log("RMS error", "%"))
            .with_title("best gather of each kind")
            .with_legend(Legend::Below);
        let mut has_points = false;
        for (class, family) in data.families().iter().take(MOST_FAMILIES).enumerate() {
            let at: Vec<(f64, Estimate)> =
                data.best(family).iter().map(|s| (s.photons as f64, s.rmse(Half::Telling))).collect();
            has_points |= at.iter().any(is_drawn);
            panel = with_errors(panel, family, class, at);
        }
        if has_points {
            panels.push(panel);
        }
    }
    let mut panel = Panel::new(Axis::log("CPU time", "s"), Axis::log("RMS error", "%"))
        .with_title("of all places together")
        .with_legend(Legend::Below);
    let front = data.frontier();
    let at: Vec<(f64, Estimate)> = front.iter().map(|s| (s.time(), s.rmse(Half::Telling))).collect();
    let (least, most) =
        at.iter().fold((f64::INFINITY, 0.0f64), |(low, high), (x, _)| (low.min(*x), high.max(*x)));
    let has_points = at.iter().any(is_drawn);
    panel = with_errors(panel, "photon maps", 0, at);
    if let Some(rival) = data.rival.as_ref().filter(|r| r.variance.value() > 0.0 && least > 0.0) {
        // A decade on either side of the maps.
        let step = |i: i32| 0.1 * least * libm::pow(100.0 * most / least, f64::from(i) / 40.0);
        let x: Vec<f64> = (0..=40).map(step).collect();
        let y = x.iter().map(|t| percent(rival.error_at(*t))).collect();
        panel = panel.with(Line::theory(data.reference.sampler.name(), x.clone(), y));
        let line = vec![percent(target); x.len()];
        panel = panel.with(Line::theory("target", x, line).with_dash(Dash::Dotted));
    }
    if has_points {
        panels.push(panel);
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let width = if panels.len() > 1 { Width::Double } else { Width::Single };
    let figure = Figure { width, columns: panels.len(), ..Figure::new(panels) };
    let caption = format!(
        "{}root mean square error over {} places, relative to the reference. Gathers are chosen by half of the maps, and \
         their errors told by the other half, with 95 % intervals. Against time: the best setting for each number of photons, beside {}, \
         whose error falls as one over the root of the time.",
        title(data),
        data.usable(),
        data.reference.sampler.name()
    );
    FigureFiles::draw(&format!("costs-scene{number:03}"), &caption, &figure).map(Some)
}
