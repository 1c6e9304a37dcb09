//! The figure: typical error against time in four media.

use super::cases::Medium;
use super::results::{Curve, Size};
use crate::harness::{FigureFiles, number, percent};
use turbid_figure::{Axis, Dash, Figure, Line, Panel, Points, Scale, Width};

/// A panel a medium, a line a method.
pub fn media(curves: &[Curve]) -> anyhow::Result<FigureFiles> {
    let panels = Medium::ALL.map(|medium| {
        let mut panel = Panel::new(
            Axis::log("CPU time of a map and 10,000 rays", "s"),
            Axis::new("median of the relative error", "", Scale::Log),
        )
        .with_title(medium.title());
        for (class, curve) in curves.iter().filter(|curve| curve.medium == medium).enumerate() {
            let title = curve.method.title();
            let x: Vec<f64> = curve.rungs.iter().map(|rung| rung.seconds).collect();
            let y: Vec<f64> = curve.quantiles.iter().map(|of_rung| of_rung[0]).collect();
            let intervals = (0..x.len()).map(|rung| curve.interval(rung, Size::Typical));
            let bars = intervals.map(|interval| (interval.low, interval.high)).collect();
            panel = panel
                .with(Line::new(title, class, x.clone(), y.clone()).with_dash(Dash::Solid))
                .with(Points::new(title, class, x, y).with_y_interval(bars));
        }
        panel
    });
    let figure =
        Figure { width: Width::Double, columns: 2, shared_legend: true, ..Figure::new(panels.to_vec()) };
    let ahead: Vec<String> = Medium::ALL.into_iter().filter_map(|medium| ahead(curves, medium)).collect();
    let caption = format!(
        "Half of all rays are farther off than this, against the CPU time of this machine for a map and the 10,000 rays of a small \
         picture: light scattered twice and more, in four media, at the radius of the least squared error times time (points joined by lines; from \
         left to right each map has more photons than the one before; 95 % intervals over maps). Lower and farther left is better. Planes have \
         no radius to choose and no blur, and beams the least noise at a radius, but each of them takes longer to read than a photon in a ball; in the \
         peaked medium both meet rare large terms, of flights nearly along the ray. The least error in the longest time that all have: {}.",
        ahead.join("; ")
    );
    FigureFiles::draw("media", &caption, &figure)
}

/// Which method has the least typical error at the longest time that all methods have errors of, or have left behind.
fn ahead(curves: &[Curve], medium: Medium) -> Option<String> {
    let own = || curves.iter().filter(|curve| curve.medium == medium);
    let ends = own().filter_map(|curve| Some(curve.rungs.last()?.seconds));
    let time = ends.fold(f64::INFINITY, f64::min);
    let errors = own().filter_map(|curve| Some((curve.typical_at(time)?, curve.method)));
    let (error, method) = errors.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let error = number(percent(error));
    Some(format!("{} {}, {error} % in {} s", medium.name(), method.title(), number(time)))
}
