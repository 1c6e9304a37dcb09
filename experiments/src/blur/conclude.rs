//! What all maps together say: rows, budget, claims, figures, tables.

use super::cases::Case;
use super::measure::all_cases;
use super::predict::{EQUIVALENT, RISE, Theory};
use super::results::{CaseResult, Transfer, find};
use super::shaft::CAP;
use super::{claims, figures, shaft, tables, waves};
use crate::harness::{Cells, Estimate, Headline, Parameters, Row, Section, Settings, Unit, percent};
use crate::prediction::{Entry, Prediction, Predictions, Term};
use crate::setups::Size;
use turbid::estimators::Kernel;
use turbid::stats::Moments;
use turbid::transport::in_parallel;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let cases = all_cases(settings);
    let results =
        in_parallel(cases.len(), |i| CaseResult::new(cases[i], Theory::recall(&known, &cases[i])?, cells));
    let results = results.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mut transfers = Vec::new();
    for kernel in Kernel::ALL {
        for radius in waves::RADII {
            let name = waves::case(kernel, radius);
            let (predicted, error) = known.get(&name, waves::QUANTITY)?;
            let maps = cells.values(&name, waves::QUANTITY)?;
            transfers.push(Transfer { kernel, radius, predicted, error, maps });
        }
    }
    let mut section = Section { rows: rows(&results, &transfers)?, ..Section::default() };
    section.budget = results.iter().flat_map(entries).collect();
    section.budget.extend(transfers.iter().map(|t| {
        let maps = t.maps.iter().map(|c| c - 1.0).collect();
        let group = format!("blur-{}", waves::GROUP);
        Entry::new(group, waves::case(t.kernel, t.radius), &[(Term::Blur, t.predicted - 1.0)], t.error, maps)
    }));
    section.claims = claims::all(&results, &transfers)?;
    section.figures = figures::all(&results, &transfers)?;
    section.tables = vec![tables::widths(&results), tables::cost()?];
    summarise(&mut section, &results, &transfers);
    section.headlines = headlines(&results);
    Ok(section)
}

/// Fewest photons behind a map's value for the budget: their skewness is then below a tenth, and that of the mean over
/// hundreds of maps below a hundredth.
const ENOUGH: f64 = 100.0;

/// The places of a profile in the error budget, in parts of the exact fluence inside. On the edge itself the exact value
/// is taken to be the mean of both sides.
fn entries(result: &CaseResult) -> Vec<Entry> {
    let group = format!("blur-{}", Case::group(result.case.photons));
    let mut entries = Vec::new();
    for (index, place) in result.case.places().into_iter().enumerate() {
        if result.photons(index) < ENOUGH {
            continue;
        }
        let exact = if place.abs() < 1e-9 { 0.5 } else { f64::from(u8::from(place > 0.0)) };
        let (value, error) = result.theory.profile[index];
        let maps = result.profile[index].iter().map(|v| v - exact).collect();
        let name = format!("{} at {place:.2}", result.case.name());
        entries.push(Entry::new(group.clone(), name, &[(Term::Blur, value - exact)], error, maps));
    }
    entries
}

fn rows(results: &[CaseResult], transfers: &[Transfer]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for result in results {
        let (name, asked, theory) = (result.case.name(), result.case.parameters(), &result.theory);
        for (index, place) in result.case.places().into_iter().enumerate() {
            let mean = result.mean(index);
            // Where no map has found a photon there is nothing to say.
            if mean.variance() > 0.0 {
                let (value, error) = theory.profile[index];
                rows.push(
                    Row::measured(&name, &Case::quantity(place), Unit::ONE, &mean)?
                        .reference(value, error)
                        .with(asked),
                );
            }
        }
        rows.push(
            Row::estimated(&name, RISE, Unit::MFP, &result.rise)?
                .reference(theory.rise_probed, 1e-9)
                .cost(result.case.photons * result.single.n(), "photons emitted")
                .with(asked),
        );
        if let Some(equivalent) = &result.equivalent {
            rows.push(
                Row::estimated(&name, EQUIVALENT, Unit::MFP, equivalent)?
                    .reference(theory.equivalent_probed, 1e-9)
                    .with(asked),
            );
        }
        rows.push(Row::measured(&name, "10-90 width of one map", Unit::MFP, &result.single)?.with(asked));
    }
    for t in transfers {
        let asked = Parameters { kernel: Some(t.kernel), ..Size::Radius(t.radius).parameters() };
        let (name, contrast) = (waves::case(t.kernel, t.radius), t.maps.iter().collect::<Moments>());
        rows.push(
            Row::measured(&name, waves::QUANTITY, Unit::ONE, &contrast)?
                .reference(t.predicted, t.error)
                .with(asked),
        );
    }
    Ok(rows)
}

