//! What all cases of a study say together.

use super::figures;
use super::largest::{Largest, Null};
use super::sets::{Drawn, Group, fit, groups};
use crate::harness::{Claim, Entry, FIT_LEVEL, Section, SectionReport, Settings, Table, Term, number};
use turbid::stats::{KolmogorovSmirnov, Moments};

/// Fewest map sets for the test of their distribution to mean anything.
const FEWEST_SETS: usize = 64;
/// Resamples of all maps: the bound that one in a thousand exceeds stands between five of them.
const RESAMPLES: usize = 5000;

/// The two tests, with one term taken away or none.
struct Tests {
    without: Option<Term>,
    /// Cases that the term is part of; all of them without one.
    cases: usize,
    fit: KolmogorovSmirnov,
    largest: Largest,
}

impl Tests {
    fn new(groups: &[Group], drawn: &[Drawn], null: &Null, without: Option<Term>) -> Self {
        let has = |entry: &&&Entry| without.is_none_or(|term| entry.terms[term as usize] != 0.0);
        Tests {
            without,
            cases: groups.iter().flat_map(|g| &g.entries).filter(has).count(),
            fit: fit(drawn, without),
            largest: null.largest(groups, without),
        }
    }

    /// The p-value of both together: twice the smaller.
    fn p(&self) -> f64 {
        (2.0 * self.fit.p.min(self.largest.p)).min(1.0)
    }
}

/// Concludes; a study without enough cases gets a line that says so.
pub fn conclude(settings: &Settings, sections: &[SectionReport]) -> anyhow::Result<Section> {
    let left_out = |why: &str| Section { summary: vec![format!("Left out: {why}.")], ..Section::default() };
    if !settings.only.is_empty() {
        return Ok(left_out("only some of the experiments were run"));
    }
    let entries: Vec<&Entry> = sections.iter().flat_map(|s| &s.section.budget).collect();
    let (groups, dropped) = groups(entries.iter().copied())?;
    let drawn = Drawn::all(&groups, settings.seed);
    if drawn.len() < FEWEST_SETS {
        return Ok(left_out(&format!(
            "{} independent sets of maps; the test of their distribution needs {FEWEST_SETS}",
            drawn.len()
        )));
    }
    let null = Null::new(&groups, settings.seed, RESAMPLES);
    let whole = Tests::new(&groups, &drawn, &null, None);
    let parts: Vec<Tests> = Term::ALL
        .iter()
        .map(|&term| Tests::new(&groups, &drawn, &null, Some(term)))
        .filter(|tests| tests.cases > 0)
        .collect();
    let kept: Vec<&Entry> = groups.iter().flat_map(|g| g.entries.iter().copied()).collect();
    let z: Vec<f64> = drawn.iter().map(|d| deviation(d.uniform(None))).collect();
    Ok(Section {
        summary: summary(&kept, groups.len(), drawn.len(), &whole, &parts, &null),
        claims: claims(&whole, &parts),
        figures: vec![figures::sum(&kept, &z)?],
        tables: vec![table(&whole, &parts, &null)],
        notes: notes(&kept, dropped),
        ..Section::default()
    })
}

/// The normal number below which a share of 0 to 1 lies.
fn deviation(share: f64) -> f64 {
    let tail = share.min(1.0 - share).max(f64::MIN_POSITIVE);
    let size = if tail >= 0.5 { 0.0 } else { turbid::stats::normal_critical(2.0 * tail) };
    if share < 0.5 { -size } else { size }
}

fn claims(whole: &Tests, parts: &[Tests]) -> Vec<Claim> {
    let mut claims = vec![
        Claim::fits(
            "sets",
            "one case a map set: what the sum of the terms leaves over follows Student's t, p of Kolmogorov and Smirnov",
            whole.fit.p,
        ),
        Claim::fits(
            "largest",
            "all cases: the largest |z| is no larger than chance makes it, p by resampling whole maps",
            whole.largest.p,
        ),
    ];
    for part in parts {
        let Some(term) = part.without else { continue };
        let id = format!("without-{}", term.name().replace(' ', "-"));
        let text =
            format!("wrong on purpose, the term {} taken away: p of the two tests together", term.name());
        claims.push(Claim::refused(&id, &text, part.p()));
    }
    claims
}

fn summary(
    entries: &[&Entry],
    groups: usize,
    sets: usize,
    whole: &Tests,
    parts: &[Tests],
    null: &Null,
) -> Vec<String> {
    let is_good = whole.fit.p > FIT_LEVEL && whole.largest.p > FIT_LEVEL;
    let seen = parts.iter().filter(|p| p.p() <= FIT_LEVEL).count();
    vec![
        format!(
            "{}: over {} cases, the largest distance between measured and predicted error is {} standard errors, \
             where chance stays below {:.1} in 999 studies of 1,000.",
            if is_good {
                "The predicted terms add up to the measured errors"
            } else {
                "The predicted terms do not add up to the measured errors"
            },
            entries.len(),
            sizes(&whole.largest),
            null.bound(FIT_LEVEL)
        ),
        format!(
            "The maps of {groups} groups make {sets} independent sets of up to 32 maps. One case was drawn for each, \
             and what its prediction leaves over compared with Student's t: p = {} (Kolmogorov and Smirnov). Of the {} \
             terms that the predictions have, {seen} make one of the two tests fail when they are taken away.",
            number(whole.fit.p),
            parts.len()
        ),
    ]
}

