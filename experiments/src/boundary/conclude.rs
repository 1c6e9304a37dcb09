//! What all maps together say.

use super::cases::{Case, Size, Spot};
use super::fields::{FIELDS, Field};
use super::predict::{Parts, recall};
use super::sheet::Sheet;
use super::spread::Spread;
use super::{claims, figures, sheet, tables};
use crate::harness::{
    self, Cells, Compared, Entry, Known, Prediction, Row, Section, Settings, Term, Unit, with_error,
};
use anyhow::Context;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::{Jackknife, Moments, jackknife};

/// One case of a transported field; errors in per cent of the exact fluence.
pub type Result = Compared<Case, Parts>;

impl Result {
    /// The standard error to expect of the mean over maps [%], before any is measured: 1/(k-2) is the relative variance of
    /// an estimate by k independent photons. Clusters and what probes share make the true one larger.
    fn expected_error(&self, k: usize) -> f64 {
        let estimates = self.case.probes().len() * self.errors.len();
        100.0 / ((k as f64 - 2.0) * estimates as f64).sqrt()
    }

    /// Whether what is not known of the clusters is far below the standard error to expect: a tenth of their part inside,
    /// three tenths where a face is in the ball. What was measured has no say in it.
    pub fn is_predicted_well(&self) -> bool {
        let Size::Nearest(k) = self.case.size else { return true };
        let unsure = if self.case.spot.depth() > 0.4 { 0.1 } else { 0.3 };
        100.0 * unsure * self.parts.clusters.abs() <= 0.1 * self.expected_error(k)
    }
}

/// One case beside the sheet; errors in per cent of the field on the probe's side.
pub struct SheetResult {
    /// The case.
    pub sheet: Sheet,
    /// Predicted error.
    pub predicted: f64,
    /// Bound on its numerical error.
    pub bound: f64,
    /// Signed error of each map.
    pub errors: Vec<f64>,
    /// The same over maps.
    pub error: Moments,
}

/// One case of the variances.
pub struct SpreadResult {
    /// The case.
    pub spread: Spread,
    /// Exact variance factor and bound.
    pub exact: (f64, f64),
    /// Exact mean and bound.
    pub mean: (f64, f64),
    /// Measured variance factor of each map.
    pub factors: Vec<f64>,
    /// Measured mean of each map.
    pub means: Vec<f64>,
}

/// Everything that was found.
pub struct Found {
    /// Transported fields.
    pub results: Vec<Result>,
    /// The sheet.
    pub sheets: Vec<SheetResult>,
    /// The variances.
    pub spreads: Vec<SpreadResult>,
    /// Variance of the k nearest beside the sheet, over its mean squared: rejected first, and rejected late.
    pub late: (Vec<f64>, Vec<f64>),
}

impl Found {
    /// The results that a test picks.
    pub fn pick(&self, test: impl Fn(&Case) -> bool) -> Vec<&Result> {
        self.results.iter().filter(|r| test(&r.case)).collect()
    }

    /// One result.
    pub fn one(&self, test: impl Fn(&Case) -> bool) -> anyhow::Result<&Result> {
        self.results.iter().find(|r| test(&r.case)).context("a case is missing")
    }

    /// One result beside the sheet.
    pub fn sheet(&self, wanted: &Sheet) -> anyhow::Result<&SheetResult> {
        self.sheets.iter().find(|s| s.sheet == *wanted).context("a case beside the sheet is missing")
    }
}

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
    Ok(section)
}

