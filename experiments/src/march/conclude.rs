//! What all maps together say.

use super::cases::{COSINES, Case, RADIUS, photons, rule_name};
use super::figures;
use super::measure::GROUP;
use super::predict::TERMS;
use super::results::CaseResult;
use crate::harness::{
    Cells, Claim, Estimate, Headline, LEFT_OVER, PREDICTED, Row, Section, Settings, Table, Unit, percent,
    percent_with_error, signed,
};
use crate::prediction::{Compared, PredictedError, Prediction, Predictions, Term, amplitude};
use crate::setups::Size;
use turbid::integrators::StepRule;

/// Concludes.
pub fn conclude(settings: &Settings, predictions: &[Prediction], cells: &Cells) -> anyhow::Result<Section> {
    let known = Predictions::new(predictions);
    let mut results = Vec::new();
    for case in Case::all() {
        let name = case.name();
        let expected = PredictedError::read(&known, &name, "radiance", &TERMS)?;
        results.push(Compared::new(case, &name, "radiance", expected, cells)?);
    }
    Ok(Section {
        summary: summary(&results),
        claims: claims(&results),
        figures: vec![figures::steps(&results)?],
        tables: vec![table(&results)],
        notes: notes(settings),
        rows: rows(cells, &results)?,
        budget: results.iter().map(|r| r.entry(format!("march-{GROUP}"), &r.case.name())).collect(),
        headlines: headlines(&results),
        ..Section::default()
    })
}

/// The case along `mu` at this step and rule, at the usual radius.
fn find(results: &[CaseResult], mu: f64, step: f64, rule: StepRule) -> Option<&CaseResult> {
    results.iter().find(|r| r.case == Case { mu, step, rule, size: Size::Radius(RADIUS) })
}

fn claims(results: &[CaseResult]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for rule in StepRule::ALL {
        let chosen: Vec<&CaseResult> = results
            .iter()
            .filter(|r| r.case.rule == rule && matches!(r.case.size, Size::Radius(_)))
            .collect();
        if let Some(amplitude) = amplitude(&chosen, CaseResult::predicted) {
            let name = rule_name(rule);
            let text = format!(
                "steps by the rule \"{name}\", all rays, steps and radii: measured over predicted error"
            );
            claims.push(Claim::about(&format!("rule-{name}"), &text, Unit::ONE, amplitude, 1.0, PREDICTED));
        }
    }
    if let Some(coarse) = find(results, 0.5, 1.0, StepRule::NearEnd) {
        let text = "the formula of 1998 in steps of one mean free path, along the ray of mu = 0.5: error";
        claims.push(Claim::detected("1998", text, Unit::FRACTION, Estimate::mean(&coarse.error), 0.0, 0.05));
    }
    // The same sum with each step attenuated through all of itself: every weight smaller by e^-dx.
    let step = 0.2;
    if let Some(near) = find(results, 1.0, step, StepRule::NearEnd) {
        let wrong = |e: f64| (1.0 + e) * libm::exp(-step) - 1.0;
        let errors: Vec<f64> = near.errors.iter().map(|&e| wrong(e)).collect();
        let text = "wrong on purpose, steps of 0.2 that are attenuated through all of themselves: error";
        let statistic = Estimate::mean(&errors.iter().collect());
        // Wrong by what was predicted of it: 14 % below the right way of the same steps.
        let centre = wrong(near.predicted());
        claims.push(Claim::about(
            "attenuated-twice",
            text,
            Unit::FRACTION,
            statistic,
            centre,
            2.0 * LEFT_OVER,
        ));
    }
    claims
}

fn rows(cells: &Cells, results: &[CaseResult]) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for result in results {
        rows.extend(result.rows(
            &result.case.name(),
            ("radiance", Unit::RADIANCE),
            result.case.parameters(),
            cells,
        )?);
    }
    Ok(rows)
}

