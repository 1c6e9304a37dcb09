//! The claims, by counts alone. Margins of regret are round numbers that somebody who chooses settings would act on.

use super::cases::{
    FIELDS, Field, MODERATE, MODERATE_FORWARD, Rival, SPHERE, THIN, THIN_FORWARD, Treatment, Worth,
};
use super::choose::{BreakEven, Currency, best_over_best, break_even, most_efficient, regret};
use super::data::{Data, Measured, Paths};
use super::split::{rms, rms_noise};
use crate::harness::{Claim, Estimate, LEFT_OVER, PREDICTED, Unit};
use crate::setups::Size;
use turbid::stats::Moments;

/// All claims of the experiment.
pub fn all(data: &Data) -> Vec<Claim> {
    let mut claims = error_claims(data);
    claims.extend(independent_claim(data, &MODERATE));
    for field in FIELDS {
        claims.extend(regret_claim(data, field));
    }
    for field in [&THIN, &THIN_FORWARD, &MODERATE, &MODERATE_FORWARD] {
        claims.push(clipping_claim(data, field));
    }
    for rival in Rival::ALL {
        claims.extend(FIELDS.into_iter().filter_map(|field| break_even_claim(data, field, rival)));
    }
    claims.extend(path_claim("paths", "the path tracer", data.paths.iter()));
    claims.extend(path_claim("guided-paths", "guided paths", data.guided.iter().map(|guided| &guided.paths)));
    claims
}

/// A claim about the sphere, for which another bound had failed with seed 1.
fn of_field(claim: Claim, field: &Field) -> Claim {
    if field == &SPHERE { claim.chosen_after("bound", &[1]) } else { claim }
}

/// A case of the largest maps of a field.
fn find<'a>(data: &'a Data, field: &Field, treatment: Treatment, size: Size) -> Option<&'a Measured> {
    data.of(field, treatment, Some(data.largest(field))).into_iter().find(|m| m.setting.size == size)
}

/// The main settings have the predicted error, on the mean over fields.
fn error_claims(data: &Data) -> Vec<Claim> {
    let mut claims = Vec::new();
    for size in [Size::Radius(0.2), Size::Nearest(50)] {
        for treatment in Treatment::ALL {
            let mut fields = Vec::new();
            for field in FIELDS {
                let Some(case) = find(data, field, treatment, size) else { continue };
                // Where no ball is cut, clipped is plain.
                let plain = find(data, field, Treatment::Plain, size);
                if treatment == Treatment::Plain || plain.is_none_or(|p| p.maps != case.maps) {
                    fields.push(rms(&case.maps).times(1.0 / case.predicted().total()));
                }
            }
            let id = format!("{}-{}", size.name().replace('=', ""), treatment.name());
            let text = format!(
                "{}, {}: RMS error over probes and maps, measured over predicted, all fields",
                size.name(),
                treatment.title()
            );
            claims.extend(
                Estimate::average(&fields).map(|s| Claim::about(&id, &text, Unit::ONE, s, 1.0, PREDICTED)),
            );
        }
    }
    claims
}

/// Wrong on purpose: the noise that independent photons would make.
fn independent_claim(data: &Data, field: &Field) -> Option<Claim> {
    let case = find(data, field, Treatment::Plain, Size::Radius(0.2))?;
    let squares: Vec<f64> = case.expected.iter().map(|e| e.noise_independent * e.noise_independent).collect();
    let independent = super::data::mean(&squares).sqrt();
    let statistic = rms_noise(&case.maps).times(1.0 / independent);
    let text = format!(
        "wrong on purpose, photons of one history taken as independent, {}, r=0.2: RMS noise, measured over predicted",
        field.title
    );
    Some(Claim::detected("independent-photons", &text, Unit::ONE, statistic, 1.0, 0.05))
}

/// What everybody's k costs.
fn regret_claim(data: &Data, field: &Field) -> Option<Claim> {
    let case = find(data, field, Treatment::Clipped, Size::Nearest(50))?;
    let cases = data.of(field, Treatment::Clipped, Some(data.largest(field)));
    let text = format!(
        "{}, the largest maps, clipped: RMS error with k = 50 over that of the best setting tried, chosen on other maps",
        field.title
    );
    let id = format!("{}-regret-50", field.name);
    Some(of_field(Claim::at_least(&id, &text, Unit::ONE, regret(case, &cases), field.regret), field))
}

/// Where faces are near, clipping buys more than any choice of k or radius.
fn clipping_claim(data: &Data, field: &Field) -> Claim {
    let of = |treatment| data.of(field, treatment, Some(data.largest(field)));
    let ratio = best_over_best(&of(Treatment::Clipped), &of(Treatment::Plain));
    let text = format!(
        "{}, the largest maps: RMS error of the best clipped setting over that of the best untreated one",
        field.title
    );
    Claim::at_most(&format!("{}-clipping", field.name), &text, Unit::ONE, ratio, 0.75)
}

/// Whether a map pays, against paths that nothing leads and the best that paths can do. Which of the two is claimed of a field is fixed with
/// the field.
fn break_even_claim(data: &Data, field: &Field, rival: Rival) -> Option<Claim> {
    let chosen = most_efficient(&data.of(field, Treatment::Clipped, None))?;
    let BreakEven { ratio, share, .. } =
        break_even(chosen.case, data.paths_of(rival, field)?, Currency::Operations);
    let by = rival.name();
    let id = match rival {
        Rival::Paths => format!("{}-break-even", field.name),
        Rival::Guided => format!("{}-break-even-guided", field.name),
    };
    let title = field.title;
    let claim = match field.worth {
        Worth::By4096 => {
            let text = format!(
                "{title}, clipped, in operations: 4096 queries from the most efficient map, the map included, over as \
                 many by {by} of the same error"
            );
            Claim::at_most(&id, &text, Unit::ONE, share, 1.0)
        }
        Worth::Late => {
            let text = format!(
                "{title}, clipped, in operations, a photon gathered counted like a ray: rays of a query by {by} over \
                 photons gathered from the most efficient map of the same error, so that from some number of queries on it pays"
            );
            Claim::at_least(&id, &text, Unit::ONE, ratio, 1.0)
        }
        Worth::Never => {
            let text = format!(
                "{title}, clipped, in operations, a photon gathered counted like a ray: rays of a query by {by} over photons \
                 gathered from the most efficient map of the same error, so that no number of queries pays for it"
            );
            Claim::at_most(&id, &text, Unit::ONE, ratio, 1.0)
        }
    };
    Some(of_field(claim, field))
}

/// Paths agree with the exact solution, on the mean over fields.
fn path_claim<'a>(id: &str, name: &str, paths: impl Iterator<Item = &'a Paths>) -> Option<Claim> {
    let of_field = |paths: &Paths| Estimate::mean(&paths.error.iter().collect::<Moments>());
    let fields: Vec<Estimate> = paths.map(of_field).collect();
    let text = format!("error of {name}, averaged over depth, all fields");
    let statistic = Estimate::average(&fields)?;
    Some(Claim::about(id, &text, Unit::FRACTION, statistic, 0.0, 2.0 * LEFT_OVER))
}