fn found(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Found> {
    let known = Known::new(predictions);
    let mut results = Vec::new();
    for field in &FIELDS {
        for (photons, _) in field.sizes(settings) {
            for case in Case::all(settings, field, photons) {
                let parts = recall(&known, &case)?;
                results.push(Compared::new(case, &case.name(), "fluence", parts, cells)?);
            }
        }
    }
    let mut sheets = Vec::new();
    for sheet in Sheet::all() {
        let ((value, bound), inside) = (known.get(&sheet.name(), "density")?, sheet.fields().0);
        let percent = |v: f64| 100.0 * (v / inside - 1.0);
        let errors: Vec<f64> = cells.values(&sheet.name(), "density")?.into_iter().map(percent).collect();
        let error = errors.iter().collect();
        let (predicted, bound) = (percent(value), 100.0 * bound / inside);
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
    let fraction = |errors: &[f64]| errors.iter().map(|e| e / 100.0).collect::<Vec<f64>>();
    let of_field = |r: &Result| {
        let terms =
            [(Term::Edge, r.parts.edge), (Term::Blur, r.parts.blur), (Term::Clusters, r.parts.clusters)];
        let group = format!("boundary/{}", Case::group(r.case.field, r.case.photons));
        Entry::new(group, r.case.name(), &terms, r.parts.error, fraction(&r.errors))
    };
    let of_sheet = |s: &SheetResult| {
        let terms = [(Term::Edge, s.predicted / 100.0)];
        Entry::new("boundary/sheet", s.sheet.name(), &terms, s.bound / 100.0, fraction(&s.errors))
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
        let (name, fluence) = (r.case.name(), cells.moments(&r.case.name(), "fluence")?);
        rows.push(
            Row::measured(&name, "fluence", Unit::FLUENCE, &fluence)?
                .reference(r.parts.exact, 0.0)
                .cost(r.case.photons * fluence.n(), "photons emitted"),
        );
        rows.push(Row::measured(&name, "error", Unit::PERCENT, &r.error)?.predicted(r.predicted()));
        let left: Moments = r.errors.iter().map(|e| e - r.predicted()).collect();
        rows.push(
            Row::measured(&name, "error left over", Unit::PERCENT, &left)?
                .reference(0.0, 100.0 * r.parts.error),
        );
    }
    for s in &found.sheets {
        let (name, inside) = (s.sheet.name(), s.sheet.fields().0);
        let row = Row::measured(&name, "density", Unit::ONE, &cells.moments(&name, "density")?)?;
        rows.push(row.reference(inside, 0.0));
        let left: Moments = s.errors.iter().map(|e| e - s.predicted).collect();
        rows.push(Row::measured(&name, "error left over", Unit::PERCENT, &left)?.reference(0.0, s.bound));
    }
    for s in &found.spreads {
        let (name, factors) = (s.spread.name(), s.factors.iter().collect::<Moments>());
        let row = Row::measured(&name, "variance factor", Unit::ONE, &factors)?;
        rows.push(row.reference(s.exact.0, s.exact.1));
        let means: Moments = s.means.iter().collect();
        rows.push(Row::measured(&name, "density", Unit::ONE, &means)?.reference(s.mean.0, s.mean.1));
    }
    for rim in rims(settings, found) {
        for (quantity, measured, predicted) in
            [("rim width", rim.width, rim.predicted_width), ("lost fluence", rim.lost, rim.predicted_lost)]
        {
            let estimate = crate::harness::Estimate::jackknife(&measured);
            rows.push(Row::estimated(&rim.name(), quantity, Unit::MFP, &estimate)?.predicted(predicted));
        }
    }
    for one in integrals(settings, found) {
        if one.measured.std_error > 0.0 {
            let estimate = crate::harness::Estimate::jackknife(&one.measured);
            let row = Row::estimated(&one.name(), "size of the error over depth", Unit::MFP, &estimate)?;
            rows.push(row.predicted(one.predicted));
        }
    }
    Ok(rows)
}

/// How far error reaches below a face, and how much there is of it.
pub struct Rim {
    /// The field.
    pub field: &'static Field,
    /// Photons a map.
    pub photons: u64,
    /// Gather size.
    pub size: Size,
    /// Treatment.
    pub treatment: Treatment,
    /// The depth down to which the mean error is at least [`VISIBLE`] in size [mfp].
    pub width: Jackknife,
    /// The same of the predicted error at the same depths.
    pub predicted_width: f64,
    /// Integral of the mean loss over depth [mfp]: the thickness of fluence that is lost.
    pub lost: Jackknife,
    /// The same of the predicted error at the same depths.
    pub predicted_lost: f64,
}

/// The error that is called a rim [%].
pub const VISIBLE: f64 = 5.0;

impl Rim {
    /// Its name in tables.
    pub fn name(&self) -> String {
        format!("{} n={} {} {} rim", self.field.name, self.photons, self.size.name(), self.treatment.name())
    }
}

/// Rims of the untreated estimate in the furnace slab, at every size and number of photons.
pub fn rims(settings: &Settings, found: &Found) -> Vec<Rim> {
    let field = &FIELDS[0];
    let mut rims = Vec::new();
    for (photons, _) in field.sizes(settings) {
        let all = Case::all(settings, field, photons);
        let mut sizes: Vec<Size> = all.iter().map(|c| c.size).collect();
        sizes.dedup();
        let mut seen: Vec<Size> = Vec::new();
        for size in sizes {
            if seen.contains(&size) {
                continue;
            }
            seen.push(size);
            let treatment = Treatment::None;
            let chosen = found.pick(|c| {
                let is_this = (c.field, c.photons, c.size, c.treatment) == (field, photons, size, treatment);
                is_this && c.kernel == Kernel::Uniform && matches!(c.spot, Spot::Face(_))
            });
            let depths: Vec<f64> = chosen.iter().map(|r| r.case.spot.depth()).collect();
            let maps = chosen.iter().map(|r| r.errors.len()).min().unwrap_or(0);
            let profiles: Vec<Vec<f64>> =
                (0..maps).map(|m| chosen.iter().map(|r| r.errors[m]).collect()).collect();
            let predicted: Vec<f64> = chosen.iter().map(|r| r.predicted()).collect();
            let mean = |maps: &[Vec<f64>]| -> Vec<f64> {
                (0..depths.len())
                    .map(|i| maps.iter().map(|p| p[i]).sum::<f64>() / maps.len() as f64)
                    .collect()
            };
            rims.push(Rim {
                field,
                photons,
                size,
                treatment,
                width: jackknife(&profiles, |maps| width(&depths, &mean(maps))),
                predicted_width: width(&depths, &predicted),
                lost: jackknife(&profiles, |maps| lost(&depths, &mean(maps))),
                predicted_lost: lost(&depths, &predicted),
            });
        }
    }
    rims
}

/// How much error, of either sign, there is below a face.
pub struct Integral {
    /// The field.
    pub field: &'static Field,
    /// Gather size.
    pub size: Size,
    /// Treatment.
    pub treatment: Treatment,
    /// Integral of the size of the mean error over the depths asked, as a fraction [mfp].
    pub measured: Jackknife,
    /// The same of the predicted error.
    pub predicted: f64,
    /// What noise alone would leave of it on average: sqrt(2/pi) standard errors at each depth.
    pub noise: f64,
}

impl Integral {
    fn name(&self) -> String {
        format!("{} {} {} below a face", self.field.name, self.size.name(), self.treatment.name())
    }
}

/// The size of the error over depth in every field's main maps, for each gather and treatment.
pub fn integrals(settings: &Settings, found: &Found) -> Vec<Integral> {
    let mut integrals = Vec::new();
    for field in &FIELDS {
        let photons = field.main_size(settings);
        let mut sizes: Vec<Size> = Vec::new();
        for case in Case::all(settings, field, photons) {
            if !sizes.contains(&case.size) {
                sizes.push(case.size);
            }
        }
        for size in sizes {
            for treatment in Treatment::ALL {
                let mut chosen = found.pick(|c| {
                    // In whole balls all treatments are one, which is asked once.
                    let is_whole = matches!(size, Size::Radius(r) if c.spot.depth() >= r);
                    let asked = if is_whole { Treatment::None } else { treatment };
                    (c.field, c.photons, c.size, c.treatment) == (field, photons, size, asked)
                        && c.kernel == Kernel::Uniform
                        && matches!(c.spot, Spot::Face(_))
                });
                chosen.sort_by(|a, b| a.case.spot.depth().total_cmp(&b.case.spot.depth()));
                let depths: Vec<f64> = chosen.iter().map(|r| r.case.spot.depth()).collect();
                let maps = chosen.iter().map(|r| r.errors.len()).min().unwrap_or(0);
                let profiles: Vec<Vec<f64>> =
                    (0..maps).map(|m| chosen.iter().map(|r| r.errors[m]).collect()).collect();
                let of_mean = |maps: &[Vec<f64>]| {
                    let mean = |i: usize| maps.iter().map(|p| p[i]).sum::<f64>() / maps.len() as f64;
                    size_over_depth(&depths, &(0..depths.len()).map(mean).collect::<Vec<f64>>())
                };
                let predicted: Vec<f64> = chosen.iter().map(|r| r.predicted()).collect();
                let share = (2.0 / std::f64::consts::PI).sqrt();
                let noise: Vec<f64> = chosen.iter().map(|r| share * r.error.std_error()).collect();
                integrals.push(Integral {
                    field,
                    size,
                    treatment,
                    measured: jackknife(&profiles, of_mean),
                    predicted: size_over_depth(&depths, &predicted),
                    noise: size_over_depth(&depths, &noise),
                });
            }
        }
    }
    integrals
}

/// The integral of the size of errors [%], as a fraction, under straight lines between depths.
fn size_over_depth(depths: &[f64], errors: &[f64]) -> f64 {
    let strip = |i: usize| 0.005 * (errors[i].abs() + errors[i - 1].abs()) * (depths[i] - depths[i - 1]);
    (1..depths.len()).map(strip).sum()
}

/// The depth at which an error that begins beyond [`VISIBLE`] comes down to it, on straight lines between depths.
fn width(depths: &[f64], errors: &[f64]) -> f64 {
    for i in 1..depths.len() {
        let (before, after) = (errors[i - 1].abs(), errors[i].abs());
        if before >= VISIBLE && after < VISIBLE {
            return depths[i - 1] + (depths[i] - depths[i - 1]) * (before - VISIBLE) / (before - after);
        }
    }
    if errors[0].abs() < VISIBLE { 0.0 } else { depths[depths.len() - 1] }
}

/// The loss under straight lines between depths, the error having one sign.
fn lost(depths: &[f64], errors: &[f64]) -> f64 {
    let strip = |i: usize| -0.005 * (errors[i] + errors[i - 1]) * (depths[i] - depths[i - 1]);
    (1..depths.len()).map(strip).sum()
}

/// Of good photons and of false ones, the part that a rejection keeps: one pair a map, from both sides of the sheet.
///
/// Without clipping, the two sides read p_in M + p_out DARK (1-M) and p_in DARK M + p_out (1-M) with M the kernel's mass
/// on the probe's side.
pub fn kept(found: &Found, rejection: Rejection, distance: f64, size: Size) -> anyhow::Result<[Vec<f64>; 2]> {
    let of = |side, rejection| {
        let sheet = Sheet { side, distance, size, kernel: Kernel::Uniform, rejection, is_clipped: false };
        found.sheet(&sheet)
    };
    let (bright, dark) = (of(sheet::Side::Bright, rejection)?, of(sheet::Side::Dark, rejection)?);
    // The exact mass: what a perfect rejection of all false photons leaves on the bright side.
    let mass = 1.0 + of(sheet::Side::Bright, Rejection::BehindPlane)?.predicted / 100.0;
    let f = sheet::DARK;
    let pairs = bright.errors.iter().zip(&dark.errors).map(|(b, d)| {
        let (b, d) = (1.0 + b / 100.0, f * (1.0 + d / 100.0));
        ((b - f * d) / (mass * (1.0 - f * f)), (d - f * b) / ((1.0 - mass) * (1.0 - f * f)))
    });
    let (good, bad) = pairs.unzip();
    Ok([good, bad])
}

/// A number with so many decimals and a proper minus.
pub fn signed(x: f64, decimals: usize) -> String {
    let text = harness::signed(x, decimals);
    let is_zero = text.chars().all(|c| "−0.".contains(c));
    if is_zero { text.replace('−', "") } else { text }
}

fn summarise(section: &mut Section, settings: &Settings, found: &Found) -> anyhow::Result<()> {
    let field = &FIELDS[0];
    let face = |treatment| {
        found.one(|c| {
            (c.field, c.photons, c.treatment) == (field, field.main_size(settings), treatment)
                && (c.spot, c.size, c.kernel) == (Spot::Face(0.0), Size::Radius(0.4), Kernel::Uniform)
        })
    };
    let text = |m: &Moments| with_error(m.mean(), m.std_error());
    let (none, clipped) = (face(Treatment::None)?, face(Treatment::Clipped)?);
    let kept_by = |rejection| -> anyhow::Result<[String; 2]> {
        let both = kept(found, rejection, 0.25, Size::Radius(0.1))?;
        Ok(both.map(|values| text(&values.iter().map(|v| 100.0 * v).collect())))
    };
    let facing = kept_by(Rejection::Facing)?;
    let behind = kept_by(Rejection::FacingBehind)?;
    section.summary.push(format!(
        "Between isotropic fields, looking at the photons' incoming direction cures neither fault: it leaves ({}) % of the false photons behind a \
         thin wall and does nothing for the low density at an edge, which dividing by the volume inside takes from \
         ({}) % to ({}) %.",
        behind[1],
        text(&none.error),
        text(&clipped.error),
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
    let sphere = Field::named("lit-sphere")?;
    let on_sphere = |treatment| -> anyhow::Result<String> {
        let r = found.one(|c| {
            (c.field, c.treatment, c.spot) == (sphere, treatment, Spot::Face(0.0))
                && (c.size, c.kernel) == (Size::Radius(0.4), Kernel::Uniform)
        })?;
        Ok(format!("({}) %", text(&r.error)))
    };
    section.summary.push(format!(
        "Dividing by the volume inside mends geometry alone. Where the light falls off below a curved surface, on a sphere of albedo {} lit from \
         all sides and gathered within 0.4 mean free paths, the estimate errs by {} untreated, {} mirrored, {} clipped and {} with a plane \
         fitted: the treatment that knows of a slope is worth its noise there.",
        sphere.albedo,
        on_sphere(Treatment::None)?,
        on_sphere(Treatment::Reflection)?,
        on_sphere(Treatment::Clipped)?,
        on_sphere(Treatment::LocalLinear)?,
    ));
    let squares: f64 = found.results.iter().filter(|r| r.is_predicted_well()).map(|r| r.z() * r.z()).sum();
    let used = found.results.iter().filter(|r| r.is_predicted_well()).count();
    section.summary.push(format!(
        "{} cases were measured and predicted before. What is left of the errors in transported fields after the \
         prediction has a root mean square of {:.2} standard errors (1 if all is understood).",
        found.results.len() + found.sheets.len() + found.spreads.len(),
        (squares / used.max(1) as f64).sqrt(),
    ));
    section.notes.push(format!(
        "With the k nearest, photons of one history cluster and draw the k-th nearer, by a part in a few hundred. The first \
         order of that is in the prediction; beside a face it is rough. {} cases in which it might be off by more than a \
         tenth of the standard error that their k, probes and maps let expect are left out of the study's budget.",
        found.results.len() - used
    ));
    section.notes.push(
        "Photons that were rejected after they had set the radius leave the mean of a clipped k-nearest estimate right, since \
         the k-1 nearer photons are a fair sample of their ball; they shrink the ball and so raise the variance. A fault that \
         no comparison of means can see."
            .to_string(),
    );
    section.notes.push(
        "The furnace's loss is geometry alone, so that any phase function and any number of photons give the same error at \
         a fixed radius; the k nearest lose as much in a rim whose width falls with the cube root of photons over k."
            .to_string(),
    );
    Ok(())
}
