//! The figures.

use super::cases::Case;
use super::fields::{FIELDS, Field, UNCOLLIDED};
use super::measure::{is_fano_case, path_case};
use super::predict::Theory;
use super::results::{CaseResult, Mistake, exact_at, fano, largest, predicted_fano};
use crate::harness::{Cells, FigureFiles, Settings, bar, percent, percent_bar};
use crate::prediction::Term;
use crate::setups::Size;
use crate::theory::GATHER_TERMS;
use turbid::estimators::Kernel;
use turbid::stats::Moments;
use turbid_figure::{Along, Axis, Color, Figure, Histogram, Legend, Line, Panel, Points, Rule, Scale, Width};

/// All figures, the budget first.
pub fn all(
    settings: &Settings,
    cells: &Cells,
    results: &[CaseResult],
    mistakes: &[Mistake],
) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![
        budget(results, mistakes)?,
        orders(results)?,
        depths(settings, cells, results)?,
        counts(cells, results)?,
    ])
}

/// Measured against predicted error of every case, and what is left.
fn budget(results: &[CaseResult], mistakes: &[Mistake]) -> anyhow::Result<FigureFiles> {
    let axis = |label: &str| Axis::new(label, "%", Scale::SymLog { threshold: 1.0 });
    let mut panel = Panel::new(axis("predicted error"), axis("measured error"))
        .with(Rule::new(Along::Diagonal).with_label("measured = predicted"));
    let blind: Vec<&CaseResult> =
        results.iter().filter(|r| !r.case.is_biased && !r.sees_prediction()).collect();
    let x = blind.iter().map(|r| percent(r.predicted())).collect();
    let y = blind.iter().map(|r| percent(r.error.mean())).collect();
    let bars = blind.iter().map(|r| percent_bar(&r.error)).collect();
    let label = "too noisy to detect its prediction";
    let noisy = Points::new(label, 0, x, y).with_y_interval(bars);
    panel = panel.with(Points { color: Color::Grey, ..noisy });
    for (class, term) in GATHER_TERMS.into_iter().enumerate() {
        // The rule's own part is a fault, and drawn as one.
        let chosen: Vec<&CaseResult> = results
            .iter()
            .filter(|r| !r.case.is_biased && r.sees_prediction() && r.expected.dominant() == Some(term))
            .collect();
        if chosen.is_empty() {
            continue;
        }
        let label = format!("mostly {}", term.name());
        let x = chosen.iter().map(|r| percent(r.predicted())).collect();
        let y = chosen.iter().map(|r| percent(r.error.mean())).collect();
        let bars = chosen.iter().map(|r| percent_bar(&r.error)).collect();
        panel = panel.with(Points::new(&label, class, x, y).with_y_interval(bars));
    }
    let biased: Vec<&CaseResult> = results.iter().filter(|r| r.case.is_biased && r.is_whole()).collect();
    let x: Vec<f64> =
        biased.iter().map(|r| percent(r.expected.total() - r.expected.of(Term::Nearest))).collect();
    let y: Vec<f64> = biased.iter().map(|r| percent(r.error.mean())).collect();
    let bars = biased.iter().map(|r| percent_bar(&r.error)).collect();
    panel = panel.with(Points::new("wrong: k-th photon summed", 2, x, y).with_y_interval(bars));
    for (class, name) in [(5, "divided by sigma_s"), (6, "divided by stored photons")] {
        let chosen: Vec<&Mistake> = mistakes.iter().filter(|m| m.name == name).collect();
        let x = chosen.iter().map(|m| percent(m.predicted)).collect();
        let y = chosen.iter().map(|m| percent(m.error.mean())).collect();
        let bars = chosen.iter().map(|m| percent_bar(&m.error)).collect();
        panel = panel.with(Points::new(format!("wrong: {name}"), class, x, y).with_y_interval(bars));
    }
    let z: Vec<f64> = results.iter().filter(|r| !r.case.is_biased).map(CaseResult::z).collect();
    let edges: Vec<f64> = (-10..=10).map(|i| 0.5 * f64::from(i)).collect();
    let grid: Vec<f64> = (-50..=50).map(|i| 0.1 * f64::from(i)).collect();
    let normal = grid.iter().map(|x| libm::exp(-0.5 * x * x) / (2.0 * std::f64::consts::PI).sqrt()).collect();
    let below = Panel::new(
        Axis::linear("what is left of the error, in standard errors", "").with_range(-5.0, 5.0),
        Axis::linear("density", ""),
    )
    .with(Histogram::density("cases of the right estimators", 0, &z, edges))
    .with(Line::theory("unit normal", grid, normal));
    let figure = Figure {
        width: Width::Double,
        columns: 1,
        heights: vec![0.6, 0.25],
        ..Figure::new(vec![panel.with_legend(Legend::Right), below.with_legend(Legend::Right)])
    };
    let caption = "Signed error of the fluence, measured against predicted, in per cent of the exact value, for every \
                   case of the study with 95 % intervals over maps; linear within ±1 %. Right estimators lie on the \
                   line: what theory said before the run is what was measured. The three wrong estimators, shown in whole balls at the \
                   error predicted for the right one, stand off it. Below: what is left after the \
                   prediction, in standard errors, beside the unit normal density that it would follow if cases were \
                   independent and nothing were overlooked.";
    FigureFiles::draw("budget", caption, &figure)
}