fn table(results: &[CaseResult]) -> Table {
    let columns = [
        "ray",
        "step",
        "gather",
        "rule",
        "measured error",
        "predicted",
        "step's part",
        "edge",
        "blur",
        "clusters",
    ];
    let part = |x: f64| if x.abs() < 5e-5 { "0".to_string() } else { signed(percent(x), 2) };
    let row = |r: &CaseResult| {
        let mut cells = vec![
            format!("mu {}", r.case.mu),
            r.case.step.to_string(),
            r.case.size.title(),
            rule_name(r.case.rule).to_string(),
            percent_with_error(&r.error),
            part(r.predicted()),
        ];
        cells.extend(TERMS.map(|term| part(r.expected.of(term))));
        cells
    };
    let shown = |r: &&CaseResult| r.case.size != Size::Radius(RADIUS) || r.case.mu == 1.0;
    Table {
        caption: "Signed error of the radiance that leaves the lit face, in per cent of the exact value, with its \
                  standard error over maps, beside what was predicted and its parts; steps and radii in mean free \
                  paths, mu the cosine with the normal. Slant rays at radius 0.2 are in the figure and in results.csv."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: results.iter().filter(shown).map(row).collect(),
    }
}

fn summary(results: &[CaseResult]) -> Vec<String> {
    let mut summary = Vec::new();
    let words = |r: &CaseResult| {
        format!("{} % (predicted {} %)", percent_with_error(&r.error), signed(percent(r.predicted()), 2))
    };
    let at = |step, rule| find(results, 1.0, step, rule);
    if let (Some(old), Some(new)) = (at(0.2, StepRule::NearEnd), at(0.2, StepRule::Integrated)) {
        summary.push(format!(
            "Fog of albedo 0.9, marched in steps of 0.2 mean free paths, is {} % too bright by the formula of 1998 where the \
             light in it is exactly known, and {} % high with the exponential integrated over each step; through a \
             photon map the errors are {} and {}, since the map loses light at the face.",
            signed(percent(old.expected.of(Term::Step)), 1),
            signed(percent(new.expected.of(Term::Step)), 1),
            words(old),
            words(new)
        ));
        summary.push(format!(
            "The formula of 1998 looks better than it is. It weights the source at the near end of each step by the whole \
             step, too much by half a step at first; but the first of these points stands on the face, where half of \
             each ball is empty ({} %), and a first value halved is the trapezoidal rule. Once the face is treated, \
             the excess of {} % is left.",
            signed(percent(old.expected.of(Term::Edge)), 1),
            signed(percent(old.expected.of(Term::Step)), 1)
        ));
    }
    let worst = COSINES.iter().filter_map(|&mu| find(results, mu, 1.0, StepRule::NearEnd));
    let list: Vec<String> = worst.map(|r| format!("{} at mu = {}", words(r), r.case.mu)).collect();
    summary.push(format!("In steps of one mean free path the formula of 1998 errs by {}.", list.join(", ")));
    summary
}

fn notes(settings: &Settings) -> Vec<String> {
    vec![
        format!(
            "Maps of {} photons; uniform kernel. The direct light is in the map too, as collisions of order 0: what \
             is marched is all of the scattered radiance.",
            photons(settings)
        ),
        "All steps of this study divide the path through the slab. Where clusters raise the estimate with the k \
         nearest photons at a face, neighbours are taken to be missing like the ball's own part."
            .to_string(),
    ]
}

fn headlines(results: &[CaseResult]) -> Vec<Headline> {
    let of = |(name, rule, how): (&str, StepRule, &str)| {
        let found = find(results, 0.5, 1.0, rule)?;
        let text = format!("error of radiance marched in steps of one mean free path at mu = 0.5, {how}");
        Some(Headline::new(name, &text, Unit::FRACTION, Estimate::mean(&found.error)))
    };
    let rules = [
        ("Formula", StepRule::NearEnd, "by the formula of 1998"),
        ("Integrated", StepRule::Integrated, "the exponential integrated over each step"),
    ];
    rules.into_iter().filter_map(of).collect()
}
