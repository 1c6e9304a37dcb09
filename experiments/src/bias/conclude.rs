//! What all maps together say: rows, claims, tables.

use super::cases::{Case, Size};
use super::fields::{FIELDS, Field};
use super::figures;
use super::measure::{is_fano_case, map_case, path_case};
use super::predict::{Parts, clustering, recall};
use crate::harness::{Cells, Claim, Estimate, Prediction, Row, Section, Settings, Table, Unit, with_error};
use std::collections::HashMap;
use turbid::estimators::Kernel;
use turbid::stats::{Moments, amplitude_per_map};

/// One case with everything that is known of it; errors in per cent of the exact fluence.
pub struct Result {
    /// The case.
    pub case: Case,
    /// What was predicted.
    pub parts: Parts,
    /// Signed error of each map.
    pub errors: Vec<f64>,
    /// The same over maps.
    pub error: Moments,
}

impl Result {
    /// Predicted error.
    pub fn predicted(&self) -> f64 {
        100.0 * self.parts.total()
    }

    /// What is left of the measured error, in standard errors.
    pub fn z(&self) -> f64 {
        let error = libm::hypot(self.error.std_error(), 100.0 * self.parts.error);
        (self.error.mean() - self.predicted()) / error
    }

    /// Whether the measurement is fine enough to see the predicted error at all.
    pub fn sees_prediction(&self) -> bool {
        self.predicted().abs() >= 2.0 * self.error.std_error()
    }

    /// Whether the medium fills every ball, as far as the prediction can tell.
    fn is_whole(&self) -> bool {
        self.parts.edge.abs() < 1e-6
    }
}

/// A number that somebody else would report from the same photons.
pub struct Mistake {
    /// What was done wrong.
    pub name: &'static str,
    /// The case whose photons it uses.
    pub case: Case,
    /// Error predicted for the right estimate [%].
    pub predicted: f64,
    /// Signed error [%] over maps.
    pub error: Moments,
}

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known: HashMap<(&str, &str), (f64, f64)> =
        predictions.iter().map(|p| ((p.case.as_str(), p.quantity.as_str()), (p.value, p.error))).collect();
    let mut results = Vec::new();
    for field in &FIELDS {
        for photons in field.photons(settings) {
            for case in Case::all(field, photons) {
                let parts = recall(&known, &case)?;
                let values = cells.values(&case.name(), "fluence")?;
                let errors: Vec<f64> = values.iter().map(|v| 100.0 * (v / parts.exact - 1.0)).collect();
                let error = errors.iter().collect();
                results.push(Result { case, parts, errors, error });
            }
        }
    }
    let mistakes = mistakes(cells, &results)?;
    let mut section = Section { rows: rows(cells, &results, &mistakes)?, ..Section::default() };
    add_claims(&mut section, settings, cells, &results, &mistakes)?;
    section.figures = figures::all(settings, cells, &results, &mistakes)?;
    section.tables.push(error_table(&results));
    section.tables.push(path_table(cells, &results)?);
    summarise(&mut section, settings, &results);
    Ok(section)
}

/// The mistakes that need no switch inside the simulator: each map's own numbers, wrongly divided.
fn mistakes(cells: &Cells, results: &[Result]) -> anyhow::Result<Vec<Mistake>> {
    let mut mistakes = Vec::new();
    for result in results {
        let Case { field, photons, depth, size, kernel } = result.case;
        let is_shown = depth == 1.0
            && kernel == Kernel::Uniform
            && matches!(size, Size::Nearest(50) | Size::Radius(0.4));
        if !is_shown || photons != largest(results, field) || !field.has_clusters() {
            continue;
        }
        let stored = cells.values(&map_case(field, photons), "stored per emitted")?;
        let wrongly = |factor: &dyn Fn(usize) -> f64| {
            let wrong = |(map, error): (usize, &f64)| 100.0 * ((1.0 + error / 100.0) * factor(map) - 1.0);
            result.errors.iter().enumerate().map(wrong).collect::<Vec<f64>>().iter().collect::<Moments>()
        };
        let case = result.case;
        let predicted = result.predicted();
        let error = wrongly(&|_| 1.0 / field.albedo);
        mistakes.push(Mistake { name: "divided by sigma_s", case, predicted, error });
        let error = wrongly(&|map| 1.0 / stored[map]);
        mistakes.push(Mistake { name: "divided by stored photons", case, predicted, error });
    }
    Ok(mistakes)
}

