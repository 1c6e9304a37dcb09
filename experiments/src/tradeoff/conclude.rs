//! What all maps together say: rows, claims, tables, the error budget of the study.

use super::cases::{FIELDS, PROBES, Rival, Setting, THICK, THIN, Treatment};
use super::choose::{BreakEven, Currency, best_over_best, break_even, guided_rays, most_efficient, regret};
use super::data::{Data, Measured};
use super::measure::MAPS;
use super::predict::{BIAS, NOISE, RMS};
use super::split::{rms, rms_bias, rms_noise};
use super::{answers, claims, figures, tables, words};
use crate::harness::{Cells, Estimate, Headline, Parameters, Row, Section, Settings, Unit};
use crate::prediction::{Entry, Prediction, Predictions, Term};
use crate::setups::Size;
use turbid::stats::Moments;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let data = Data::read(settings, &known, cells)?;
    let mut section = Section { rows: rows(&data, &known)?, ..Section::default() };
    section.budget = data.measured.iter().flat_map(entries).collect();
    section.left_out = data.measured.iter().map(|m| m.expected.len()).sum::<usize>() - section.budget.len();
    section.answers = answers::all(&data);
    section.claims = claims::all(&data);
    section.figures = figures::all(settings, &data)?;
    section.tables = tables::all(&data, &known)?;
    section.summary = words::summary(&data);
    section.notes = words::notes(&section.budget, &data);
    section.headlines = headlines(&data);
    Ok(section)
}

fn rows(data: &Data, known: &Predictions) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for measured in &data.measured {
        let case = measured.case();
        let operations = measured.cost(PROBES as f64).round() as u64 * MAPS;
        let values = [
            (RMS, rms(&measured.maps)),
            (BIAS, rms_bias(&measured.maps)),
            (NOISE, rms_noise(&measured.maps)),
        ];
        for (quantity, value) in values {
            let predicted = known.get(&case, quantity)?.0;
            rows.push(
                Row::estimated(&case, quantity, Unit::FRACTION, &value)?
                    .predicted(predicted)
                    .cost(operations, "operations")
                    .with(measured.setting.parameters()),
            );
        }
    }
    for size in &data.sizes {
        let group = Setting::group(size.field, size.photons);
        let asked =
            Parameters { field: Some(size.field.name), photons: Some(size.photons), ..Parameters::default() };
        let per_photon =
            |values: &[f64]| values.iter().map(|v| v / size.photons as f64).collect::<Vec<f64>>();
        let collisions: Moments = per_photon(&size.collisions).iter().collect();
        let (exact, bound) = known.get(size.field.name, "collisions per photon")?;
        rows.push(
            Row::measured(&group, "collisions per photon", Unit::ONE, &collisions)?
                .reference(exact, bound)
                .with(asked),
        );
        let rays: Moments = per_photon(&size.rays).iter().collect();
        rows.push(Row::measured(&group, "rays per photon", Unit::ONE, &rays)?.with(asked));
        let bytes: Moments = size.bytes.iter().collect();
        rows.push(Row::measured(&group, "memory of the map", Unit::new("byte"), &bytes)?.with(asked));
    }
    let guided = data.guided.iter().map(|guided| (Rival::Guided, &guided.paths));
    for (rival, paths) in data.paths.iter().map(|paths| (Rival::Paths, paths)).chain(guided) {
        let case = format!("{} {}", paths.field.name, rival.name());
        let asked = Parameters { field: Some(paths.field.name), ..Parameters::default() };
        let error: Moments = paths.error.iter().collect();
        rows.push(Row::measured(&case, "error", Unit::FRACTION, &error)?.reference(0.0, 0.0).with(asked));
        let variance: Moments = paths.variance.iter().collect();
        rows.push(Row::measured(&case, "relative variance of a sample", Unit::ONE, &variance)?.with(asked));
        let rays: Moments = paths.rays.iter().collect();
        rows.push(Row::measured(&case, "rays of a sample", Unit::ONE, &rays)?.with(asked));
    }
    for (guided, paths) in data.guided.iter().zip(&data.paths) {
        let case = format!("{} {}", paths.field.name, Rival::Guided.name());
        let asked = Parameters { field: Some(paths.field.name), ..Parameters::default() };
        let ratio = guided_rays(&guided.paths, paths);
        rows.push(Row::estimated(&case, "rays over those of paths", Unit::ONE, &ratio)?.with(asked));
    }
    for field in FIELDS {
        let Some(paths) = data.paths(field) else { continue };
        for treatment in Treatment::ALL {
            let case = format!("{} {}", field.name, treatment.name());
            let Some(chosen) = most_efficient(&data.of(field, treatment, None)) else { continue };
            let BreakEven { ratio, queries, .. } = break_even(chosen.case, paths, Currency::Operations);
            rows.push(Row::estimated(&case, "rays of a path query per photon gathered", Unit::ONE, &ratio)?);
            if let Some(queries) = queries {
                rows.push(Row::estimated(&case, "break-even queries", Unit::ONE, &queries)?);
            }
            let cases = data.of(field, treatment, Some(data.largest(field)));
            for measured in &cases {
                let value = regret(measured, &cases);
                if let (Size::Nearest(50 | 100), true) = (measured.setting.size, has_spread(&value)) {
                    let row = Row::estimated(&measured.case(), "regret", Unit::ONE, &value)?;
                    rows.push(row.with(measured.setting.parameters()));
                }
            }
        }
    }
    for field in FIELDS {
        let of = |treatment| data.of(field, treatment, Some(data.largest(field)));
        let ratio = best_over_best(&of(Treatment::Clipped), &of(Treatment::Plain));
        let case = Setting::group(field, data.largest(field));
        rows.push(Row::estimated(&case, "best clipped over best plain error", Unit::ONE, &ratio)?);
    }
    Ok(rows)
}

