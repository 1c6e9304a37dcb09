//! The claims. Each is judged on one number a map, or on the mean of independent bodies: which body is wrong where one is,
//! the tables, the results and the error budget's groups tell.

use super::cases::{Case, MAIN, Place, whole_radius};
use super::fields::{FIELDS, FURNACE_SLAB, Field};
use super::results::{CaseResult, Found, kept};
use super::sheet::{Sheet, Side};
use crate::harness::{Claim, Estimate, GEOMETRIC, LEFT_OVER, PREDICTED, Settings, Unit};
use crate::setups::Size;
use crate::theory::treatment_title;
use anyhow::Context;
use turbid::estimators::Kernel;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::stats::{Moments, amplitude_per_map};

/// How far the part of the photons that a rejection keeps may lie from the predicted one.
const SHARE: f64 = 0.025;
/// How wrong an estimate beside a sheet may be that rejects and clips as it should: a tenth of what the milder faults do.
const BESIDE_SHEET: f64 = 0.03;

/// All claims of the experiment.
pub fn all(settings: &Settings, found: &Found) -> anyhow::Result<Vec<Claim>> {
    let mut claims = furnaces(settings, found)?;
    claims.extend(lit(found)?);
    claims.extend(nearest(settings, found)?);
    claims.extend(variances(found)?);
    claims.extend(sheets(found)?);
    Ok(claims)
}

/// Measured over predicted error of some cases of the same maps: one amplitude a map, weighted by what all maps say of
/// the noise.
fn amplitude(cases: &[(f64, &[f64])]) -> anyhow::Result<Estimate> {
    let maps = cases.iter().map(|c| c.1.len()).min().context("no cases")?;
    let predicted: Vec<f64> = cases.iter().map(|c| c.0).collect();
    let weights: Vec<f64> = cases.iter().map(|c| 1.0 / c.1.iter().collect::<Moments>().variance()).collect();
    let per_map: Vec<Vec<f64>> = (0..maps).map(|m| cases.iter().map(|c| c.1[m]).collect()).collect();
    let fitted = amplitude_per_map(&predicted, &per_map, &weights).context("nothing was predicted")?;
    Ok(Estimate::mean(&fitted.moments))
}

fn amplitude_of(results: &[&CaseResult]) -> anyhow::Result<Estimate> {
    crate::prediction::amplitude(results, CaseResult::predicted).context("nothing was predicted")
}

/// The mean error of some cases of the same maps, weighted alike.
fn mean_error(lists: &[&[f64]]) -> anyhow::Result<Estimate> {
    let ones: Vec<(f64, &[f64])> = lists.iter().map(|errors| (1.0, *errors)).collect();
    amplitude(&ones)
}

fn mean_of(results: &[&CaseResult]) -> anyhow::Result<Estimate> {
    let lists: Vec<&[f64]> = results.iter().map(|r| &r.errors[..]).collect();
    mean_error(&lists)
}

/// The cases of a field's main maps with fixed radius and a cut ball.
fn cut<'a>(
    settings: &Settings,
    found: &'a Found,
    field: &'static Field,
    treatment: Treatment,
) -> Vec<&'a CaseResult> {
    let photons = field.main_size(settings);
    found.pick(|c: &Case| {
        let is_cut = matches!(c.size, Size::Radius(r) if c.place.depth() < r);
        (c.field, c.photons, c.treatment) == (field, photons, treatment) && is_cut
    })
}

/// Measured over predicted error of the untreated estimate, and mean errors of the treated ones, which leave none in a
/// furnace; but for reflection in a ball, which has one of its own.
fn furnaces(settings: &Settings, found: &Found) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for treatment in Treatment::ALL {
        let mut bodies = Vec::new();
        for field in FIELDS.into_iter().filter(|f| f.setup.is_furnace()) {
            let chosen = cut(settings, found, field, treatment);
            let is_exact = chosen.iter().all(|r| r.predicted().abs() < 1e-6);
            if treatment == Treatment::None {
                bodies.push(amplitude_of(&chosen)?);
            } else if is_exact {
                bodies.push(mean_of(&chosen)?);
            }
        }
        claims.extend(treated("furnace", "furnaces", treatment, &bodies, LEFT_OVER));
    }
    Ok(claims)
}

