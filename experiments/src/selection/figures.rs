//! The figure: what each selector costs, against photons.

use super::cases::Selector;
use super::fields::Field;
use super::results::Choice;
use crate::harness::FigureFiles;
use turbid_figure::{Along, Axis, Dash, Figure, Line, Panel, Points, Rule, Scale, Width};

/// Selectors of the figure.
const SHOWN: [Selector; 5] =
    [Selector::Interval, Selector::Iterated, Selector::PlugIn, Selector::Nearest(50), Selector::Fixed];

/// Error over that of the best radius against the number of photons, a panel a field.
pub fn selection(choices: &[Choice]) -> anyhow::Result<FigureFiles> {
    let most = choices.iter().map(|c| c.photons).max().unwrap_or(1) as f64;
    let least = choices.iter().map(|c| c.photons).min().unwrap_or(1) as f64;
    let mut panels = Vec::new();
    for field in Field::ALL {
        let x = Axis::log("photons emitted", "").with_range(0.6 * least, 1.6 * most);
        let y = Axis::new("error over the best", "", Scale::LogClipped).with_range(0.8, 30.0);
        let mut panel = Panel::new(x, y).with_title(field.title());
        panel = panel.with(Rule::new(Along::Horizontal(1.0)).with_dash(Dash::Dotted));
        for (class, selector) in SHOWN.into_iter().enumerate() {
            let own: Vec<&Choice> =
                choices.iter().filter(|c| c.field == field && c.selector == selector).collect();
            if own.is_empty() {
                continue;
            }
            let x: Vec<f64> = own.iter().map(|c| c.photons as f64).collect();
            let y: Vec<f64> = own.iter().map(|c| c.regret().value()).collect();
            let bars = own.iter().map(|c| {
                let interval = c.squared().interval(0.95);
                let low = interval.low.max(0.01 * c.squared().value());
                (low.sqrt(), interval.high.sqrt())
            });
            let points = Points::new(selector.title(), class, x.clone(), y.clone());
            panel = panel
                .with(Line::new(selector.title(), class, x, y).with_dash(Dash::Solid))
                .with(points.with_y_interval(bars.collect()));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = "Root mean square error of an estimate whose radius is chosen from its own photons, over that of the best radius (dotted), against the \
                   number of photons (points with 95 % intervals over cells; lines join them). In smooth fields (top) adaptive rules stay next to \
                   the best; where a dip, a face or a point light breaks the assumption of a plain bend (bottom), the interval test stays nearer to it \
                   than what trusts its first radius (in the dip both plug-in rules are caught by it, and lie upon each other). Rules of \
                   thumb are right at one number of photons and wrong at others.";
    FigureFiles::draw("selection", caption, &figure)
}
