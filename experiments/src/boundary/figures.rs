//! The figures.

use super::cases::{MAIN, Place};
use super::fields::{FURNACE_CUBOID, FURNACE_SLAB, FURNACE_SPHERE, Field, LIT_FORWARD, LIT_SLAB, LIT_SPHERE};
use super::predict::line;
use super::results::{CaseResult, Found, rims};
use super::section::{self, ALONG, RADIUS, WIDTH, places};
use super::sheet::{Sheet, Side};
use super::spread::Spread;
use crate::harness::{Cells, FigureFiles, Settings, bar, percent};
use crate::setups::{FURNACE, Size};
use crate::theory::{UNTREATED, treatment_title};
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::{Moments, student_critical};
use turbid_figure::{
    Along, Axis, Color, Dash, Figure, Heatmap, Legend, Line, Panel, Points, Rule, Scale, Shading, Width,
};

/// All figures, the picture first.
pub fn all(settings: &Settings, cells: &Cells, found: &Found) -> anyhow::Result<Vec<FigureFiles>> {
    Ok(vec![
        picture(cells)?,
        depths(settings, found)?,
        rim(settings, found)?,
        sheet(settings, found)?,
        spread(found)?,
    ])
}

/// A treatment for readers who meet it for the first time.
fn in_words(treatment: Treatment) -> &'static str {
    match treatment {
        Treatment::None => UNTREATED,
        Treatment::Clipped => "divided by the volume inside (clipped)",
        Treatment::Reflection => "mirrored at the face (reflection)",
        Treatment::LocalLinear => "fitted by a plane (local linear)",
    }
}

/// The furnace sphere in section.
fn picture(cells: &Cells) -> anyhow::Result<FigureFiles> {
    let edges: Vec<f64> = (0..=2 * ALONG).map(|i| WIDTH * i as f64 - RADIUS).collect();
    let circle: (Vec<f64>, Vec<f64>) = (0..=180)
        .map(|i| turbid::math::sin_cos(std::f64::consts::TAU * f64::from(i) / 180.0))
        .map(|(s, c)| (RADIUS * c, RADIUS * s))
        .unzip();
    let mut panels = Vec::new();
    for treatment in Treatment::ALL {
        let mut values = vec![0.0; 4 * ALONG * ALONG];
        for (column, row, _) in places() {
            let mean = cells.moments(&section::case(treatment, column, row), "fluence")?.mean();
            let error = percent(mean / FURNACE - 1.0);
            for x in [ALONG + column, ALONG - 1 - column] {
                for y in [ALONG + row, ALONG - 1 - row] {
                    values[y * 2 * ALONG + x] = error;
                }
            }
        }
        let quantity = Axis::linear("error", "%").with_range(-60.0, 60.0);
        let map = Heatmap {
            x_edges: edges.clone(),
            y_edges: edges.clone(),
            values,
            shading: Shading::Diverging,
            quantity,
        };
        let border = Line {
            label: String::new(),
            color: Color::Black,
            dash: Dash::Solid,
            x: circle.0.clone(),
            y: circle.1.clone(),
        };
        let axis = |label: &str| Axis::linear(label, "mfp").with_range(-RADIUS - 0.1, RADIUS + 0.1);
        panels.push(Panel::new(axis("x"), axis("z")).with_title(in_words(treatment)).with(map).with(border));
    }
    let figure = Figure { width: Width::Double, columns: 2, heights: vec![1.0, 1.0], ..Figure::new(panels) };
    let caption = "A ball of fog of radius 2 mean free paths in a furnace, cut through its middle: light comes in evenly \
                   from all sides, nothing is absorbed, and the true fluence is the same everywhere. In colour, the measured \
                   error of a photon map that gathers within 0.4 mean free paths, each place averaged over its mirror images in \
                   two planes. Without treatment the rim is dark by up to half and more; clipping and local linear fits \
                   remove the rim; reflection, made for flat faces, leaves up to 7.5 % of it at a round one. What is left \
                   inside is noise; outside the circle nothing is measured.";
    FigureFiles::draw("section", caption, &figure)
}

type Series = (Vec<f64>, Vec<f64>, Vec<(f64, f64)>);

/// Means and intervals, each as `shown` makes them.
fn series<'a>(shown: fn(f64) -> f64, chosen: impl Iterator<Item = (f64, &'a Moments)>) -> Series {
    let mut out = Series::default();
    for (x, moments) in chosen {
        out.0.push(x);
        let (low, high) = bar(moments);
        out.1.push(shown(moments.mean()));
        out.2.push((shown(low), shown(high)));
    }
    out
}