/// The orders in radius, photons and k, on uncollided photons.
fn orders(results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let free = &UNCOLLIDED;
    let most = largest(results, free);
    let of = |depth: f64, photons: u64, is_fixed: bool| {
        results.iter().filter(move |r| {
            let c = &r.case;
            let fits = match c.size {
                Size::Radius(_) => is_fixed,
                Size::Nearest(_) => !is_fixed && !c.is_biased,
            };
            c.field == free && c.photons == photons && c.depth == depth && c.kernel == Kernel::Uniform && fits
        })
    };
    let known = Theory::new(free)?;
    let theory = |photons, depth, sizes: &[Size]| {
        let one = |&size: &Size| {
            let case = Case { field: free, photons, depth, size, is_biased: false, kernel: Kernel::Uniform };
            known.error(&case).map(|error| percent(error.total()))
        };
        sizes.iter().map(one).collect::<anyhow::Result<Vec<f64>>>()
    };
    let size = |case: &Case| match case.size {
        Size::Radius(r) => r,
        Size::Nearest(k) => k as f64,
    };
    let points = |chosen: &[&CaseResult], label: &str, class: usize| {
        let x: Vec<f64> = chosen.iter().map(|r| size(&r.case)).collect();
        let bars = chosen.iter().map(|r| percent_bar(&r.error)).collect();
        let y = chosen.iter().map(|r| percent(r.error.mean())).collect();
        Points::new(label, class, x, y).with_y_interval(bars)
    };
    let mut left = Panel::new(Axis::log("radius", "mfp"), Axis::new("error", "%", Scale::LogClipped))
        .with_title("fixed radius");
    let radii: Vec<f64> = (0..=40).map(|i| 0.08 * libm::exp(0.06 * f64::from(i))).collect();
    let sizes: Vec<Size> = radii.iter().map(|&r| Size::Radius(r)).collect();
    for (class, depth) in [(0, 1.0), (1, 2.0)] {
        let label = format!("depth {depth}");
        let whole: usize = radii.iter().filter(|&&r| r <= depth).count();
        let line = theory(most, depth, &sizes[..whole])?;
        left = left.with(Line::new(&label, class, radii[..whole].to_vec(), line));
        left = left.with(points(&of(depth, most, true).collect::<Vec<_>>(), &label, class));
    }
    let mut right =
        Panel::new(Axis::log("k", ""), Axis::linear("error", "%")).with_title("k nearest, depth 1");
    let mut counts: Vec<u64> =
        results.iter().filter(|r| r.case.field == free).map(|r| r.case.photons).collect();
    counts.dedup();
    let ks: Vec<usize> = vec![4, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500, 700];
    for (class, &photons) in counts.iter().enumerate() {
        let label = format!("{photons} photons");
        // Lines stop where the measured cases do.
        let measured: Vec<&CaseResult> = of(1.0, photons, false).collect();
        if measured.is_empty() {
            continue;
        }
        let most = measured.iter().map(|r| size(&r.case)).fold(0.0, f64::max);
        let ks: Vec<usize> = ks.iter().copied().filter(|&k| k as f64 <= 1.5 * most).collect();
        let sizes: Vec<Size> = ks.iter().map(|&k| Size::Nearest(k)).collect();
        let x = ks.iter().map(|&k| k as f64).collect();
        right = right.with(Line::new(&label, class + 2, x, theory(photons, 1.0, &sizes)?));
        right = right.with(points(&measured, &label, class + 2));
    }
    let figure = Figure { width: Width::Double, columns: 2, ..Figure::new(vec![left, right]) };
    let caption = "Uncollided photons, whole balls: error against gather size, measured (points, 95 % intervals over \
                   maps) and predicted before the run (lines). At a fixed radius the error grows as the square of the \
                   radius, at first, whatever the number of photons; with the k nearest it grows as (k / photons) to \
                   the power 2/3.";
    FigureFiles::draw("orders", caption, &figure)
}