/// The largest number of photons a map of a field.
pub fn largest(results: &[Result], field: &Field) -> u64 {
    results.iter().filter(|r| r.case.field == field).map(|r| r.case.photons).max().unwrap_or(0)
}

fn rows(cells: &Cells, results: &[Result], mistakes: &[Mistake]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for result in results {
        let (name, parts) = (result.case.name(), &result.parts);
        let fluence = cells.moments(&name, "fluence")?;
        let gathers = "photons emitted";
        rows.push(
            Row::measured(&name, "fluence", Unit::FLUENCE, &fluence)?
                .reference(parts.exact, parts.exact_error)
                .cost(result.case.photons * fluence.n(), gathers),
        );
        rows.push(Row::measured(&name, "error", Unit::PERCENT, &result.error)?.predicted(result.predicted()));
        let left: Moments = result.errors.iter().map(|e| e - result.predicted()).collect();
        rows.push(
            Row::measured(&name, "error left over", Unit::PERCENT, &left)?
                .reference(0.0, 100.0 * parts.error),
        );
        if let Some(fano) = fano(cells, &result.case)? {
            rows.push(
                Row::measured(&name, "Fano factor", Unit::ONE, &fano)?
                    .predicted(1.0 + predicted_fano(&result.case)),
            );
        }
    }
    for mistake in mistakes {
        let name = format!("{} {}", mistake.case.name(), mistake.name);
        rows.push(Row::measured(&name, "error", Unit::PERCENT, &mistake.error)?.predicted(mistake.predicted));
    }
    for field in FIELDS.iter().filter(|f| f.has_clusters()) {
        for &depth in field.depths {
            let name = path_case(field, depth);
            let (exact, error) = exact_at(results, field, depth);
            rows.push(
                Row::measured(&name, "fluence", Unit::FLUENCE, &cells.moments(&name, "fluence")?)?
                    .reference(exact, error),
            );
        }
    }
    Ok(rows)
}

/// The exact fluence at a probe and its bound.
pub fn exact_at(results: &[Result], field: &Field, depth: f64) -> (f64, f64) {
    let found = results.iter().find(|r| r.case.field == field && r.case.depth == depth);
    found.map_or((f64::NAN, f64::NAN), |r| (r.parts.exact, r.parts.exact_error))
}

/// Variance over mean of the photon counts, a map each.
pub fn fano(cells: &Cells, case: &Case) -> anyhow::Result<Option<Moments>> {
    if !is_fano_case(case) {
        return Ok(None);
    }
    let counts = cells.values(&case.name(), "count")?;
    let variances = cells.values(&case.name(), "count variance")?;
    // The mean over all maps divides: the ratio of two numbers of one map would be biased.
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    Ok(Some(variances.iter().map(|v| v / mean).collect::<Vec<f64>>().iter().collect()))
}

/// What clusters add to a Fano factor of 1.
pub fn predicted_fano(case: &Case) -> f64 {
    match case.size {
        Size::Radius(r) if case.field.has_clusters() => clustering(case.field.albedo, r),
        _ => 0.0,
    }
}

/// Measured over predicted error of some cases: one amplitude a map, weighted by what all maps say of the noise.
fn amplitude(results: &[&Result]) -> Option<Estimate> {
    let maps = results.iter().map(|r| r.errors.len()).min()?;
    let predicted: Vec<f64> = results.iter().map(|r| r.predicted()).collect();
    let weights: Vec<f64> = results.iter().map(|r| 1.0 / r.error.variance()).collect();
    // Cases of different numbers of photons come from different maps; joining them by number is a free choice.
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| results.iter().map(|r| r.errors[m]).collect()).collect();
    amplitude_per_map(&predicted, &per_map, &weights).map(|a| Estimate::mean(&a.moments))
}

/// Mean of what is left over in some cases, weighted alike [%].
fn left_over(results: &[&Result]) -> Estimate {
    let maps = results.iter().map(|r| r.errors.len()).min().unwrap_or(0);
    let weights: Vec<f64> = results.iter().map(|r| 1.0 / r.error.variance()).collect();
    let sum: f64 = weights.iter().sum();
    let mean = |m: usize| {
        let one = |(r, w): (&&Result, &f64)| w * (r.errors[m] - r.predicted());
        results.iter().zip(&weights).map(one).sum::<f64>() / sum
    };
    let moments: Moments = (0..maps).map(mean).collect::<Vec<f64>>().iter().collect();
    Estimate::mean(&moments)
}

