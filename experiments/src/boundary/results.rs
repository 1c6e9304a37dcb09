//! What the maps say: results, what is made of them, and what is kept of an error.

use super::cases::{Case, Place};
use super::fields::{FIELDS, FURNACE_SLAB, Field};
use super::sheet;
use super::sheet::Sheet;
use super::spread::Spread;
use crate::harness::{self, Settings};
use crate::prediction::{Compared, Term};
use crate::setups::Size;
use anyhow::Context;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::{Jackknife, Moments, jackknife};

/// One case of a transported field; errors as fractions of the exact fluence.
pub type CaseResult = Compared<Case>;

impl CaseResult {
    /// The standard error to expect of the mean over maps, before any is measured: 1/(k-2) is the relative variance of
    /// an estimate by k independent photons. Clusters and what probes share make the true one larger.
    fn expected_error(&self, k: usize) -> f64 {
        let estimates = self.case.probes().len() * self.errors.len();
        1.0 / ((k as f64 - 2.0) * estimates as f64).sqrt()
    }

    /// Whether what is not known of the clusters is far below the standard error to expect: a tenth of their part inside,
    /// three tenths where a face is in the ball. What was measured has no say in it.
    pub fn is_predicted_well(&self) -> bool {
        let Size::Nearest(k) = self.case.size else { return true };
        let unsure = if self.case.place.depth() > 0.4 { 0.1 } else { 0.3 };
        unsure * self.expected.of(Term::Clusters).abs() <= 0.1 * self.expected_error(k)
    }
}

/// One case beside the sheet; errors as fractions of the field on the probe's side.
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
    pub results: Vec<CaseResult>,
    /// The sheet.
    pub sheets: Vec<SheetResult>,
    /// The variances.
    pub spreads: Vec<SpreadResult>,
    /// Variance of the k nearest beside the sheet, over its mean squared: rejected first, and rejected late.
    pub late: (Vec<f64>, Vec<f64>),
}

impl Found {
    /// The results that a test picks.
    pub fn pick(&self, test: impl Fn(&Case) -> bool) -> Vec<&CaseResult> {
        self.results.iter().filter(|r| test(&r.case)).collect()
    }

    /// One result.
    pub fn one(&self, test: impl Fn(&Case) -> bool) -> anyhow::Result<&CaseResult> {
        self.results.iter().find(|r| test(&r.case)).context("a case is missing")
    }

    /// One result beside the sheet.
    pub fn sheet(&self, wanted: &Sheet) -> anyhow::Result<&SheetResult> {
        self.sheets.iter().find(|s| s.sheet == *wanted).context("a case beside the sheet is missing")
    }
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

/// The error that is called a rim.
pub const VISIBLE: f64 = 0.05;

impl Rim {
    /// Its name in tables.
    pub fn name(&self) -> String {
        format!("{} n={} {} {} rim", self.field.name, self.photons, self.size.name(), self.treatment.name())
    }
}

/// Rims of the untreated estimate in the furnace slab, at every size and number of photons.
pub fn rims(settings: &Settings, found: &Found) -> Vec<Rim> {
    let field = &FURNACE_SLAB;
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
                is_this && c.kernel == Kernel::Uniform && matches!(c.place, Place::Face(_))
            });
            let depths: Vec<f64> = chosen.iter().map(|r| r.case.place.depth()).collect();
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
    /// Integral of the size of the mean error over the depths asked [mfp].
    pub measured: Jackknife,
    /// The same of the predicted error.
    pub predicted: f64,
    /// What noise alone would leave of it on average: sqrt(2/pi) standard errors at each depth.
    pub noise: f64,
}

impl Integral {
    pub fn name(&self) -> String {
        format!("{} {} {} below a face", self.field.name, self.size.name(), self.treatment.name())
    }
}

/// The size of the error over depth in every field's main maps, for each gather and treatment.
pub fn integrals(settings: &Settings, found: &Found) -> Vec<Integral> {
    let mut integrals = Vec::new();
    for field in FIELDS {
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
                    let is_whole = matches!(size, Size::Radius(r) if c.place.depth() >= r);
                    let asked = if is_whole { Treatment::None } else { treatment };
                    (c.field, c.photons, c.size, c.treatment) == (field, photons, size, asked)
                        && c.kernel == Kernel::Uniform
                        && matches!(c.place, Place::Face(_))
                });
                chosen.sort_by(|a, b| a.case.place.depth().total_cmp(&b.case.place.depth()));
                let depths: Vec<f64> = chosen.iter().map(|r| r.case.place.depth()).collect();
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

/// The integral of the size of errors under straight lines between depths.
fn size_over_depth(depths: &[f64], errors: &[f64]) -> f64 {
    let strip = |i: usize| 0.5 * (errors[i].abs() + errors[i - 1].abs()) * (depths[i] - depths[i - 1]);
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
    let strip = |i: usize| -0.5 * (errors[i] + errors[i - 1]) * (depths[i] - depths[i - 1]);
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
    let mass = 1.0 + of(sheet::Side::Bright, Rejection::BehindPlane)?.predicted;
    let f = sheet::DARK;
    let pairs = bright.errors.iter().zip(&dark.errors).map(|(b, d)| {
        let (b, d) = (1.0 + b, f * (1.0 + d));
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
