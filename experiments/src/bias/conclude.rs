//! What all maps together say: rows, claims, tables.

use super::cases::Case;
use super::fields::{EMITTING_SPHERE, FIELDS, HIGH_ALBEDO};
use super::measure::{map_case, path_case};
use super::predict::COLLISIONS;
use super::results::{CaseResult, Mistake, exact_at, fano, largest, pick, predicted_fano};
use super::{claims, figures, tables};
use crate::harness::{
    Cells, Estimate, Headline, Parameters, Row, Section, Settings, Unit, percent, percent_with_error, signed,
};
use crate::prediction::{Compared, PredictedError, Prediction, Predictions};
use crate::setups::Size;
use crate::theory::GATHER_TERMS;
use turbid::estimators::Kernel;
use turbid::stats::Moments;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let mut results = Vec::new();
    for field in FIELDS {
        for photons in field.photons(settings) {
            for case in Case::all(field, photons) {
                let name = case.name();
                let expected = PredictedError::read(&known, &name, "fluence", &GATHER_TERMS)?;
                results.push(Compared::new(case, &name, "fluence", expected, cells)?);
            }
        }
    }
    let mistakes = mistakes(&known, cells, &results)?;
    let mut section = Section { rows: rows(cells, &results, &mistakes)?, ..Section::default() };
    // The wrong rule is there too: what it adds is predicted like the rest.
    let group = |case: &Case| Case::group(case.field, case.photons);
    section.budget = results.iter().map(|r| r.entry(group(&r.case), &r.case.name())).collect();
    section.claims = claims::all(cells, &results, &mistakes)?;
    section.figures = figures::all(settings, cells, &results, &mistakes)?;
    section.tables.push(tables::errors(&results));
    section.tables.push(tables::paths(cells, &results)?);
    summarise(&mut section, settings, &results);
    section.headlines = headlines(&results);
    Ok(section)
}

/// The mistakes that need no switch inside the simulator: each map's own numbers, wrongly divided.
fn mistakes(known: &Predictions, cells: &Cells, results: &[CaseResult]) -> anyhow::Result<Vec<Mistake>> {
    let mut mistakes = Vec::new();
    for result in results {
        let Case { field, photons, depth, size, is_biased, kernel } = result.case;
        let is_shown = depth == 1.0
            && !is_biased
            && kernel == Kernel::Uniform
            && matches!(size, Size::Nearest(50) | Size::Radius(0.4));
        if !is_shown || photons != largest(results, field) || !field.has_clusters() {
            continue;
        }
        let stored = cells.values(&map_case(field, photons), "stored per emitted")?;
        let wrongly = |factor: &dyn Fn(usize) -> f64| {
            let wrong = |(map, error): (usize, &f64)| (1.0 + error) * factor(map) - 1.0;
            result.errors.iter().enumerate().map(wrong).collect::<Vec<f64>>().iter().collect::<Moments>()
        };
        let case = result.case;
        let predicted = result.predicted();
        let over = |divisor: f64| (1.0 + predicted) / divisor - 1.0;
        let (error, wrong) = (wrongly(&|_| 1.0 / field.setup.albedo), over(field.setup.albedo));
        mistakes.push(Mistake { name: Mistake::NAMES[0], case, predicted, wrong, error });
        let (collisions, _) = known.get(field.name, COLLISIONS)?;
        let (error, wrong) = (wrongly(&|map| 1.0 / stored[map]), over(collisions));
        mistakes.push(Mistake { name: Mistake::NAMES[1], case, predicted, wrong, error });
    }
    Ok(mistakes)
}

fn rows(cells: &Cells, results: &[CaseResult], mistakes: &[Mistake]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for result in results {
        let name = result.case.name();
        let [fluence, error, left] =
            result.rows(&name, ("fluence", Unit::FLUENCE), result.case.parameters(), cells)?;
        let maps = result.errors.len() as u64;
        rows.extend([fluence.cost(result.case.photons * maps, "photons emitted"), error, left]);
        if let Some(fano) = fano(cells, &result.case)? {
            rows.push(
                Row::measured(&name, "Fano factor", Unit::ONE, &fano)?
                    .predicted(1.0 + predicted_fano(&result.case))
                    .with(result.case.parameters()),
            );
        }
    }
    for mistake in mistakes {
        let name = format!("{} {}", mistake.case.name(), mistake.name);
        let row = Row::measured(&name, "error", Unit::FRACTION, &mistake.error)?.predicted(mistake.wrong);
        rows.push(row.with(mistake.case.parameters()));
    }
    for field in FIELDS.into_iter().filter(|f| f.has_clusters()) {
        for &depth in field.depths {
            let name = path_case(field, depth);
            let (exact, error) = exact_at(results, field, depth);
            rows.push(
                Row::measured(&name, "fluence", Unit::FLUENCE, &cells.moments(&name, "fluence")?)?
                    .reference(exact, error)
                    .with(Parameters {
                        field: Some(field.name),
                        depth: Some(depth),
                        ..Parameters::default()
                    }),
            );
        }
    }
    Ok(rows)
}