/// Error against depth over radius.
fn depths(settings: &Settings, found: &Found) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    let radius = MAIN.0;
    let (furnaces, lit) =
        ([&FURNACE_SLAB, &FURNACE_SPHERE, &FURNACE_CUBOID], [&LIT_SLAB, &LIT_FORWARD, &LIT_SPHERE]);
    for field in furnaces.into_iter().chain(lit) {
        let exact = field.setup.exact()?;
        let axis = Axis::new("error", "%", Scale::SymLog { threshold: 1.0 }).with_range(-70.0, 20.0);
        let mut panel = Panel::new(Axis::linear("depth / radius", "").with_range(-0.05, 1.3), axis)
            .with_title(field.title);
        for (class, treatment) in Treatment::ALL.into_iter().enumerate() {
            let grid: Vec<f64> = (0..=52).map(|i| 0.025 * f64::from(i)).collect();
            let theory: anyhow::Result<Vec<f64>> = grid
                .iter()
                .map(|x| line(field, treatment, radius, x * radius, &exact).map(percent))
                .collect();
            panel = panel.with(Line::new(treatment_title(treatment), class, grid, theory?));
            let chosen = found.results.iter().filter(|r| is_on(r, settings, field, treatment));
            let shift = 0.008 * (class as f64 - 1.5);
            let (x, y, bars) =
                series(percent, chosen.map(|r| (r.case.place.depth() / radius + shift, &r.error)));
            panel = panel.with(Points::new(treatment_title(treatment), class, x, y).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = "Error of a gather within 0.4 mean free paths against its depth below the surface, measured (points, 95 % \
                   intervals over maps, set a little apart) and predicted before (lines). In the furnace all error is geometry: \
                   clipping and local linear remove it everywhere, reflection at flat faces only. Where light enters from one \
                   side, or is absorbed on its way into a sphere, the field bends towards the surface, and what the \
                   treatments leave is blur: a few per cent, of either sign. On the sphere's surface, from which the light \
                   falls off steeply, only the fitted plane takes most of the loss away. Linear within ±1 %.";
    FigureFiles::draw("depths", caption, &figure)
}

fn is_on(r: &CaseResult, settings: &Settings, field: &'static Field, treatment: Treatment) -> bool {
    let c = &r.case;
    (c.field, c.photons, c.treatment) == (field, field.main_size(settings), treatment)
        && (c.size, c.kernel) == (Size::Radius(MAIN.0), Kernel::Uniform)
        && matches!(c.place, Place::Face(h) if h <= 1.25 * MAIN.0)
}

/// The dark rim against radius and against photons.
fn rim(settings: &Settings, found: &Found) -> anyhow::Result<FigureFiles> {
    let rims = rims(settings, found);
    let interval = |j: &turbid::stats::Jackknife| {
        let half = student_critical(0.05, j.n - 1) * j.std_error;
        (j.value - half, j.value + half)
    };
    let y_axis = || Axis::log("loss at one face, in mean free paths", "");
    let mut left = Panel::new(Axis::log("radius", "mfp"), y_axis()).with_title("fixed radius");
    let radii: Vec<f64> = (0..=20).map(|i| 0.08 * libm::exp(0.125 * f64::from(i))).collect();
    let law: Vec<f64> = radii.iter().map(|r| 3.0 / 16.0 * r).collect();
    left = left.with(Line::theory("3/16 radius, exact", radii, law));
    let mut right = Panel::new(Axis::log("photons emitted", ""), y_axis()).with_title("k nearest");
    for (class, (photons, _)) in FURNACE_SLAB.sizes(settings).into_iter().enumerate() {
        let chosen = rims.iter().filter(|r| r.photons == photons);
        let (mut x, mut y, mut bars) = Series::default();
        for rim in chosen {
            let Size::Radius(r) = rim.size else { continue };
            x.push(r * (1.0 + 0.03 * class as f64));
            y.push(rim.lost.value);
            bars.push(interval(&rim.lost));
        }
        left = left.with(Points::new(format!("{photons} photons"), class, x, y).with_y_interval(bars));
    }
    for (class, k) in [20, 50, 200].into_iter().enumerate() {
        let chosen: Vec<_> = rims.iter().filter(|r| r.size == Size::Nearest(k)).collect();
        let x: Vec<f64> = chosen.iter().map(|r| r.photons as f64).collect();
        let label = format!("k = {k}");
        let law = chosen.iter().map(|r| r.predicted_lost).collect();
        right = right.with(Line::new(&label, class + 3, x.clone(), law));
        let (y, bars) = chosen.iter().map(|r| (r.lost.value, interval(&r.lost))).unzip();
        right = right.with(Points::new(&label, class + 3, x, y).with_y_interval(bars));
    }
    let figure = Figure { width: Width::Double, columns: 2, ..Figure::new(vec![left, right]) };
    let caption = "What the untreated estimate loses at one face of the furnace slab: the integral of its relative error over \
                   depth, with 95 % intervals. At a fixed radius it is 3/16 of the radius whatever the number of photons (points \
                   of different numbers set a little apart); trapezia between the probes' depths add half a per cent to it. With the k nearest \
                   it falls with the cube root of the photons (lines: predicted at the same depths).";
    FigureFiles::draw("rim", caption, &figure)
}

/// False photons against distance.
fn sheet(settings: &Settings, found: &Found) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for (is_clipped, clipping) in [(false, "not clipped"), (true, "clipped")] {
        for (side, word) in [(Side::Bright, "bright side"), (Side::Dark, "dark side")] {
            let mut panel = Panel::new(
                Axis::linear("distance from the sheet / radius", "").with_range(-0.02, 1.1),
                Axis::linear("error", "%"),
            )
            .with_title(format!("{word}, {clipping}"))
            .with(Rule::new(Along::Horizontal(0.0)));
            for (class, rejection) in
                Rejection::ALL.into_iter().filter(|&r| r != Rejection::Visible).enumerate()
            {
                let at = |distance| Sheet {
                    side,
                    distance,
                    size: Size::Radius(0.1),
                    kernel: Kernel::Uniform,
                    rejection,
                    is_clipped,
                };
                // At the radius itself the sheet no longer counts.
                let mut grid: Vec<f64> = (0..=44).map(|i| 0.025 * f64::from(i)).collect();
                grid[40] = 1.0 - 1e-9;
                grid.insert(41, 1.0 + 1e-9);
                let exact: anyhow::Result<Vec<f64>> = grid
                    .iter()
                    .map(|&x| at(x).exact(settings).map(|(v, _)| percent(v / at(x).fields().0 - 1.0)))
                    .collect();
                let label = match rejection {
                    Rejection::BehindPlane => "behind plane, visible",
                    other => other.name(),
                };
                panel = panel.with(Line::new(label, class, grid, exact?));
                let chosen = super::sheet::DISTANCES.map(|x| found.sheet(&at(x)).map(|s| (x, &s.error)));
                let chosen = chosen.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
                let (x, y, bars) = series(percent, chosen.into_iter());
                panel = panel.with(Points::new(label, class, x, y).with_y_interval(bars));
            }
            panels.push(panel);
        }
    }
    let figure = Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels) };
    let caption = "A thin opaque sheet between a bright uniform field and one a quarter as bright, fixed radius, uniform kernel: \
                   error on either side against distance, measured (points; their 95 % intervals are smaller) and predicted \
                   (lines; beside a flat sheet 'behind plane' and 'visible' are one). Without clipping every rejection leaves the ball's lost part dark. With it, rejecting by place \
                   ('behind plane', 'visible') is right everywhere; rejecting by direction is not, and 'facing' throws away half of \
                   the good photons as long as the sheet is in the ball.";
    FigureFiles::draw("sheet", caption, &figure)
}