/// Error against depth in each field of all orders.
fn depths(settings: &Settings, cells: &Cells, results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        let known = Theory::new(field)?;
        let photons = field.photons(settings).last().copied().unwrap_or(1);
        let axis = Axis::new("error", "%", Scale::SymLog { threshold: 1.0 }).with_range(-100.0, 10.0);
        let mut panel = Panel::new(Axis::linear("depth", "mfp"), axis).with_title(field.title);
        for (class, radius) in [(0, 0.1), (1, 0.2), (2, 0.4)] {
            let size = Size::Radius(radius);
            let grid: Vec<f64> = (0..=80).map(|i| field.setup.body.deepest() * f64::from(i) / 80.0).collect();
            let theory = grid.iter().map(|&depth| {
                let case = Case { field, photons, depth, size, is_biased: false, kernel: Kernel::Uniform };
                known.error(&case).map(|error| percent(error.total()))
            });
            let theory = theory.collect::<anyhow::Result<Vec<f64>>>()?;
            let chosen: Vec<&CaseResult> = results
                .iter()
                .filter(|r| {
                    let c = &r.case;
                    c.field == field && c.photons == photons && c.size == size && c.kernel == Kernel::Uniform
                })
                .collect();
            let label = format!("radius {radius}");
            let x = chosen.iter().map(|r| r.case.depth).collect();
            let y = chosen.iter().map(|r| percent(r.error.mean())).collect();
            let bars = chosen.iter().map(|r| percent_bar(&r.error)).collect();
            panel = panel.with(Line::new(&label, class, grid, theory));
            panel = panel.with(Points::new(&label, class, x, y).with_y_interval(bars));
        }
        let (x, y, bars) = path_points(cells, results, field)?;
        panel = panel.with(Points::new("path tracer", 4, x, y).with_y_interval(bars));
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = "Error against depth in four slabs of optical thickness 2 lit from depth 0, and in two spheres of radius 2 against \
                   the depth below the surface: photon maps of fixed radius, measured (points, 95 % intervals) and predicted \
                   (lines), and the path tracer. Within a radius of a face part of the ball is outside the fog, and the \
                   estimate loses up to half, or more where the light falls off as well; inside, the blur is a per cent or less in \
                   the slabs and a few in the spheres, where the light bends in all directions. Linear within ±1 %.";
    FigureFiles::draw("depths", caption, &figure)
}

type PointsWithBars = (Vec<f64>, Vec<f64>, Vec<(f64, f64)>);

fn path_points(cells: &Cells, results: &[CaseResult], field: &Field) -> anyhow::Result<PointsWithBars> {
    let (mut x, mut y, mut bars) = (Vec::new(), Vec::new(), Vec::new());
    for &depth in field.depths {
        let (exact, _) = exact_at(results, field, depth);
        let values = cells.values(&path_case(field, depth), "fluence")?;
        let errors: Moments = values.iter().map(|v| v / exact - 1.0).collect::<Vec<f64>>().iter().collect();
        // Beside the photon maps' points, not behind them.
        x.push(depth + 0.03);
        y.push(percent(errors.mean()));
        bars.push(percent_bar(&errors));
    }
    Ok((x, y, bars))
}

/// Fano factor of the photon counts.
fn counts(cells: &Cells, results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::linear("radius", "mfp"),
        Axis::linear("variance over mean of photon counts, less 1", ""),
    );
    for (class, field) in FIELDS.into_iter().enumerate() {
        let most = largest(results, field);
        let (mut x, mut y, mut bars) = (Vec::new(), Vec::new(), Vec::new());
        for result in
            results.iter().filter(|r| r.case.field == field && r.case.photons == most && r.case.depth == 1.0)
        {
            let Size::Radius(r) = result.case.size else { continue };
            if let (true, Some(fano)) = (is_fano_case(&result.case), fano(cells, &result.case)?) {
                x.push(r * (1.0 + 0.01 * class as f64));
                y.push(fano.mean() - 1.0);
                let (low, high) = bar(&fano);
                bars.push((low - 1.0, high - 1.0));
            }
        }
        let theory = |r: f64| {
            predicted_fano(&Case {
                field,
                photons: most,
                depth: 1.0,
                size: Size::Radius(r),
                is_biased: false,
                kernel: Kernel::Uniform,
            })
        };
        let grid: Vec<f64> = (0..=45).map(|i| 0.01 * f64::from(i)).collect();
        let line = grid.iter().map(|&r| theory(r)).collect();
        panel = panel.with(Line::new(field.title, class, grid, line));
        panel = panel.with(Points::new(field.title, class, x, y).with_y_interval(bars));
    }
    let figure = Figure { width: Width::Double, ..Figure::new(vec![panel.with_legend(Legend::Right)]) };
    let caption = "Photons of one history lie near each other: their counts in a ball vary more than Poisson's law \
                   lets independent ones, by 3/2 albedo times the radius to first order, at any asymmetry \
                   (lines: to all orders in fog without end, the same in slabs and spheres of one albedo). Uncollided photons are \
                   independent.";
    FigureFiles::draw("counts", caption, &figure)
}
