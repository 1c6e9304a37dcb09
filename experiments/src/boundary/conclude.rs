//! What all maps together say.

use super::cases::{Case, Place};
use super::fields::{FIELDS, FURNACE_SLAB, LIT_SPHERE};
use super::predict::TERMS;
use super::results::{CaseResult, Found, SheetResult, SpreadResult, integrals, kept, rims};
use super::sheet::Sheet;
use super::spread::Spread;
use super::{claims, figures, sheet, spread, tables};
use crate::harness::{
    Cells, Estimate, Headline, Parameters, Row, Section, Settings, Unit, percent_with_error,
};
use crate::prediction::{Compared, Entry, PredictedError, Prediction, Predictions, Term};
use crate::setups::Size;
use anyhow::Context;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::Moments;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let found = found(settings, predictions, cells)?;
    let mut section = Section { rows: rows(settings, cells, &found)?, ..Section::default() };
    section.budget = entries(&found);
    section.left_out = found.results.iter().filter(|r| !r.is_predicted_well()).count();
    section.claims = claims::all(settings, &found)?;
    section.figures = figures::all(settings, cells, &found)?;
    section.tables = tables::all(settings, &found)?;
    summarise(&mut section, settings, &found)?;
    section.headlines = headlines(&found)?;
    Ok(section)
}