/// The results that a test picks.
fn pick(results: &[Result], test: impl Fn(&Result) -> bool) -> Vec<&Result> {
    results.iter().filter(|r| !r.case.is_biased() && test(r)).collect()
}

fn is_fixed(result: &Result) -> bool {
    matches!(result.case.size, Size::Radius(_))
}

fn add_claims(
    section: &mut Section,
    settings: &Settings,
    cells: &Cells,
    results: &[Result],
    mistakes: &[Mistake],
) -> anyhow::Result<()> {
    let mut claims = Vec::new();
    let mut amplitude_claim = |id: &str, text: &str, chosen: Vec<&Result>, margin: f64| {
        if let Some(statistic) = amplitude(&chosen) {
            claims.push(Claim::within(id, text, Unit::ONE, statistic, 1.0 - margin, 1.0 + margin));
        }
    };
    let free = &FIELDS[0];
    let most = largest(results, free);
    let is_free = |r: &Result| r.case.field == free && r.is_whole();
    amplitude_claim(
        "uncollided-radius",
        "uncollided photons, radius 0.1 to 0.8, whole balls: measured over predicted error",
        pick(results, |r| {
            is_free(r) && is_fixed(r) && r.case.kernel == Kernel::Uniform && r.case.photons == most
        }),
        0.05,
    );
    amplitude_claim(
        "uncollided-kernels",
        "the same, the other four kernels at radius 0.8",
        pick(results, |r| {
            is_free(r) && is_fixed(r) && r.case.kernel != Kernel::Uniform && r.case.photons == most
        }),
        0.1,
    );
    amplitude_claim(
        "uncollided-nearest",
        "uncollided photons, k nearest, every k, all but the largest maps: measured over predicted error",
        pick(results, |r| {
            r.case.field == free && r.case.depth >= 1.0 && !is_fixed(r) && r.case.photons < most
        }),
        0.25,
    );
    for field in &FIELDS {
        amplitude_claim(
            &format!("{}-face", field.name),
            &format!("{}, at the lit face, every gather: measured over predicted error", field.title),
            pick(results, |r| r.case.field == field && r.case.depth == 0.0),
            0.01,
        );
    }
    for field in FIELDS.iter().filter(|f| f.has_clusters()) {
        amplitude_claim(
            &format!("{}-blur", field.name),
            &format!(
                "{}, whole balls of fixed radius, all kernels: measured over predicted error",
                field.title
            ),
            pick(results, |r| r.case.field == field && is_fixed(r) && r.is_whole()),
            0.2,
        );
    }
    for field in &FIELDS {
        let chosen = pick(results, |r| r.case.field == field && r.case.depth > 0.0);
        claims.push(Claim::within(
            &format!("{}-left-over", field.name),
            &format!("{}, below the face: error left over by the prediction", field.title),
            Unit::PERCENT,
            left_over(&chosen),
            -0.2,
            0.2,
        ));
    }
    claims.extend(number_claim(settings, results));
    for field in &FIELDS {
        claims.extend(fano_claim(cells, results, field)?);
    }
    for field in FIELDS.iter().filter(|f| f.has_clusters()) {
        claims.push(path_claim(cells, results, field)?);
    }
    claims.extend(mistake_claims(results, mistakes));
    section.claims = claims;
    Ok(())
}

/// At a fixed radius the error does not depend on the number of photons.
fn number_claim(settings: &Settings, results: &[Result]) -> Option<Claim> {
    let counts = FIELDS[0].photons(settings);
    let find = |photons: Option<&u64>| {
        results.iter().find(|r| {
            let c = &r.case;
            c.field == &FIELDS[0]
                && Some(&c.photons) == photons
                && c.depth == 1.0
                && c.kernel == Kernel::Uniform
                && c.size == Size::Radius(0.8)
        })
    };
    let (few, many) = (find(counts.first())?, find(counts.last())?);
    let difference: Moments =
        few.errors.iter().zip(&many.errors).map(|(a, b)| a - b).collect::<Vec<f64>>().iter().collect();
    let text =
        "uncollided photons, radius 0.8, depth 1: error with the fewest photons less error with the most";
    Some(Claim::within("uncollided-number", text, Unit::PERCENT, Estimate::mean(&difference), -2.0, 2.0))
}

