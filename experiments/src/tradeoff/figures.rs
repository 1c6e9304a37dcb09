//! The figures.

use super::cases::{FIELDS, Field, MODERATE, Setting, Treatment};
use super::choose::{Choice, Currency, break_even, frontier, most_efficient};
use super::data::{Data, Measured, Paths, mean};
use super::split::{rms, rms_bias, rms_noise};
use super::theory::{Expected, Rms, Theory};
use crate::harness::{Estimate, FigureFiles, Settings, percent};
use crate::setups::Size;
use turbid_figure::{Align, Along, At, Axis, Dash, Figure, Line, Note, Panel, Points, Rule, Scale, Width};

/// All figures.
pub fn all(settings: &Settings, data: &Data) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![costs(data)?, sizes(settings, data)?, queries(data)?])
}

/// The 95 per cent interval of an estimate, kept above zero for logarithmic axes.
fn interval(estimate: &Estimate) -> (f64, f64) {
    let interval = estimate.interval(0.95);
    (percent(interval.low.max(0.0)), percent(interval.high))
}

/// Error against cost.
fn costs(data: &Data) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for field in FIELDS {
        let Some(paths) = data.paths(field) else { continue };
        let x = Axis::log("operations for 4096 queries", "").with_range(4e3, 3e7);
        let mut panel =
            Panel::new(x, Axis::log("RMS error", "%").with_range(1.0, 100.0)).with_title(field.title);
        let (x, y) = path_line(paths, 4096.0);
        panel = panel.with(Line::theory("path tracer", x, y));
        for (class, treatment) in Treatment::ALL.into_iter().enumerate() {
            let label = format!("photon map, {}", treatment.title());
            let front = frontier(&data.of(field, treatment, None), |m| m.cost(4096.0));
            let x: Vec<f64> = front.iter().map(|c| c.case.cost(4096.0)).collect();
            let y: Vec<f64> = front.iter().map(|c| percent(c.rms.value())).collect();
            let bars = front.iter().map(|c: &Choice| interval(&c.rms)).collect();
            panel = panel.with(Line::new(&label, class, x.clone(), y.clone()));
            panel = panel.with(Points::new(&label, class, x, y).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = "Root mean square error over 4096 probes against the operations that they cost: the photon map's \
                   settings that no other setting beats in both, chosen on half of the maps and shown for the other \
                   (95 % intervals are smaller than most points), and the path tracer, whose error falls as one over \
                   the root of its cost and starts where each query has one sample. Left of the black line the map is the cheaper. In the thin isotropic \
                   slab it is not; in the emitting sphere, where paths gather light all along their rays, the two cost nearly the same; \
                   in thick fog the map is the cheaper by far. Untreated estimates stop early at the faces' loss.";
    FigureFiles::draw("costs", caption, &figure)
}

/// The path tracer's operations and errors [%] from one sample a query on.
fn path_line(paths: &Paths, queries: f64) -> (Vec<f64>, Vec<f64>) {
    let one = mean(&paths.variance).sqrt();
    let steps = (0..=40).map(|i| one * libm::exp(-0.15 * f64::from(i)));
    steps.map(|error| (queries * paths.cost(error), percent(error))).unzip()
}

/// Error, bias and noise against gather size.
fn sizes(settings: &Settings, data: &Data) -> anyhow::Result<FigureFiles> {
    let field: &'static Field = &MODERATE;
    let photons = data.largest(field);
    let every = Setting::every(settings);
    let theory = Theory::new(field, every.iter())?;
    let mut panels = Vec::new();
    for treatment in Treatment::ALL {
        let cases = data.of(field, treatment, Some(photons));
        for is_fixed in [true, false] {
            let chosen: Vec<&Measured> = cases
                .iter()
                .copied()
                .filter(|m| matches!(m.setting.size, Size::Radius(_)) == is_fixed)
                .collect();
            let size = |m: &Measured| match m.setting.size {
                Size::Radius(r) => r,
                Size::Nearest(k) => k as f64,
            };
            let least = chosen.iter().map(|m| size(m)).fold(f64::INFINITY, f64::min);
            let most = chosen.iter().map(|m| size(m)).fold(0.0, f64::max);
            let range = (least / 1.3, most * 1.3);
            let (lines, x, what) = if is_fixed {
                let lines = radius_lines(&theory, field, photons, treatment, range)?;
                (lines, Axis::log("radius", "mfp"), "fixed radius")
            } else {
                let lines: Vec<(f64, Rms)> = chosen.iter().map(|m| (size(m), m.predicted())).collect();
                (lines, Axis::log("k", ""), "k nearest")
            };
            let x = x.with_range(range.0, range.1);
            let y = Axis::new("RMS", "%", Scale::LogClipped).with_range(0.2, 60.0);
            let mut panel = Panel::new(x, y).with_title(format!("{what}, {}", treatment.title()));
            type Part = (&'static str, fn(&Rms) -> f64, fn(&[super::split::MapError]) -> Estimate);
            let parts: [Part; 3] = [
                ("error", Rms::total, rms),
                ("bias", |r| r.bias, rms_bias),
                ("noise", |r| r.noise, rms_noise),
            ];
            for (class, (label, predicted, measured)) in parts.into_iter().enumerate() {
                let found: Vec<Estimate> = chosen.iter().map(|m| measured(&m.maps)).collect();
                let line = lines.iter().map(|(_, r)| percent(predicted(r))).collect();
                panel = panel.with(Line::new(label, class, lines.iter().map(|l| l.0).collect(), line));
                let y = found.iter().map(|e| percent(e.value())).collect();
                let bars = found.iter().map(interval).collect();
                let x = chosen.iter().map(|m| size(m)).collect();
                panel = panel.with(Points::new(label, class, x, y).with_y_interval(bars));
            }
            panels.push(panel);
        }
    }
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = format!(
        "{}, maps of {photons} photons: root mean square error over all probes, split into bias and noise, against the \
         size of the gather; points measured with 95 % intervals over maps, lines predicted before the run. Noise \
         falls and bias grows with the size, and the error is least where they cross, or nearly. Plain estimates carry \
         the loss at the faces as a bias that no radius in reach makes small; clipping leaves the blur.",
        field.title
    );
    FigureFiles::draw("sizes", &caption, &figure)
}

fn radius_lines(
    theory: &Theory,
    field: &Field,
    photons: u64,
    treatment: Treatment,
    (from, to): (f64, f64),
) -> anyhow::Result<Vec<(f64, Rms)>> {
    let one = |i: i32| {
        let radius = from * libm::pow(to / from, f64::from(i) / 40.0);
        let layers = field.depths().into_iter().map(|t| theory.within(radius, photons as f64, treatment, t));
        Ok((radius, Rms::of(&layers.collect::<anyhow::Result<Vec<Expected>>>()?)))
    };
    (0..=40).map(one).collect()
}

/// Cost against the number of queries.
fn queries(data: &Data) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for field in FIELDS {
        let (Some(paths), cases) = (data.paths(field), data.of(field, Treatment::Clipped, None)) else {
            continue;
        };
        let Some(chosen) = most_efficient(&cases) else { continue };
        let x: Vec<f64> = (0..=60).map(|i| libm::exp10(0.1 * f64::from(i))).collect();
        let map = x.iter().map(|&q| chosen.case.cost(q)).collect();
        let by_paths = x.iter().map(|&q| q * paths.cost(chosen.rms.value())).collect();
        let mut panel = Panel::new(
            Axis::log("queries", "").with_range(1.0, 1e6),
            Axis::log("operations", "").with_range(10.0, 1e11),
        )
        .with_title(format!("{}, to {:.1} %", field.title, percent(chosen.rms.value())))
        .with(Line::theory("path tracer", x.clone(), by_paths))
        .with(Line::new("photon map, clipped", 1, x, map));
        let text = match break_even(chosen.case, paths, Currency::Operations).queries {
            Some(queries) => {
                let interval = queries.interval(0.95);
                let rule = Rule::new(Along::Vertical(queries.value())).with_dash(Dash::Dashed);
                panel = panel.with(rule.with_label("break-even"));
                format!("Q* = {:.0} ({:.0} to {:.0})", queries.value(), interval.low, interval.high)
            }
            None => "never".to_string(),
        };
        panel = panel.with(Note { text, at: At::Fraction(0.95, 0.08), align: Align::End });
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = "Operations against the number of queries, at the error of the most efficient clipped setting, by the \
                   photon map and by a path tracer of the same error. The map is paid for before the first query; from \
                   the break-even Q* (95 % interval) it is the cheaper of the two. In the emitting sphere that takes thousands of queries. In the thin isotropic slab one path \
                   query takes fewer rays than the map gathers photons, and the map never pays in operations; in seconds, where a \
                   photon gathered is cheaper than a ray, it does.";
    FigureFiles::draw("queries", caption, &figure)
}