fn summarise(section: &mut Section, results: &[CaseResult], transfers: &[Transfer]) {
    let by_scale = |r: &CaseResult| r.rise.times(1.0 / r.case.scale());
    let text = |e: &Estimate| crate::harness::with_error(e.value(), e.std_error());
    let fixed = find(results, Size::Radius(0.2), Kernel::Uniform);
    let nearest = find(results, Size::Nearest(100), Kernel::Uniform);
    if let (Some(fixed), Some(nearest)) = (fixed, nearest) {
        section.summary.push(format!(
            "Photons gathered within a fixed radius turn the edge of a shaft into a ramp that rises from 10 to 90 % \
             over {} radii; the 100 nearest photons make it {} times the radius that holds 100 of them in full light, \
             since the ball grows where light is missing; theory said {:.3} and {:.3} before the run.",
            text(&by_scale(fixed)),
            text(&by_scale(nearest)),
            fixed.theory.rise_probed / fixed.case.scale(),
            nearest.theory.rise_probed / nearest.case.scale()
        ));
    }
    let scored: Vec<f64> = results
        .iter()
        .flat_map(|r| {
            (0..r.profile.len()).filter(|&i| r.photons(i) >= ENOUGH).map(|i| {
                let mean = r.mean(i);
                let (value, error) = r.theory.profile[i];
                (mean.mean() - value) / libm::hypot(mean.std_error(), error)
            })
        })
        .chain(transfers.iter().map(|t| {
            let contrast: Moments = t.maps.iter().collect();
            (contrast.mean() - t.predicted) / contrast.std_error()
        }))
        .collect();
    let squares: f64 = scored.iter().map(|z| z * z).sum();
    section.summary.push(format!(
        "{} places of profiles and contrasts were predicted and measured; what is left has a root mean square of {:.2} \
         standard errors (expected: 1) and is at most {:.1}.",
        scored.len(),
        (squares / scored.len().max(1) as f64).sqrt(),
        scored.iter().map(|z| z.abs()).fold(0.0, f64::max)
    ));
    let off = |r: &CaseResult| (r.theory.rise_probed / r.theory.rise - 1.0).abs();
    section.notes.push(format!(
        "Widths are read off the mean profile of all maps through its probes, a tenth of a radius apart (k nearest: \
         three twentieths), by a monotone interpolant; the prediction is the same number read off the expected \
         profile. It differs from the exact width by {:.2} % at most.",
        percent(results.iter().map(off).fold(0.0, f64::max))
    ));
    section.notes.push(format!(
        "All gathers end at {CAP} mean free paths, so that no ball touches a face or another edge; under-full gathers are \
         part of the prediction. The laws assume a Poisson number of photons, and maps have a fixed one: that is a \
         part in the number of photons ({} at least), below a tenth of the standard errors.",
        results.iter().map(|r| r.case.photons).min().unwrap_or(0)
    ));
    section.notes.push(
        "Places and gathers of one number of photons share their maps: their hundreds of numbers hold about as much as \
         five independent ones, so that the root mean square of what is left may well be 0.6 or 1.4."
            .to_string(),
    );
    section.notes.push(format!(
        "Places whose probes rest on fewer than {ENOUGH} photons a map, far outside the edge, are measured and drawn but \
         not in the study's error budget, since their distribution is skewed. Photons are emitted over {} × {} mean free \
         paths.",
        shaft::WIDTH,
        shaft::LENGTH
    ));
}

fn headlines(results: &[CaseResult]) -> Vec<Headline> {
    let of = |(name, size, over): (&str, Size, &str)| {
        let found = find(results, size, Kernel::Uniform)?;
        let text = format!("10-90 width of the edge of a shaft over the {over}");
        Some(Headline::new(name, &text, Unit::ONE, found.rise.times(1.0 / found.case.scale())))
    };
    let sizes = [
        ("Radius", Size::Radius(0.2), "radius of the gather"),
        ("Nearest", Size::Nearest(100), "radius that holds 100 photons in full light, 100 nearest"),
    ];
    sizes.into_iter().filter_map(of).collect()
}