/// Photons of one history cluster as predicted; independent ones do not.
fn fano_claim(cells: &Cells, results: &[Result], field: &'static Field) -> anyhow::Result<Option<Claim>> {
    let most = largest(results, field);
    let mut per_case = Vec::new();
    for result in pick(results, |r| r.case.field == field && r.case.photons == most) {
        if is_fano_case(&result.case) {
            let counts = cells.values(&result.case.name(), "count")?;
            let variances = cells.values(&result.case.name(), "count variance")?;
            let mean = counts.iter().sum::<f64>() / counts.len() as f64;
            let excess: Vec<f64> = variances.iter().map(|v| v / mean - 1.0).collect();
            per_case.push((predicted_fano(&result.case), excess));
        }
    }
    let Some(maps) = per_case.first().map(|(_, excess)| excess.len()) else { return Ok(None) };
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| per_case.iter().map(|(_, e)| e[m]).collect()).collect();
    let weights: Vec<f64> =
        per_case.iter().map(|(_, excess)| 1.0 / excess.iter().collect::<Moments>().variance()).collect();
    let id = format!("{}-fano", field.name);
    if !field.has_clusters() {
        let ones = vec![1.0; weights.len()];
        let text = "uncollided photons: variance over mean of their counts, less 1";
        let fitted = amplitude_per_map(&ones, &per_map, &weights);
        return Ok(
            fitted.map(|a| Claim::within(&id, text, Unit::ONE, Estimate::mean(&a.moments), -0.05, 0.05))
        );
    }
    let predicted: Vec<f64> = per_case.iter().map(|(p, _)| *p).collect();
    let text = format!(
        "{}: excess of the variance of photon counts over their mean, measured over predicted",
        field.title
    );
    let fitted = amplitude_per_map(&predicted, &per_map, &weights);
    Ok(fitted.map(|a| Claim::within(&id, &text, Unit::ONE, Estimate::mean(&a.moments), 0.7, 1.3)))
}

/// The path tracer agrees with the exact slab.
fn path_claim(cells: &Cells, results: &[Result], field: &'static Field) -> anyhow::Result<Claim> {
    let cases: Vec<String> = field.depths.iter().map(|&depth| path_case(field, depth)).collect();
    let exact: Vec<f64> = field.depths.iter().map(|&depth| exact_at(results, field, depth).0).collect();
    let mean_error = |map: &Vec<f64>| {
        let one = |(value, exact): (&f64, &f64)| 100.0 * (value / exact - 1.0);
        map.iter().zip(&exact).map(one).sum::<f64>() / exact.len() as f64
    };
    let moments: Moments =
        cells.per_map(&cases, "fluence")?.iter().map(mean_error).collect::<Vec<f64>>().iter().collect();
    Ok(Claim::within(
        &format!("{}-paths", field.name),
        &format!("{}: error of the path tracer, mean over depths", field.title),
        Unit::PERCENT,
        Estimate::mean(&moments),
        -0.75,
        0.75,
    ))
}

/// The wrong estimators are seen to be wrong.
fn mistake_claims(results: &[Result], mistakes: &[Mistake]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let most = largest(results, &FIELDS[0]);
    let biased = results.iter().find(|r| {
        let c = &r.case;
        c.field == &FIELDS[0] && c.photons == most && c.depth == 1.0 && c.size == Size::NearestBiased(10)
    });
    if let Some(result) = biased {
        let right = 100.0 * (result.parts.total() - result.parts.rule);
        let text = "wrong on purpose, all k photons summed, k = 10: error";
        let statistic = Estimate::mean(&result.error);
        claims.push(Claim::detected("biased-k", text, Unit::PERCENT, statistic, right, 5.0));
    }
    for mistake in mistakes.iter().filter(|m| m.case.size == Size::Radius(0.4)) {
        let id = format!("{}-{}", mistake.case.field.name, mistake.name.replace(' ', "-"));
        let text = format!("wrong on purpose, {}, {}: error", mistake.case.field.title, mistake.name);
        let statistic = Estimate::mean(&mistake.error);
        claims.push(Claim::detected(&id, &text, Unit::PERCENT, statistic, mistake.predicted, 5.0));
    }
    claims
}

