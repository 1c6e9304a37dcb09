//! The figures.

use super::cases::Class;
use super::lattice::kernel_on_lattice;
use super::results::{Results, StretchedResult};
use super::storage::{self, RADIUS, Rule};
use crate::harness::{FigureFiles, percent, percent_bar};
use crate::setups::Size;
use crate::theory::kernel_title;
use turbid::estimators::Kernel;
use turbid::stats::Moments;
use turbid_figure::{Along, Axis, Dash, Figure, Legend, Line, Panel, Points, Rule as Ruler, Scale, Width};

/// All figures, the storage question first.
pub fn all(results: &Results) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![storage_figure(results)?, strip(results)?, stretched(results)?])
}

/// Fewest photons that must have changed sides for a mean square to mean something.
const ENOUGH: f64 = 16.0;

fn storage_figure(results: &Results) -> anyhow::Result<FigureFiles> {
    let x_axis = || Axis::log("extent of the map over gather radius", "");
    let mut left = Panel::new(x_axis(), Axis::log("rms difference", "standard errors"))
        .with_title("(a) per estimate")
        .with(
            Ruler::new(Along::Horizontal(0.01))
                .with_label("a hundredth of the noise")
                .with_dash(Dash::Dotted),
        );
    let mut right = Panel::new(
        x_axis(),
        Axis::new("mean difference", "%", Scale::SymLog { threshold: 1e-2 }).with_range(-100.0, 100.0),
    )
    .with_title("(b) on average");
    for (class, rule) in Rule::ALL.into_iter().enumerate() {
        let chosen: Vec<_> = results.storage.iter().filter(|r| r.rule == rule).collect();
        let label = match rule {
            Rule::Fixed => format!("radius {RADIUS}"),
            Rule::Nearest => format!("{} nearest", storage::K),
        };
        let x: Vec<f64> = chosen.iter().map(|r| r.extent_in_radii()).collect();
        let line = chosen.iter().map(|r| r.predicted_rms).collect();
        left = left.with(Line::new(&label, class, x.clone(), line));
        let seen: Vec<_> = chosen
            .iter()
            .filter(|r| r.rms.value() > 0.0 && (rule == Rule::Nearest || r.moved >= ENOUGH))
            .collect();
        let bars = seen.iter().map(|r| {
            let interval = r.rms.interval(0.95);
            (interval.low.max(1e-9), interval.high)
        });
        left = left.with(
            Points::new(
                &label,
                class,
                seen.iter().map(|r| r.extent_in_radii()).collect(),
                seen.iter().map(|r| r.rms.value()).collect(),
            )
            .with_y_interval(bars.collect()),
        );
        right = right.with(Line::new(
            &label,
            class,
            x.clone(),
            chosen.iter().map(|r| percent(r.predicted.0)).collect(),
        ));
        // Beside each other, not on top of each other.
        let beside = x.iter().map(|x| x * (1.0 + 0.12 * class as f64)).collect();
        let mean = chosen.iter().map(|r| percent(r.difference.mean())).collect();
        let bars = chosen.iter().map(|r| percent_bar(&r.difference)).collect();
        right = right.with(Points::new(&label, class, beside, mean).with_y_interval(bars));
    }
    let figure =
        Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(vec![left, right]) };
    let caption = "One set of photons gathered twice, from single precision and from double precision, while one \
                   distant photon stretches the map: points measured with 95 % intervals over maps, lines join what was predicted \
                   before the run. (a) The root mean square difference of one estimate, in units of that estimate's \
                   own standard error; fixed radii are drawn where at least 16 photons changed sides. It stays below a \
                   hundredth up to some thousand radii. (b) The mean difference in per cent of the exact fluence, \
                   linear within 0.01 %: nothing, until stored positions are a tenth of a radius apart.";
    FigureFiles::draw("storage", caption, &figure)
}