/// What treatments cost.
fn spread(found: &Found) -> anyhow::Result<FigureFiles> {
    let mut panel = Panel::new(
        Axis::linear("depth / radius", "").with_range(-0.05, 1.1),
        Axis::log("variance over that of a whole ball", ""),
    );
    for (class, treatment) in Treatment::ALL.into_iter().enumerate() {
        let grid: Vec<f64> = (0..=44).map(|i| 0.025 * f64::from(i)).collect();
        let exact: anyhow::Result<Vec<f64>> = grid
            .iter()
            .map(|&depth| Spread { depth, kernel: Kernel::Uniform, treatment }.exact().map(|e| e.1.0))
            .collect();
        panel = panel.with(Line::new(treatment_title(treatment), class, grid, exact?));
        let chosen = found
            .spreads
            .iter()
            .filter(|s| s.spread.kernel == Kernel::Uniform && s.spread.treatment == treatment);
        let moments: Vec<(f64, Moments)> =
            chosen.map(|s| (s.spread.depth, s.factors.iter().collect())).collect();
        let (x, y, bars) = series(|x| x, moments.iter().map(|(x, m)| (*x, m)));
        panel = panel.with(Points::new(treatment_title(treatment), class, x, y).with_y_interval(bars));
    }
    let panel = panel.with_legend(Legend::Right);
    let figure = Figure { width: Width::Double, heights: vec![0.5], ..Figure::new(vec![panel]) };
    let caption = "What a treatment costs: variance of the estimate of independent photons below a flat face over that in a whole \
                   ball, measured (points, 95 % intervals) and predicted (lines), uniform kernel. On the face clipping and \
                   reflection double it, having half of the photons; a local linear fit makes it nearly seven times as large.";
    FigureFiles::draw("variance", caption, &figure)
}
