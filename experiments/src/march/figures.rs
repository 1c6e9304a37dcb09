//! The figure: error against step.

use super::cases::{COSINES, RADIUS, rule_name};
use super::results::CaseResult;
use crate::harness::{FigureFiles, percent, percent_bar};
use crate::prediction::Term;
use crate::setups::Size;
use turbid::integrators::StepRule;
use turbid_figure::{Axis, Dash, Figure, Line, Panel, Points, Scale, Width};

/// Error against step for each ray and rule, with what the steps alone would do.
pub fn steps(results: &[CaseResult]) -> anyhow::Result<FigureFiles> {
    let mut panels = Vec::new();
    for mu in COSINES {
        let axis = Axis::new("error", "%", Scale::SymLog { threshold: 1.0 }).with_range(-50.0, 100.0);
        let mut panel =
            Panel::new(Axis::log("step", "mfp").with_range(0.04, 1.25), axis).with_title(format!("μ = {mu}"));
        for (class, rule) in StepRule::ALL.into_iter().enumerate() {
            let chosen: Vec<&CaseResult> = results
                .iter()
                .filter(|r| r.case.mu == mu && r.case.rule == rule && r.case.size == Size::Radius(RADIUS))
                .collect();
            let x: Vec<f64> = chosen.iter().map(|r| r.case.step).collect();
            let label = match rule {
                StepRule::NearEnd => "formula of 1998".to_string(),
                rule => rule_name(rule).to_string(),
            };
            let total = chosen.iter().map(|r| percent(r.predicted())).collect();
            panel = panel.with(Line::new(&label, class, x.clone(), total).with_dash(Dash::Solid));
            let alone = chosen.iter().map(|r| percent(r.expected.of(Term::Step))).collect();
            let label_alone = format!("{label}, steps alone");
            let alone = Line::new(&label_alone, class, x.clone(), alone).with_dash(Dash::Dotted);
            panel = panel.with(alone);
            let y = chosen.iter().map(|r| percent(r.error.mean())).collect();
            let bars = chosen.iter().map(|r| percent_bar(&r.error)).collect();
            panel = panel.with(Points::new(&label, class, x, y).with_y_interval(bars));
        }
        panels.push(panel);
    }
    let figure = Figure { width: Width::Double, columns: 3, shared_legend: true, ..Figure::new(panels) };
    let caption = "Error of the radiance that leaves the lit face of a slab of optical thickness 2 and albedo 0.9, \
                   against the step of the march, for three rays (μ: cosine with the normal) and three rules, at \
                   a gather radius of 0.2 mean free paths: measured (points, 95 % intervals over maps), predicted \
                   before the run (solid, straight between the steps), and the part of the steps alone, with the exact \
                   source (dotted). Fine steps leave the error of the photon map, which loses light at the face; coarse \
                   ones add their own, least with the exponential integrated over each step. Linear within ±1 %.";
    FigureFiles::draw("steps", caption, &figure)
}