fn error_table(results: &[Result]) -> Table {
    let columns = [
        "field",
        "photons",
        "depth",
        "gather",
        "measured error",
        "predicted",
        "edge",
        "blur",
        "clusters",
        "z",
        "",
    ];
    let percent = |x: f64| if x.abs() < 5e-5 { "0".to_string() } else { signed(100.0 * x, 2) };
    let chosen = pick(results, |r| {
        let is_shown = matches!(r.case.size, Size::Radius(_) | Size::Nearest(50 | 500));
        is_shown && r.case.kernel == Kernel::Uniform && r.case.photons == largest(results, r.case.field)
    });
    let row = |r: &&Result| {
        vec![
            r.case.field.name.to_string(),
            r.case.photons.to_string(),
            r.case.depth.to_string(),
            r.case.gather_name(),
            with_error(r.error.mean(), r.error.std_error()),
            percent(r.parts.total()),
            percent(r.parts.edge),
            percent(r.parts.blur),
            percent(r.parts.clusters),
            signed(r.z(), 1),
            if r.sees_prediction() { "" } else { "cannot see its prediction" }.to_string(),
        ]
    };
    Table {
        caption: "Signed error of the fluence at the largest number of photons, in per cent of the exact value, with \
                  its standard error over maps, beside what was predicted and its parts; depths and radii in mean \
                  free paths, uniform kernel. A row whose standard error is more than half of the predicted error \
                  says so: it can confirm nothing. Every case is in results.csv."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: chosen.iter().map(row).collect(),
    }
}

fn path_table(cells: &Cells, results: &[Result]) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    for field in FIELDS.iter().filter(|f| f.has_clusters()) {
        for &depth in field.depths {
            let paths = cells.moments(&path_case(field, depth), "fluence")?;
            let (exact, bound) = exact_at(results, field, depth);
            let map = results.iter().find(|r| {
                let c = &r.case;
                c.field == field
                    && c.depth == depth
                    && c.size == Size::Nearest(50)
                    && c.photons == largest(results, field)
            });
            let map = map.map_or_else(String::new, |r| {
                with_error(exact * (1.0 + r.error.mean() / 100.0), exact * r.error.std_error() / 100.0)
            });
            rows.push(vec![
                field.name.to_string(),
                depth.to_string(),
                format!("{exact:.9}"),
                format!("{bound:.0e}").replace('-', "−"),
                with_error(paths.mean(), paths.std_error()),
                map,
            ]);
        }
    }
    let columns = ["field", "depth", "exact fluence", "bound", "path tracer", "photon map, k = 50"];
    Ok(Table {
        caption: "Fluence per unit of irradiance on the face: exact, by the path tracer, and by the k nearest photons \
                  of the largest maps. The path tracer has no bias; the photon map's is the subject of this study."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows,
    })
}

/// A number with so many decimals and a proper minus.
fn signed(x: f64, decimals: usize) -> String {
    format!("{x:.decimals$}").replace('-', "−")
}

fn summarise(section: &mut Section, settings: &Settings, results: &[Result]) {
    let chosen = pick(results, |_| true);
    let squares: f64 = chosen.iter().map(|r| r.z() * r.z()).sum();
    let largest = chosen.iter().map(|r| r.z().abs()).fold(0.0, f64::max);
    let blind = chosen.iter().filter(|r| !r.sees_prediction()).count();
    let example = |size: Size| {
        results.iter().find(|r| {
            let c = &r.case;
            c.field == &FIELDS[2]
                && c.depth == 1.0
                && c.size == size
                && c.kernel == Kernel::Uniform
                && c.photons == FIELDS[2].photons(settings).last().copied().unwrap_or(0)
        })
    };
    if let (Some(fixed), Some(face)) = (
        example(Size::Radius(0.4)),
        results
            .iter()
            .find(|r| r.case.field == &FIELDS[2] && r.case.depth == 0.0 && r.case.size == Size::Radius(0.4)),
    ) {
        section.summary.push(format!(
            "In fog of albedo 0.9, photons gathered within 0.4 mean free paths read the fluence {} % wrong in the middle \
             of the slab and {} % wrong at its lit face; theory said {} % and {} % before the run.",
            with_error(fixed.error.mean(), fixed.error.std_error()),
            with_error(face.error.mean(), face.error.std_error()),
            signed(fixed.predicted(), 2),
            signed(face.predicted(), 2)
        ));
    }
    section.summary.push(format!(
        "{} cases of the right estimators were measured. What is left of their errors after the prediction has a root \
         mean square of {:.2} standard errors (1 if all is understood) and is at most {:.1}. {} of them cannot see \
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
        "The clustering of photons of one history is predicted to first order in the radius, and without the edge of \
         the medium; at the faces it is a few parts in a thousand beside losses of tens of per cent."
            .to_string(),
    );
}