/// z of the sampled rows, and the checked rows over their bounds.
fn strip(results: &Results) -> anyhow::Result<FigureFiles> {
    let mut place = 0.0;
    let mut names = Vec::new();
    let mut upper = Panel::new(
        Axis::linear("", ""),
        Axis::linear("(measured − exact) / standard error", "").with_range(-6.0, 6.0),
    )
    .with_title("(a) sampled rows")
    .with(Ruler::new(Along::Horizontal(0.0)));
    for sign in [-1.0, 1.0] {
        upper = upper.with(Ruler::new(Along::Horizontal(4.9 * sign)).with_dash(Dash::Dotted));
    }
    for (color, class) in Class::SAMPLED.into_iter().enumerate() {
        let mut z: Vec<f64> = results.sampled.iter().filter(|r| r.class == class).map(|r| r.z()).collect();
        if class == Class::Number {
            z.extend(results.large.iter().map(|r| r.z()));
        }
        let x: Vec<f64> = (0..z.len()).map(|i| place + i as f64).collect();
        let bars = z.iter().map(|z| (z - 1.96, z + 1.96)).collect();
        names.push((place + 0.5 * (z.len() as f64 - 1.0), class.name().to_string()));
        place += z.len() as f64 + 2.0;
        upper = upper.with(Points::new("", color, x, z).with_y_interval(bars));
    }
    upper.x = Axis { names, ..Axis::linear("", "") }.with_range(-2.0, place - 1.0);
    let mut lower = Panel::new(
        Axis::linear("", ""),
        Axis::new("difference / bound", "", Scale::LogClipped).with_range(1e-5, 10.0),
    )
    .with_title("(b) checked rows")
    .with(Ruler::new(Along::Horizontal(1.0)).with_dash(Dash::Dotted));
    let (mut place, mut names) = (0.0, Vec::new());
    for (color, class) in Class::ALL.into_iter().enumerate() {
        let share: Vec<f64> =
            results.checked.iter().filter(|r| r.class == class).map(|r| r.share().min(1e300)).collect();
        if share.is_empty() {
            continue;
        }
        let x: Vec<f64> = (0..share.len()).map(|i| place + i as f64).collect();
        names.push((place + 0.5 * (share.len() as f64 - 1.0), class.name().to_string()));
        place += share.len() as f64 + 4.0;
        lower = lower.with(Points::new("", color % 7, x, share));
    }
    lower.x = Axis { names, ..Axis::linear("", "") }.with_range(-3.0, place - 1.0);
    let figure = Figure {
        width: Width::Double,
        columns: 1,
        heights: vec![0.3, 0.3],
        ..Figure::new(vec![upper.with_legend(Legend::Hidden), lower.with_legend(Legend::Hidden)])
    };
    let caption = "Every row by what it is about, in the order of the tables. (a) Sampled rows: distance from the exact \
                   value in standard errors, with 95 % intervals; the dotted lines are where one right row in a \
                   million lies beyond. (b) Checked rows: difference from the exact value over what roundings allow; \
                   arrows at the lower border are rows whose number is the exact one, bit for bit.";
    FigureFiles::draw("rows", caption, &figure)
}

/// Error of stretched maps against the distance of planes over the radius.
fn stretched(results: &Results) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::log("distance of stored positions over gather radius", "").with_range(0.1, 4.0),
        Axis::new("error", "%", Scale::SymLog { threshold: 1.0 }).with_range(-60.0, 400.0),
    );
    let grid: Vec<f64> = (0..=900).map(|i| 0.1 * libm::pow(40.0, f64::from(i) / 900.0)).collect();
    for (class, kernel) in Kernel::ALL.into_iter().enumerate() {
        let line: anyhow::Result<Vec<f64>> =
            grid.iter().map(|&s| Ok(percent(kernel_on_lattice(kernel, s)?.0 - 1.0))).collect();
        panel = panel.with(Line::new(kernel_title(kernel), class, grid.clone(), line?));
        let spacing = |r: &StretchedResult| match r.case.size {
            Size::Radius(radius) => r.case.spacing() / radius,
            Size::Nearest(_) => 0.0,
        };
        let chosen: Vec<_> =
            results.stretched.iter().filter(|r| r.case.kernel == kernel && spacing(r) > 0.1).collect();
        let error = |r: &StretchedResult| r.errors.iter().collect::<Moments>();
        let x = chosen.iter().map(|r| spacing(r)).collect();
        let y = chosen.iter().map(|r| percent(error(r).mean())).collect();
        let bars = chosen.iter().map(|r| percent_bar(&error(r))).collect();
        panel = panel.with(Points::new(kernel_title(kernel), class, x, y).with_y_interval(bars));
    }
    let figure = Figure {
        width: Width::Double,
        heights: vec![0.5],
        ..Figure::new(vec![panel.with_legend(Legend::Right)])
    };
    let caption = "Maps stretched until stored positions lie on planes as far apart as the gathers are wide: error of \
                   the density, measured on independent photons (points, 95 % intervals over maps) and predicted \
                   before the run by the kernel on a lattice (lines); linear within ±1 %. Smoother kernels feel the \
                   planes later. No map of fog comes near: its planes are a millionth of a radius apart.";
    FigureFiles::draw("stretched", caption, &figure)
}