/// A claim of the average over bodies: of the untreated estimate measured over predicted error, of others what is left.
fn treated(id: &str, bodies: &str, treatment: Treatment, found: &[Estimate], margin: f64) -> Option<Claim> {
    let id = format!("{id}-{}", treatment.name().replace(' ', "-"));
    let text = format!(
        "{bodies}, fixed radii, all kernels, balls cut by the surface, {}",
        treatment_title(treatment)
    );
    let statistic = Estimate::average(found)?;
    Some(match treatment {
        Treatment::None => Claim::about(
            &id,
            &format!("{text}: measured over predicted error"),
            Unit::ONE,
            statistic,
            1.0,
            GEOMETRIC,
        ),
        _ => Claim::about(&id, &format!("{text}: error left over"), Unit::FRACTION, statistic, 0.0, margin),
    })
}

/// Fields that are no furnaces: they bend in the ball. Their treated errors have both signs and are a few per cent: what
/// the prediction leaves of them is tested, not their ratio.
fn lit(found: &Found) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for treatment in Treatment::ALL {
        let mut bodies = Vec::new();
        for field in FIELDS.into_iter().filter(|f| !f.setup.is_furnace()) {
            let chosen = found.pick(|c| {
                let is_cut = matches!(c.size, Size::Radius(r) if c.place.depth() < r);
                c.field == field && c.treatment == treatment && is_cut
            });
            if treatment == Treatment::None {
                bodies.push(amplitude_of(&chosen)?);
            } else {
                let left: Vec<Vec<f64>> =
                    chosen.iter().map(|r| r.errors.iter().map(|e| e - r.predicted()).collect()).collect();
                let lists: Vec<&[f64]> = left.iter().map(|l| &l[..]).collect();
                bodies.push(mean_error(&lists)?);
            }
        }
        claims.extend(treated("lit", "lit slabs and sphere", treatment, &bodies, 2.0 * LEFT_OVER));
    }
    Ok(claims)
}

/// The k nearest in the furnace slab, where clusters are small, over all numbers of photons.
fn nearest(settings: &Settings, found: &Found) -> anyhow::Result<Vec<Claim>> {
    let field = &FURNACE_SLAB;
    let (mut none, mut clipped) = (Vec::new(), Vec::new());
    for (photons, _) in field.sizes(settings) {
        let chosen = |treatment| {
            found.pick(move |c| {
                (c.field, c.photons, c.treatment, c.size) == (field, photons, treatment, Size::Nearest(200))
                    && c.place.depth() < 0.6 * whole_radius(field, photons, 200)
            })
        };
        none.push(amplitude_of(&chosen(Treatment::None))?);
        clipped.push(mean_of(&chosen(Treatment::Clipped))?);
    }
    let text = "furnace slab, 200 nearest, by the face, all numbers of photons";
    let none = Estimate::average(&none).map(|statistic| {
        let text = format!("{text}: measured over predicted error, untreated");
        Claim::about("nearest-none", &text, Unit::ONE, statistic, 1.0, GEOMETRIC)
    });
    let clipped = Estimate::average(&clipped).map(|statistic| {
        let text = format!("{text}: mean error, clipped");
        Claim::about("nearest-clipped", &text, Unit::FRACTION, statistic, 0.0, 2.0 * LEFT_OVER)
    });
    Ok(none.into_iter().chain(clipped).collect())
}

/// What treatments cost.
fn variances(found: &Found) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    // Clipped is none times a number, whose variance needs no claim of its own.
    for treatment in [Treatment::Clipped, Treatment::Reflection, Treatment::LocalLinear] {
        let chosen: Vec<(f64, &[f64])> = found
            .spreads
            .iter()
            .filter(|s| s.spread.treatment == treatment && s.spread.depth < 1.0)
            .map(|s| (s.exact.0, &s.factors[..]))
            .collect();
        let id = format!("variance-{}", treatment.name().replace(' ', "-"));
        let text = format!(
            "independent photons below a face: variance of the estimate, measured over predicted, {}",
            treatment.name()
        );
        claims.push(Claim::about(&id, &text, Unit::ONE, amplitude(&chosen)?, 1.0, 2.0 * PREDICTED));
    }
    let (right, late) = &found.late;
    let mean = right.iter().sum::<f64>() / right.len() as f64;
    let ratio: Moments = late.iter().map(|v| v / mean).collect();
    let text = "beside a sheet, k nearest, clipped: variance if rejected photons set the radius, over that of the rule";
    claims.push(Claim::detected("late-rejection", text, Unit::ONE, Estimate::mean(&ratio), 1.0, 0.25));
    Ok(claims)
}