fn found(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Found> {
    let known = Predictions::new(predictions);
    let mut results = Vec::new();
    for field in FIELDS {
        for (photons, _) in field.sizes(settings) {
            for case in Case::all(settings, field, photons) {
                let name = case.name();
                let expected = PredictedError::read(&known, &name, "fluence", &TERMS)?;
                results.push(Compared::new(case, &name, "fluence", expected, cells)?);
            }
        }
    }
    let mut sheets = Vec::new();
    for sheet in Sheet::all() {
        let ((value, bound), inside) = (known.get(&sheet.name(), "density")?, sheet.fields().0);
        let error_of = |v: f64| v / inside - 1.0;
        let errors: Vec<f64> = cells.values(&sheet.name(), "density")?.into_iter().map(error_of).collect();
        let error = errors.iter().collect();
        let (predicted, bound) = (error_of(value), bound / inside);
        sheets.push(SheetResult { sheet, predicted, bound, errors, error });
    }
    let mut spreads = Vec::new();
    for spread in Spread::all() {
        spreads.push(SpreadResult {
            exact: known.get(&spread.name(), "variance factor")?,
            mean: known.get(&spread.name(), "density")?,
            factors: cells.values(&spread.name(), "variance factor")?,
            means: cells.values(&spread.name(), "density")?,
            spread,
        });
    }
    let right =
        sheets.iter().find(|s| sheet::is_spread_case(&s.sheet)).context("the right rule is missing")?;
    let late = (cells.values(&right.sheet.name(), "variance")?, cells.values(sheet::LATE, "variance")?);
    Ok(Found { results, sheets, spreads, late })
}

/// Every case whose mean is predicted, for the budget of the study: right and wrong estimators alike.
fn entries(found: &Found) -> Vec<Entry> {
    let of_field = |r: &CaseResult| {
        r.entry(format!("boundary/{}", Case::group(r.case.field, r.case.photons)), &r.case.name())
    };
    let of_sheet = |s: &SheetResult| {
        let terms = [(Term::Edge, s.predicted)];
        Entry::new("boundary/sheet", s.sheet.name(), &terms, s.bound, s.errors.clone())
    };
    let of_spread = |s: &SpreadResult| {
        let terms = [(Term::Edge, s.mean.0 - 1.0)];
        let maps = s.means.iter().map(|m| m - 1.0).collect();
        Entry::new("boundary/spread", s.spread.name(), &terms, s.mean.1, maps)
    };
    let mut entries: Vec<Entry> =
        found.results.iter().filter(|r| r.is_predicted_well()).map(of_field).collect();
    entries.extend(found.sheets.iter().map(of_sheet));
    entries.extend(found.spreads.iter().map(of_spread));
    entries
}

fn rows(settings: &Settings, cells: &Cells, found: &Found) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for r in &found.results {
        let [fluence, error, left] =
            r.rows(&r.case.name(), ("fluence", Unit::FLUENCE), r.case.parameters(), cells)?;
        let maps = r.errors.len() as u64;
        rows.extend([fluence.cost(r.case.photons * maps, "photons emitted"), error, left]);
    }
    for s in &found.sheets {
        let (name, inside) = (s.sheet.name(), s.sheet.fields().0);
        let row = Row::measured(&name, "density", Unit::ONE, &cells.moments(&name, "density")?)?;
        let asked = Parameters { kernel: Some(s.sheet.kernel), ..s.sheet.size.parameters() };
        rows.push(row.reference(inside, 0.0).with(asked));
        let left: Moments = s.errors.iter().map(|e| e - s.predicted).collect();
        let row = Row::measured(&name, "error left over", Unit::FRACTION, &left)?;
        rows.push(row.reference(0.0, s.bound).with(asked));
    }
    for s in &found.spreads {
        let (name, factors) = (s.spread.name(), s.factors.iter().collect::<Moments>());
        let row = Row::measured(&name, "variance factor", Unit::ONE, &factors)?;
        let asked = Parameters { kernel: Some(s.spread.kernel), ..Size::Radius(spread::RADIUS).parameters() };
        rows.push(row.reference(s.exact.0, s.exact.1).with(asked));
        let means: Moments = s.means.iter().collect();
        let row = Row::measured(&name, "density", Unit::ONE, &means)?;
        rows.push(row.reference(s.mean.0, s.mean.1).with(asked));
    }
    for rim in rims(settings, found) {
        for (quantity, measured, predicted) in
            [("rim width", rim.width, rim.predicted_width), ("lost fluence", rim.lost, rim.predicted_lost)]
        {
            let estimate = crate::harness::Estimate::jackknife(&measured);
            let row = Row::estimated(&rim.name(), quantity, Unit::MFP, &estimate)?.predicted(predicted);
            let (field, photons) = (Some(rim.field.name), Some(rim.photons));
            rows.push(row.with(Parameters { field, photons, ..rim.size.parameters() }));
        }
    }
    for one in integrals(settings, found) {
        if one.measured.std_error > 0.0 {
            let estimate = crate::harness::Estimate::jackknife(&one.measured);
            let row = Row::estimated(&one.name(), "size of the error over depth", Unit::MFP, &estimate)?;
            let asked = Parameters { field: Some(one.field.name), ..one.size.parameters() };
            rows.push(row.predicted(one.predicted).with(asked));
        }
    }
    Ok(rows)
}

