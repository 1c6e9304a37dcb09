//! What all cases of a study say together.

use super::common::{Common, Left};
use super::figures;
use super::largest::{Largest, Null};
use super::sets::{Drawn, Group, MOST, carries, fit, groups};
use crate::harness::{
    Claim, Digest, Estimate, FIT_LEVEL, Headline, Section, SectionReport, Settings, Table, Unit, number,
    percent, with_error,
};
use crate::prediction::{Entry, Term};
use turbid::rng::{Purpose, Stream};
use turbid::stats::{KolmogorovSmirnov, Moments, kolmogorov_smirnov_test, normal_critical, normal_p};
use turbid::transport::in_parallel;

/// Fewest cases for a verdict.
const FEWEST_CASES: usize = 1000;
/// Fewest independent map sets for a verdict.
const FEWEST_SETS: usize = 200;
/// Resamples of all maps: the bound that one in a thousand exceeds stands between five of them.
const RESAMPLES: usize = 5000;

/// Made-up studies by which the smallest shift is found that the test of map sets detects.
const SHIFTED: usize = 400;
/// How sure a shift must be detected to count as detected.
const POWER: f64 = 0.99;

/// The two tests, with one term taken away or none.
struct Tests {
    without: Option<Term>,
    /// Cases that the term is part of; all of them without one.
    cases: usize,
    /// Map sets with such a case, one drawn for each.
    sets: usize,
    fit: KolmogorovSmirnov,
    largest: Largest,
}

impl Tests {
    fn new(groups: &[Group], drawn: &[Drawn], null: &Null, without: Option<Term>) -> Self {
        Tests {
            without,
            cases: groups.iter().flat_map(|g| &g.entries).filter(|e| carries(e, without)).count(),
            sets: drawn.len(),
            fit: fit(drawn, without),
            largest: null.largest(groups, without),
        }
    }