/// Whether a statistic differs between maps at all: the best setting's regret does not.
pub fn has_spread(estimate: &Estimate) -> bool {
    estimate.std_error() > 0.0
}

/// Counts that a layer's probes must expect in all: fewer make its mean over a map far from normal.
const FEWEST_COUNTS: f64 = 50.0;
/// What is not known of the clusters' part, as a fraction of it: in whole balls what one number for all counts leaves out, and
/// at a face, where neighbours are taken to be missing like the ball's own part, half.
const UNKNOWN: (f64, f64) = (0.2, 0.5);
/// How much of an entry's standard error may be unknown.
const HIDDEN: f64 = 0.2;

/// The layers of a setting in the error budget of the study, each averaged over its lateral probes.
///
/// The rule, which looks at predictions alone: fixed radii enter with every layer; k nearest ones where what is not
/// known of the clusters' part is below a fifth of the standard error that is expected of the entry; clipped ones
/// only where the medium ends inside the ball, since elsewhere they are the plain ones.
fn entries(measured: &Measured) -> Vec<Entry> {
    let (setting, treatment) = (&measured.setting, measured.treatment);
    let field = setting.field;
    let group = format!("tradeoff-{}", Setting::group(field, setting.photons));
    let mut entries = Vec::new();
    for (layer, expected) in measured.expected.iter().enumerate() {
        let depth = field.depth(layer);
        // What the layer's balls hold, and their radius, from the noise of independent photons.
        let held = 1.0 / (expected.noise_independent * expected.noise_independent);
        let radius = match setting.size {
            Size::Radius(r) => r,
            Size::Nearest(k) => {
                let volume = k as f64 / setting.density();
                libm::cbrt(3.0 * volume / (4.0 * std::f64::consts::PI))
            }
        };
        let is_cut = radius > field.setup.body.room(depth);
        if treatment == Treatment::Clipped && !is_cut || held * (setting.lateral() as f64) < FEWEST_COUNTS {
            continue;
        }
        if let Size::Nearest(_) = setting.size {
            let unknown = expected.clusters.abs() * if is_cut { UNKNOWN.1 } else { UNKNOWN.0 };
            if unknown > HIDDEN * expected_error(setting, depth, expected.noise, radius) {
                continue;
            }
        }
        let terms =
            [(Term::Edge, expected.edge), (Term::Blur, expected.blur), (Term::Clusters, expected.clusters)];
        let case = format!("{} t={depth}", measured.case());
        let maps = measured.maps.iter().map(|m| m.error[layer]).collect();
        entries.push(Entry::new(&group, case, &terms, expected.error, maps));
    }
    entries
}

/// The standard error expected of a layer's mean: its balls overlap. Of two balls of radius r at a distance d, the
/// part in common integrates over all lateral distances to 4/5 pi r^2.
fn expected_error(setting: &Setting, depth: f64, noise: f64, radius: f64) -> f64 {
    let probes = setting.lateral() as f64;
    let shared = 0.8 * std::f64::consts::PI * radius * radius / setting.field.setup.body.area(depth);
    noise * ((1.0 / probes + shared).min(1.0) / MAPS as f64).sqrt()
}

fn headlines(data: &Data) -> Vec<Headline> {
    let of = |treatment| data.of(&THIN, treatment, Some(data.largest(&THIN)));
    let clipping = best_over_best(&of(Treatment::Clipped), &of(Treatment::Plain));
    let text =
        "RMS error of the best clipped setting over that of the best untreated one, thin isotropic slab";
    let mut headlines = vec![Headline::new("Clipping", text, Unit::ONE, clipping)];
    let chosen = most_efficient(&data.of(&THICK, Treatment::Clipped, None)).zip(data.paths(&THICK));
    let even = chosen.and_then(|(best, paths)| break_even(best.case, paths, Currency::Operations).queries);
    if let Some(queries) = even {
        let text =
            "queries from which on a photon map costs fewer operations than paths, thick isotropic slab";
        headlines.push(Headline::new("BreakEven", text, Unit::ONE, queries));
    }
    headlines
}