fn summarise(section: &mut Section, settings: &Settings, results: &[CaseResult]) {
    let chosen = pick(results, |_| true);
    let squares: f64 = chosen.iter().map(|r| r.z() * r.z()).sum();
    let largest = chosen.iter().map(|r| r.z().abs()).fold(0.0, f64::max);
    let blind = chosen.iter().filter(|r| !r.sees_prediction()).count();
    let example = |size: Size| {
        results.iter().find(|r| {
            let c = &r.case;
            c.field == &HIGH_ALBEDO
                && c.depth == 1.0
                && c.size == size
                && c.kernel == Kernel::Uniform
                && c.photons == HIGH_ALBEDO.photons(settings).last().copied().unwrap_or(0)
        })
    };
    if let (Some(fixed), Some(face)) = (
        example(Size::Radius(0.4)),
        results
            .iter()
            .filter(|r| r.case.photons == HIGH_ALBEDO.photons(settings).last().copied().unwrap_or(0))
            .find(|r| {
                r.case.field == &HIGH_ALBEDO && r.case.depth == 0.0 && r.case.size == Size::Radius(0.4)
            }),
    ) {
        section.summary.push(format!(
            "In fog of albedo 0.9, photons gathered within 0.4 mean free paths give the fluence with an error of {} % in the middle \
             of the slab and {} % at its lit face; theory said {} % and {} % before the run.",
            percent_with_error(&fixed.error),
            percent_with_error(&face.error),
            signed(percent(fixed.predicted()), 2),
            signed(percent(face.predicted()), 2)
        ));
    }
    let glow = &EMITTING_SPHERE;
    let in_glow = |depth: f64, radius: f64| {
        let fits = |r: &&CaseResult| {
            let c = &r.case;
            (c.field, c.depth, c.size, c.kernel) == (glow, depth, Size::Radius(radius), Kernel::Uniform)
        };
        results.iter().find(fits)
    };
    if let (Some(deep), Some(surface)) = (in_glow(1.0, 0.8), in_glow(0.0, 0.8)) {
        section.summary.push(format!(
            "In a sphere of radius 2 that emits, light bends in all directions and the surface is curved: photons gathered \
             within 0.8 mean free paths are {} % wrong halfway to its centre (predicted {} %) and {} % at its surface ({} %).",
            percent_with_error(&deep.error),
            signed(percent(deep.predicted()), 2),
            percent_with_error(&surface.error),
            signed(percent(surface.predicted()), 2)
        ));
    }
    section.summary.push(format!(
        "{} cases of the right estimators were measured. What is left of their errors after the prediction has a root \
         mean square of {:.2} standard errors (expected: 1) and is at most {:.1}. {} of them cannot see \
         their own prediction, since their standard error is more than half of it; they test that nothing else is \
         there.",
        chosen.len(),
        (squares / chosen.len().max(1) as f64).sqrt(),
        largest,
        blind
    ));
    section.notes.push(
        "Cases of one number of photons share their maps, so that their z values are not independent: claims are made \
         on one number a map, never on the histogram."
            .to_string(),
    );
    section.notes.push(
        "The clustering of photons of one history is predicted to all orders in fog without end; where a ball leaves the medium, neighbours are taken to be missing like \
         the ball's own part, an estimate that no claim relies on."
            .to_string(),
    );
}

/// Photons gathered within 0.4 mean free paths, in the middle of the slab of high albedo and at its lit face.
fn headlines(results: &[CaseResult]) -> Vec<Headline> {
    let most = largest(results, &HIGH_ALBEDO);
    let of = |(name, depth, where_): (&str, f64, &str)| {
        let fits = |r: &&CaseResult| {
            let c = &r.case;
            (c.field, c.photons, c.depth) == (&HIGH_ALBEDO, most, depth)
                && (c.size, c.kernel) == (Size::Radius(0.4), Kernel::Uniform)
        };
        let found = results.iter().find(fits)?;
        let text = format!(
            "error of the fluence in a slab of albedo 0.9, gathered within 0.4 mean free paths {where_}"
        );
        Some(Headline::new(name, &text, Unit::FRACTION, Estimate::mean(&found.error)))
    };
    let places = [("Middle", 1.0, "in the middle"), ("Face", 0.0, "at the lit face")];
    places.into_iter().filter_map(of).collect()
}