    /// Which of the tests refuse, in words.
    fn seen_by(&self) -> &'static str {
        match (self.fit.p <= FIT_LEVEL, self.largest.p <= FIT_LEVEL) {
            (true, true) => "both",
            (true, false) => "map sets",
            (false, true) => "largest",
            (false, false) => "neither",
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
    let drawn = Drawn::all(&groups, settings.seed, None);
    let cases: usize = groups.iter().map(|g| g.entries.len()).sum();
    if cases < FEWEST_CASES || drawn.len() < FEWEST_SETS {
        return Ok(left_out(&format!(
            "{cases} cases in {} independent sets of maps are too few for a verdict, which needs {FEWEST_CASES} and \
             {FEWEST_SETS}",
            drawn.len()
        )));
    }
    let null = Null::new(&groups, settings.seed, RESAMPLES);
    let whole = Tests::new(&groups, &drawn, &null, None);
    let common = Common::new(&groups);
    let mut parts = Vec::new();
    for term in Term::ALL.map(Some) {
        let own = Drawn::all(&groups, settings.seed, term);
        if !own.is_empty() {
            parts.push(Tests::new(&groups, &own, &null, term));
        }
    }
    let shift = smallest_shift(drawn.len(), settings.seed);
    let kept: Vec<&Entry> = groups.iter().flat_map(|g| g.entries.iter().copied()).collect();
    let z: Vec<f64> = drawn.iter().map(|d| deviation(d.uniform(None))).collect();
    Ok(Section {
        summary: summary(&kept, groups.len(), &whole, &common, &parts, &null, shift),
        claims: claims(&whole, &common, &parts),
        figures: vec![figures::sum(&kept, groups.len(), &z)?],
        tables: vec![table(groups.len(), &whole, &parts, &null), group_table(&common)],
        notes: notes(&kept, dropped, sections),
        headlines: vec![Headline::new(
            "Cases",
            "cases whose error is predicted term by term",
            Unit::ONE,
            Estimate::exact(kept.len() as f64, 0.0),
        )],
        ..Section::default()
    })
}

/// The normal number below which a share of 0 to 1 lies.
fn deviation(share: f64) -> f64 {
    let tail = share.min(1.0 - share).max(f64::MIN_POSITIVE);
    let size = if tail >= 0.5 { 0.0 } else { normal_critical(2.0 * tail) };
    if share < 0.5 { -size } else { size }
}

/// The shift of all distances, in standard errors of one set, with which the test of map sets refuses in 99 of 100
/// studies: normal numbers of as many sets, shifted.
fn smallest_shift(sets: usize, seed: u64) -> f64 {
    let one = |study: usize| {
        let word = Digest::of(b"budget/shift").word();
        let mut stream = Stream::new(seed, Purpose::Resampling, word, study as u64);
        let z: Vec<f64> = (0..sets).map(|_| deviation(stream.open_unit())).collect();
        let p = |shift: f64| kolmogorov_smirnov_test(&z, |z| below(z + shift)).p;
        // The least shift that this study refuses, to 1e-3: beyond 4 it always does with as many sets as are asked for.
        let (mut low, mut high) = (0.0, 4.0);
        while high - low > 1e-3 {
            let middle = 0.5 * (low + high);
            if p(middle) > FIT_LEVEL {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    };
    let mut shifts = in_parallel(SHIFTED, one);
    shifts.sort_by(f64::total_cmp);
    shifts[((POWER * SHIFTED as f64) as usize).min(shifts.len() - 1)]
}

/// The share of a normal number below a value.
fn below(z: f64) -> f64 {
    let tail = 0.5 * normal_p(z);
    if z < 0.0 { tail } else { 1.0 - tail }
}

fn claims(whole: &Tests, common: &Common, parts: &[Tests]) -> Vec<Claim> {
    let mut claims = vec![
        Claim::fits(
            "sets",
            "one case a map set: what the sum of the terms leaves over follows Student's t, p of Kolmogorov and Smirnov",
            whole.fit.p,
        ),
        Claim::fits(
            "common",
            "all cases summed, weighted by what they know: nothing is left over in all of them alike, p",
            common.p_all,
        ),
        Claim::fits(
            "groups",
            "the cases of each group summed: nothing is left over in the groups, to either side, p of chi squared",
            common.p_groups,
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
    whole: &Tests,
    common: &Common,
    parts: &[Tests],
    null: &Null,
    shift: f64,
) -> Vec<String> {
    let is_good =
        [whole.fit.p, common.p_all, common.p_groups, whole.largest.p].into_iter().all(|p| p > FIT_LEVEL);
    let sets = whole.sets;
    let seen = |by: &str| {
        let names: Vec<&str> =
            parts.iter().filter(|p| p.seen_by() == by).filter_map(|p| p.without).map(Term::name).collect();
        if names.is_empty() { "none".to_string() } else { names.join(", ") }
    };
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
            "The maps of {groups} groups, which share nothing, are cut into {sets} independent sets of at most {MOST}. \
             One case was drawn for each set, and what its prediction leaves over compared with Student's t: p = {} \
             (Kolmogorov and Smirnov).",
            number(whole.fit.p)
        ),
        format!(
            "Summed over all cases, each weighted by what it knows, {} % of the exact values is left over \
             (p = {}). Summed over the cases of one group, the {groups} groups are off to either side as far as chance has it \
             with p = {} (chi squared): the middle one is known to {} %.",
            in_per_cent(common.all),
            p_text(common.p_all),
            p_text(common.p_groups),
            number(rounded(percent(common.middle_error())))
        ),
        format!(
            "Each term was taken away in turn, and asked of the cases that carry it. Seen by both tests: {}; by the \
             map sets alone: {}; by the largest distance alone: {}; by neither: {}.",
            seen("both"),
            seen("map sets"),
            seen("largest"),
            seen("neither")
        ),
        format!(
            "The smallest fault that is detected with a probability of {} %: by the map sets, a bias of {shift:.2} standard \
             errors of one set in all cases alike; by the sum of all cases, a bias of {} % in all alike; by the largest \
             distance, a bias of {:.1} standard errors, over all of its maps, in a single case.",
            percent(POWER),
            number(rounded(percent(common.all.error * (normal_critical(FIT_LEVEL) + deviation(POWER))))),
            null.bound(FIT_LEVEL) + deviation(POWER)
        ),
    ]
}

/// The groups farthest off.
fn group_table(common: &Common) -> Table {
    const ROWS: usize = 10;
    let row = |(name, left, p): &(&str, Left, f64)| {
        vec![name.to_string(), in_per_cent(*left), format!("{:.1}", left.distance()), p_text(*p)]
    };
    Table {
        caption: format!(
            "What is left over in a group, its cases summed map by map, in per cent of the exact values with its standard \
             error: the {ROWS} farthest off of {}, of which the smallest p is 1/{} by chance.",
            common.groups.len(),
            common.groups.len()
        ),
        columns: ["group", "left over, %", "standard errors", "p by itself"].map(String::from).to_vec(),
        rows: common.groups.iter().take(ROWS).map(row).collect(),
    }
}

/// Two digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// In per cent with its standard error.
fn in_per_cent(left: Left) -> String {
    with_error(percent(left.mean), percent(left.error))
}

fn sizes(largest: &Largest) -> String {
    let z = largest.z();
    if z.is_finite() { format!("{z:.1}") } else { "more than 37".to_string() }
}

fn table(groups: usize, whole: &Tests, parts: &[Tests], null: &Null) -> Table {
    let row = |tests: &Tests| {
        vec![
            tests.without.map_or("none", Term::name).to_string(),
            tests.cases.to_string(),
            tests.sets.to_string(),
            p_text(tests.fit.p),
            sizes(&tests.largest),
            p_text(tests.largest.p),
            tests.without.map_or("", |_| tests.seen_by()).to_string(),
            tests.largest.case.clone(),
        ]
    };
    Table {
        caption: format!(
            "The two tests with all terms, and with one term after the other taken away. The maps of {groups} \
             groups are cut into {} independent sets of at most {MOST}, and one case is drawn for each set: with a term \
             taken away, among the cases that carry it. Distances are given as normal deviations of the same probability; the largest exceeds {:.2} by chance once in a thousand studies \
             (and {:.2} once in twenty), by resampling whole maps {RESAMPLES} times. The case named is the one \
             farthest from its prediction.",
            whole.sets,
            null.bound(FIT_LEVEL),
            null.bound(0.05)
        ),
        columns: [
            "taken away",
            "cases with it",
            "sets with it",
            "p, one case a set",
            "largest |z|",
            "its p",
            "seen by",
            "where",
        ]
        .map(String::from)
        .to_vec(),
        rows: std::iter::once(whole).chain(parts).map(row).collect(),
    }
}

fn p_text(p: f64) -> String {
    if p < 1e-12 { "below 10⁻¹²".to_string() } else { number(rounded(p)) }
}

fn notes(entries: &[&Entry], dropped: usize, sections: &[SectionReport]) -> Vec<String> {
    let loose = entries.iter().filter(|e| {
        let m: Moments = e.maps.iter().collect();
        e.error > 0.1 * m.std_error()
    });
    let by_rule: Vec<String> = sections
        .iter()
        .filter(|s| s.section.left_out > 0)
        .map(|s| format!("{} of {}", s.section.left_out, s.experiment.name))
        .collect();
    vec![
        format!(
            "The bound on the numerical error of a prediction is added to the standard error in quadrature. It is above a \
             tenth of it in {} of the {} cases.",
            loose.count(),
            entries.len()
        ),
        format!(
            "Rules of the experiments' own, which look at predictions alone, keep cases out: {}. They are those of which \
             too little is predicted for a test, of too few photons for a mean to be nearly normal, or that repeat \
             others' numbers; each experiment says which.",
            if by_rule.is_empty() { "none".to_string() } else { by_rule.join(", ") }
        ),
        format!(
            "{dropped} further cases are left out here, since a few of their maps carry the variance or there are fewer than \
             16 maps: their means have no trustworthy error."
        ),
        "The largest |z| is compared with what it is when every map is taken from the mean of its case and whole maps \
         are drawn with replacement, all cases of a group together, each with its standard error from the maps drawn. \
         Each test refuses right predictions once in a thousand studies."
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
                groups: |_| Vec::new(),
                predict: |_| Ok(Vec::new()),
                conclude: |_, _, _| Ok(Section::default()),
            },
            predictions: Vec::new(),
            section: Section { budget: entries, ..Section::default() },
            judged: Vec::new(),
            counters: Vec::new(),
            cells: (0, 0.0),
            failure: None,
        }
    }

    /// 1,004 cases in 300 sets.
    fn shape() -> Vec<(usize, usize)> {
        let mut shape = vec![(64, 10); 100];
        shape.push((3200, 4));
        shape
    }

    fn verdicts(bias: f64) -> Vec<(String, Verdict)> {
        let entries = made_up(4, &shape(), bias);
        let section = conclude(&Settings::new("unused"), &[report(entries)]).unwrap();
        assert!(matches!(section.claims[0].kind, Kind::Fits) && section.figures.len() == 1);
        judge(section.claims, 100).into_iter().map(|j| (j.claim.id, j.verdict)).collect()
    }

    /// Nothing left over is upheld, with each term that is there needed; 1 % left over is rejected.
    #[test]
    fn the_verdicts_of_made_up_studies() {
        let upheld = ["sets", "common", "groups", "largest", "without-blur", "without-edge"];
        assert_eq!(verdicts(0.0), upheld.map(|id| (id.to_string(), Verdict::Upheld)));
        assert!(verdicts(0.01)[..4].iter().all(|v| v.1 == Verdict::Rejected));
    }

    /// Kolmogorov's distance at 1e-3 is 1.95 / sqrt(n); a shift moves the middle by 0.4 of itself, and 2.3 deviations of
    /// the share there, 0.5 / sqrt(n) each, come on top: 3.1 / sqrt(n) / 0.4, a little less since the largest counts.
    #[test]
    fn the_smallest_shift_that_is_seen() {
        let shift = smallest_shift(240, 1);
        assert!((0.35..0.52).contains(&shift), "{shift}");
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
        assert!(
            line(&settings, made_up(1, &[(64, 2)], 0.0)).contains("2 independent sets of maps are too few")
        );
        assert!(line(&settings, Vec::new()).contains("0 cases in 0 independent sets"));
    }

    #[test]
    fn deviations_of_shares() {
        for (share, z) in [(0.5, 0.0), (0.975, 1.959_963_984_540_054), (0.025, -1.959_963_984_540_054)] {
            assert!((deviation(share) - z).abs() < 1e-9);
        }
        assert!(deviation(1.0) > 30.0 && deviation(0.0) < -30.0);
    }
}