fn sizes(largest: &Largest) -> String {
    let z = largest.z();
    if z.is_finite() { format!("{z:.1}") } else { "more than 37".to_string() }
}

fn table(whole: &Tests, parts: &[Tests], null: &Null) -> Table {
    let row = |tests: &Tests| {
        vec![
            tests.without.map_or("none", Term::name).to_string(),
            tests.cases.to_string(),
            p_text(tests.fit.p),
            sizes(&tests.largest),
            p_text(tests.largest.p),
            tests.largest.case.clone(),
        ]
    };
    Table {
        caption: format!(
            "The two tests with all terms, and with one term after the other taken away. Distances are given as \
             normal deviations of the same probability; the largest exceeds {:.2} by chance once in a thousand studies \
             (and {:.2} once in twenty), by resampling whole maps {RESAMPLES} times. The case named is the one \
             farthest from its prediction.",
            null.bound(FIT_LEVEL),
            null.bound(0.05)
        ),
        columns: ["taken away", "cases with it", "p, one case a set", "largest |z|", "its p", "where"]
            .map(String::from)
            .to_vec(),
        rows: std::iter::once(whole).chain(parts).map(row).collect(),
    }
}

fn p_text(p: f64) -> String {
    if p < 1e-12 { "below 10⁻¹²".to_string() } else { number(format!("{p:.1e}").parse().unwrap_or(p)) }
}

fn notes(entries: &[&Entry], dropped: usize) -> Vec<String> {
    let loose = entries.iter().filter(|e| {
        let m: Moments = e.maps.iter().collect();
        e.error > 0.1 * m.std_error()
    });
    vec![
        format!(
            "The bound on the numerical error of a prediction is added to the standard error in quadrature. It is above a \
             tenth of it in {} of the {} cases.",
            loose.count(),
            entries.len()
        ),
        format!(
            "{dropped} further cases are left out, since a few of their maps carry the variance or there are fewer than \
             16 maps: their means have no trustworthy error."
        ),
        "The largest |z| is compared with what it is when every map is taken from the mean of its case and whole maps \
         are drawn with replacement, all cases of a group together, each with its standard error from the maps drawn. \
         Both tests refuse right predictions once in a thousand studies each."
            .to_string(),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::sets::tests::made_up;
    use super::*;
    use crate::harness::{Experiment, Kind, Verdict, judge};

    fn report(entries: Vec<Entry>) -> SectionReport {
        SectionReport {
            experiment: Experiment {
                name: "made-up",
                title: "",
                question: "",
                cells: |_| Vec::new(),
                predict: |_| Ok(Vec::new()),
                measure: |_, _| anyhow::bail!("none"),
                conclude: |_, _, _| Ok(Section::default()),
            },
            predictions: Vec::new(),
            section: Section { budget: entries, ..Section::default() },
            judged: Vec::new(),
            counters: Vec::new(),
            cells: (0, 0.0),
        }
    }

    fn verdicts(bias: f64) -> Vec<(String, Verdict)> {
        let entries = made_up(4, &[(2048, 10), (640, 5)], bias);
        let section = conclude(&Settings::new("unused"), &[report(entries)]).unwrap();
        assert!(matches!(section.claims[0].kind, Kind::Fits) && section.figures.len() == 1);
        judge(section.claims).into_iter().map(|j| (j.claim.id, j.verdict)).collect()
    }

    /// Nothing left over is upheld, with each term that is there needed; 1 % left over is rejected.
    #[test]
    fn the_verdicts_of_made_up_studies() {
        let upheld = ["sets", "largest", "without-blur", "without-edge"];
        assert_eq!(verdicts(0.0), upheld.map(|id| (id.to_string(), Verdict::Upheld)));
        assert_eq!(verdicts(0.01)[0].1, Verdict::Rejected);
        assert_eq!(verdicts(0.01)[1].1, Verdict::Rejected);
    }

    #[test]
    fn left_out_with_a_line() {
        let line = |settings: &Settings, entries| {
            let section = conclude(settings, &[report(entries)]).unwrap();
            assert!(section.claims.is_empty());
            section.summary[0].clone()
        };
        let settings = Settings::new("unused");
        let some = Settings { only: vec!["a".to_string()], ..settings.clone() };
        assert!(line(&some, made_up(1, &[(2048, 2)], 0.0)).contains("only some"));
        assert!(line(&settings, made_up(1, &[(64, 2)], 0.0)).contains("2 independent sets"));
        assert!(line(&settings, Vec::new()).contains("0 independent sets"));
    }

    #[test]
    fn deviations_of_shares() {
        for (share, z) in [(0.5, 0.0), (0.975, 1.959_963_984_540_054), (0.025, -1.959_963_984_540_054)] {
            assert!((deviation(share) - z).abs() < 1e-9);
        }
        assert!(deviation(1.0) > 30.0 && deviation(0.0) < -30.0);
    }
}