/// False photons.
fn sheets(found: &Found) -> anyhow::Result<Vec<Claim>> {
    let mut claims = Vec::new();
    // Beside a flat sheet 'visible' keeps the very photons that 'behind plane' keeps: it has one claim, that it does.
    for (rejection, good, bad) in [
        (Rejection::Facing, 0.5, 0.5),
        (Rejection::FacingBehind, 1.0, 0.5),
        (Rejection::BehindPlane, 1.0, 0.0),
    ] {
        let name = rejection.name().replace(' ', "-");
        let [kept_good, kept_bad] = kept(found, rejection, 0.25, Size::Radius(0.1))?;
        let mut add = |what: &str, values: &[f64], share: f64| {
            let text = format!(
                "beside a sheet: part of the {what} photons in the ball that '{}' keeps",
                rejection.name()
            );
            let id = format!("{name}-{what}");
            let statistic = Estimate::mean(&values.iter().collect());
            claims.push(Claim::about(&id, &text, Unit::FRACTION, statistic, share, SHARE));
        };
        add("good", &kept_good, good);
        // Exactly none has no spread, and needs no claim beside the one on the whole estimate.
        if bad > 0.0 {
            add("false", &kept_bad, bad);
        }
    }
    let of = |side, rejection, size, is_clipped| {
        let pick = move |s: &Sheet| {
            (s.side, s.rejection, s.size, s.is_clipped) == (side, rejection, size, is_clipped)
                && s.kernel == Kernel::Uniform
                && s.distance <= 0.5
        };
        found.sheets.iter().filter(|s| pick(&s.sheet)).map(|s| &s.errors[..]).collect::<Vec<&[f64]>>()
    };
    for (side, word) in [(Side::Bright, "bright"), (Side::Dark, "dark")] {
        for (size, how) in [(Size::Radius(0.1), "radius"), (Size::Nearest(30), "nearest")] {
            let id = format!("behind-plane-clipped-{word}-{how}");
            let text = format!(
                "beside a sheet, {word} side, {}: mean error of 'behind plane' with clipping",
                size.name()
            );
            let statistic = mean_error(&of(side, Rejection::BehindPlane, size, true))?;
            claims.push(Claim::about(&id, &text, Unit::FRACTION, statistic, 0.0, BESIDE_SHEET));
        }
    }
    claims.push(visible(found)?);
    let faults = [
        ("facing-bright", Side::Bright, Rejection::Facing, false, "'facing' alone on the bright side"),
        (
            "facing-clipped-bright",
            Side::Bright,
            Rejection::Facing,
            true,
            "'facing' with clipping on the bright side",
        ),
        (
            "facing-behind-dark",
            Side::Dark,
            Rejection::FacingBehind,
            true,
            "'facing behind' with clipping on the dark side",
        ),
        (
            "behind-plane-bright",
            Side::Bright,
            Rejection::BehindPlane,
            false,
            "'behind plane' without clipping",
        ),
        ("off-clipped-dark", Side::Dark, Rejection::Off, true, "clipping without rejection on the dark side"),
    ];
    for (id, side, rejection, is_clipped, words) in faults {
        let statistic = mean_error(&of(side, rejection, Size::Radius(0.1), is_clipped))?;
        let text = format!("beside a sheet, r=0.1: {words} is detected to be wrong (mean error)");
        claims.push(Claim::detected(id, &text, Unit::FRACTION, statistic, 0.0, 0.2));
    }
    Ok(claims)
}

/// Beside a flat sheet, seeing is being in front of it.
fn visible(found: &Found) -> anyhow::Result<Claim> {
    let mut largest: f64 = 0.0;
    for s in found.sheets.iter().filter(|s| s.sheet.rejection == Rejection::Visible) {
        let plane = found.sheet(&Sheet { rejection: Rejection::BehindPlane, ..s.sheet })?;
        let differences = s.errors.iter().zip(&plane.errors).map(|(a, b)| (a - b).abs());
        largest = differences.fold(largest, f64::max);
    }
    let text =
        "beside a flat sheet, every case and map: largest difference between 'visible' and 'behind plane'";
    Ok(Claim::at_most("visible-is-behind-plane", text, Unit::FRACTION, Estimate::exact(largest, 1e-11), 1e-8))
}

/// The place and size that tables and figures show.
pub fn is_main(c: &Case) -> bool {
    c.size == Size::Radius(MAIN.0) && c.kernel == Kernel::Uniform && matches!(c.place, Place::Face(_))
}