fn summarise(section: &mut Section, settings: &Settings, found: &Found) -> anyhow::Result<()> {
    let field = &FURNACE_SLAB;
    let face = |treatment| {
        found.one(|c| {
            (c.field, c.photons, c.treatment) == (field, field.main_size(settings), treatment)
                && (c.place, c.size, c.kernel) == (Place::Face(0.0), Size::Radius(0.4), Kernel::Uniform)
        })
    };
    let (none, clipped) = (face(Treatment::None)?, face(Treatment::Clipped)?);
    let kept_by = |rejection| -> anyhow::Result<[String; 2]> {
        let both = kept(found, rejection, 0.25, Size::Radius(0.1))?;
        Ok(both.map(|values| percent_with_error(&values.iter().collect())))
    };
    let facing = kept_by(Rejection::Facing)?;
    let behind = kept_by(Rejection::FacingBehind)?;
    section.summary.push(format!(
        "Between isotropic fields, looking at the photons' incoming direction cures neither fault: it leaves ({}) % of the false photons behind a \
         thin wall and does nothing for the low density at an edge, which dividing by the volume inside takes from \
         ({}) % to ({}) %.",
        behind[1],
        percent_with_error(&none.error),
        percent_with_error(&clipped.error),
    ));
    section.summary.push(format!(
        "Taken literally, keeping only photons that fly towards the wall, the advice also throws away half of the good \
         ones: it keeps ({}) % of them and ({}) % of the false ones. Directions tell photons apart on a surface, where all \
         arrive from the front; in a medium that light fills alike from all sides, as on both sides of this wall, half of the photons behind it fly \
         the same way as those in front; how many do where light has a direction was not measured. What a \
         photon's place tells is enough: behind the wall's plane, or out of sight. With clipping besides, both faults are \
         gone: these estimates are unbiased on either side of the wall, at any distance, kernel and gather.",
        facing[0], facing[1],
    ));
    let sphere = &LIT_SPHERE;
    let on_sphere = |treatment| -> anyhow::Result<String> {
        let r = found.one(|c| {
            (c.field, c.treatment, c.place) == (sphere, treatment, Place::Face(0.0))
                && (c.size, c.kernel) == (Size::Radius(0.4), Kernel::Uniform)
        })?;
        Ok(format!("({}) %", percent_with_error(&r.error)))
    };
    section.summary.push(format!(
        "Dividing by the volume inside mends geometry alone. Where the light falls off below a curved surface, on a sphere of albedo {} lit from \
         all sides and gathered within 0.4 mean free paths, the estimate errs by {} untreated, {} mirrored, {} clipped and {} with a plane \
         fitted: the treatment that knows of a slope is worth its noise there.",
        sphere.setup.albedo,
        on_sphere(Treatment::None)?,
        on_sphere(Treatment::Reflection)?,
        on_sphere(Treatment::Clipped)?,
        on_sphere(Treatment::LocalLinear)?,
    ));
    let squares: f64 = found.results.iter().filter(|r| r.is_predicted_well()).map(|r| r.z() * r.z()).sum();
    let used = found.results.iter().filter(|r| r.is_predicted_well()).count();
    section.summary.push(format!(
        "{} cases were measured and predicted before. What is left of the errors in transported fields after the \
         prediction has a root mean square of {:.2} standard errors (expected: 1).",
        found.results.len() + found.sheets.len() + found.spreads.len(),
        (squares / used.max(1) as f64).sqrt(),
    ));
    section.notes.push(format!(
        "With the k nearest, photons of one history cluster and draw the k-th nearer, by a part in a few hundred. The first \
         order of that is in the prediction; beside a face it is rough. {} cases in which it might differ by more than a \
         tenth of the standard error that their k, probes and maps let expect are left out of the study's budget.",
        found.results.len() - used
    ));
    section.notes.push(
        "Photons that were rejected after they had set the radius leave the mean of a clipped k-nearest estimate right, since \
         the k-1 nearer photons are a fair sample of their ball; they shrink the ball and so raise the variance. A fault that \
         no comparison of means can detect."
            .to_string(),
    );
    section.notes.push(
        "The furnace's loss is geometry alone, so that any phase function and any number of photons give the same error at \
         a fixed radius; the k nearest lose as much in a rim whose width falls with the cube root of photons over k."
            .to_string(),
    );
    Ok(())
}

fn headlines(found: &Found) -> anyhow::Result<Vec<Headline>> {
    let [_, wrong] = kept(found, Rejection::FacingBehind, 0.25, Size::Radius(0.1))?;
    let text = "false photons behind a thin wall that are left by looking at incoming directions";
    let share = Headline::new("False", text, Unit::FRACTION, Estimate::mean(&wrong.iter().collect()));
    let sphere = found.one(|c| {
        (c.field, c.treatment, c.place) == (&LIT_SPHERE, Treatment::Clipped, Place::Face(0.0))
            && (c.size, c.kernel) == (Size::Radius(0.4), Kernel::Uniform)
    })?;
    let text = "error at the surface of a lit sphere, gathered within 0.4 mean free paths and clipped";
    let clipped = Headline::new("Sphere", text, Unit::FRACTION, Estimate::mean(&sphere.error));
    Ok(vec![share, clipped])
}
