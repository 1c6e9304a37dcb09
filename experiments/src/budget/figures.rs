//! Measured against predicted error, and what is left.

use super::sets::MOST;
use crate::harness::{FigureFiles, percent, percent_bar};
use crate::prediction::{Entry, Term};
use turbid::stats::Moments;
use turbid_figure::{Along, Axis, Color, Figure, Histogram, Legend, Line, Panel, Points, Rule, Scale, Width};

/// Every entry on the line y = x, in the colour of its largest term; below, the drawn distances.
pub fn sum(entries: &[&Entry], groups: usize, z: &[f64]) -> anyhow::Result<FigureFiles> {
    let axis = |label: &str| Axis::new(label, "%", Scale::SymLog { threshold: 1.0 });
    let mut above = Panel::new(axis("predicted error"), axis("measured error"))
        .with(Rule::new(Along::Diagonal).with_label("measured = predicted"));
    let noisy = chosen(entries, |e| !sees_prediction(e));
    let layer = points("too noisy to detect its prediction", 0, &noisy);
    if !noisy.is_empty() {
        above = above.with(Points { color: Color::Grey, ..layer });
    }
    for (class, &term) in Term::ALL.iter().enumerate() {
        let own = chosen(entries, |e| sees_prediction(e) && dominant(e) == term);
        if !own.is_empty() {
            above = above.with(points(&format!("mostly {}", term.name()), class, &own));
        }
    }
    let edges: Vec<f64> = (-10..=10).map(|i| 0.5 * f64::from(i)).collect();
    let grid: Vec<f64> = (-50..=50).map(|i| 0.1 * f64::from(i)).collect();
    let normal = grid.iter().map(|x| libm::exp(-0.5 * x * x) / (2.0 * std::f64::consts::PI).sqrt()).collect();
    let below = Panel::new(
        Axis::linear("what is left of the error, in normal deviations", "").with_range(-5.0, 5.0),
        Axis::linear("density", ""),
    )
    .with(Histogram::density("one case a map set", 0, z, edges))
    .with(Line::theory("unit normal", grid, normal));
    let figure = Figure {
        width: Width::Double,
        columns: 1,
        heights: vec![0.6, 0.25],
        ..Figure::new(vec![above.with_legend(Legend::Right), below.with_legend(Legend::Right)])
    };
    let caption = format!(
        "Measured against predicted error of the {} cases of the budget, in per cent of the exact value (outside an \
         edge, of the value inside), with 95 % intervals over maps, coloured by the largest of the predicted terms; \
         linear within ±1 %. They lie on the line within their errors, grey ones being too noisy to detect their prediction: \
         the sum of the terms is what was measured, wrong estimators included, whose fault is one of the terms. Below: what the prediction leaves over in one case of each of {} \
         independent sets of at most {MOST} maps, into which the maps of {groups} groups are cut, by Student's t in normal deviations, beside the density that it follows if nothing \
         was overlooked.",
        entries.len(),
        z.len()
    );
    FigureFiles::draw("sum", &caption, &figure)
}

fn chosen<'a>(entries: &[&'a Entry], test: impl Fn(&Entry) -> bool) -> Vec<&'a Entry> {
    entries.iter().copied().filter(|e| test(e)).collect()
}

fn sees_prediction(entry: &Entry) -> bool {
    let moments: Moments = entry.maps.iter().collect();
    entry.predicted().abs() >= 2.0 * moments.std_error()
}

/// The largest term in size.
fn dominant(entry: &Entry) -> Term {
    let size = |term: Term| entry.terms[term as usize].abs();
    Term::ALL.into_iter().fold(Term::ALL[0], |best, term| if size(term) > size(best) { term } else { best })
}

fn points(label: &str, class: usize, entries: &[&Entry]) -> Points {
    let moments = |e: &&Entry| e.maps.iter().collect::<Moments>();
    let x = entries.iter().map(|e| percent(e.predicted())).collect();
    let y = entries.iter().map(|e| percent(moments(e).mean())).collect();
    Points::new(label, class, x, y)
        .with_y_interval(entries.iter().map(|e| percent_bar(&moments(e))).collect())
}
