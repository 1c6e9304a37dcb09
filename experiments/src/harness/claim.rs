//! Claims and verdicts.

use super::format::{number, with_error};
use super::{Estimate, Unit};
use turbid::stats::{Interval, POWER_QUANTILE, holm, student_critical};

/// Probability that a study rejects, upholds or detects anything wrongly, over all of its claims.
pub const FAMILY_WISE: f64 = 1e-3;

/// Fewest maps for a verdict: with fewer, the tails of t are too wide to see anything and too sensitive to the shape
/// of the maps' distribution.
pub const MIN_MAPS: u64 = 64;

/// What a claim says of its statistic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The truth lies within the margin; an end may be infinite.
    Within(Interval),
    /// The truth differs from `from` by at least `by`: a planted fault is detected.
    Differs {
        /// The value of the right method.
        from: f64,
        /// The smallest difference that counts.
        by: f64,
    },
    /// The statistic is the p-value of a test of fit, and the test does not refuse at [`FIT_LEVEL`]. To uphold it is
    /// to say no more than that: what the test can detect, claims of the next kind say.
    Fits,
    /// The statistic is the p-value of a test of fit that something wrong is put to, and the test refuses.
    Refused,
}

/// The p-value at which a test of fit refuses.
pub const FIT_LEVEL: f64 = FAMILY_WISE;

/// How far a predicted error may lie from the measured one and still guide a choice of settings: a twentieth.
///
/// Claims ask what somebody who chooses settings would act on, alike for all of a kind. Which of them the default preset
/// can decide (a half-margin of seven standard errors or more) was read from the standard errors of its run with seed 1,
/// version 0.1.0; what it cannot is a reported number without a verdict.
pub const PREDICTED: f64 = 0.05;
/// The same of widths, losses at faces and contrasts, which geometry alone sets.
pub const GEOMETRIC: f64 = 0.02;
/// How large an error that nothing predicted, or an unbiased method's, may be, as a fraction of the exact value: a sixth of
/// the smallest error that the study prices at its default size, 3 per cent.
pub const LEFT_OVER: f64 = 0.005;

/// When what a claim demands was fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Before its statistic was looked at.
    Stated,
    /// Its margin, statistic or range was chosen after a look at its outcome with these seeds, which cannot judge it.
    ChosenAfter {
        /// What was chosen.
        what: &'static str,
        /// The seeds.
        seeds: &'static [u64],
    },
}

impl Basis {
    /// What was chosen after which seeds; empty of what was stated before.
    pub fn words(self) -> String {
        let Basis::ChosenAfter { what, seeds } = self else { return String::new() };
        let list: Vec<String> = seeds.iter().map(u64::to_string).collect();
        format!("{what} chosen after seed{} {}", if seeds.len() > 1 { "s" } else { "" }, list.join(", "))
    }
}

/// One statement that a study can uphold or reject.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Short file-safe name, unique within the experiment.
    pub id: String,
    /// The statement, a sentence without its numbers' outcome.
    pub text: String,
    /// Unit of the statistic.
    pub unit: Unit,
    /// What it is judged by.
    pub statistic: Estimate,
    /// What it says.
    pub kind: Kind,
    /// When that was fixed.
    pub basis: Basis,
}

impl Claim {
    /// The truth lies from `low` to `high`.
    pub fn within(id: &str, text: &str, unit: Unit, statistic: Estimate, low: f64, high: f64) -> Self {
        Claim::new(id, text, unit, statistic, Kind::Within(Interval::new(low, high)))
    }

    fn new(id: &str, text: &str, unit: Unit, statistic: Estimate, kind: Kind) -> Self {
        Claim { id: id.to_string(), text: text.to_string(), unit, statistic, kind, basis: Basis::Stated }
    }

    /// The truth lies within `margin` of `centre`.
    pub fn about(id: &str, text: &str, unit: Unit, statistic: Estimate, centre: f64, margin: f64) -> Self {
        Claim::within(id, text, unit, statistic, centre - margin, centre + margin)
    }

    /// The same claim, of which `what` was chosen after a look at its outcome with these seeds.
    #[must_use]
    pub fn chosen_after(self, what: &'static str, seeds: &'static [u64]) -> Self {
        Claim { basis: Basis::ChosenAfter { what, seeds }, ..self }
    }

    /// The truth is at most `bound`.
    pub fn at_most(id: &str, text: &str, unit: Unit, statistic: Estimate, bound: f64) -> Self {
        Claim::within(id, text, unit, statistic, f64::NEG_INFINITY, bound)
    }

    /// The truth is at least `bound`.
    pub fn at_least(id: &str, text: &str, unit: Unit, statistic: Estimate, bound: f64) -> Self {
        Claim::within(id, text, unit, statistic, bound, f64::INFINITY)
    }

    /// A planted fault is detected: the truth differs from `from` by `by` or more, as the whole interval says; an interval
    /// that excludes such a difference on both sides rejects the claim.
    pub fn detected(id: &str, text: &str, unit: Unit, statistic: Estimate, from: f64, by: f64) -> Self {
        Claim::new(id, text, unit, statistic, Kind::Differs { from, by: by.abs() })
    }

    /// A test of fit, of which `p` is the p-value, does not refuse.
    pub fn fits(id: &str, text: &str, p: f64) -> Self {
        Claim::new(id, text, Unit::ONE, Estimate::exact(p, 0.0), Kind::Fits)
    }

    /// The same test refuses what is wrong on purpose, significantly after Holm.
    pub fn refused(id: &str, text: &str, p: f64) -> Self {
        Claim { kind: Kind::Refused, ..Claim::fits(id, text, p) }
    }

    /// What the claim demands, in words, with its unit.
    pub fn margin(&self) -> String {
        let shown = |x: f64| number(self.unit.shown(x));
        let with_unit = |x: f64| self.unit.after(&shown(x));
        match self.kind {
            Kind::Within(m) if m.low == f64::NEG_INFINITY => format!("at most {}", with_unit(m.high)),
            Kind::Within(m) if m.high == f64::INFINITY => format!("at least {}", with_unit(m.low)),
            Kind::Within(m) => format!("{} to {}", shown(m.low), with_unit(m.high)),
            Kind::Differs { from, by: 0.0 } => format!("not {}", with_unit(from)),
            Kind::Differs { from, by } => format!("{} or more from {}", with_unit(by), shown(from)),
            Kind::Fits => format!("p above {}", number(FIT_LEVEL)),
            Kind::Refused => format!("p below {} (Holm)", number(FAMILY_WISE)),
        }
    }

    /// Half the width of a margin with two ends, in standard errors: how sharp the claim is. None of other claims.
    pub fn sharpness(&self) -> Option<f64> {
        let Kind::Within(margin) = self.kind else { return None };
        let errors = 0.5 * (margin.high - margin.low) / self.statistic.std_error();
        (self.statistic.maps().is_some() && errors.is_finite()).then_some(errors)
    }

    /// The p-value that decides: for a margin, of the truth lying on its nearest end although the estimate is beyond
    /// (1 inside); for a fault, of there being none.
    fn p(&self) -> f64 {
        let value = self.statistic.value();
        match self.kind {
            Kind::Within(m) if m.contains(value) => 1.0,
            Kind::Within(m) => self.statistic.p(if value < m.low { m.low } else { m.high }),
            Kind::Differs { from, .. } => self.statistic.p(from),
            Kind::Fits if value.is_nan() => 0.0,
            Kind::Refused if value.is_nan() => 1.0,
            Kind::Fits | Kind::Refused => value,
        }
    }

    /// How far the estimate is from where the verdict turns.
    fn distance(&self) -> f64 {
        let value = self.statistic.value();
        match self.kind {
            Kind::Within(m) => (value - m.low).abs().min((value - m.high).abs()),
            Kind::Differs { from, by } => (value - from).abs().max(by),
            Kind::Fits | Kind::Refused => 0.0,
        }
    }
}

/// What the measurement says of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The whole interval lies within the margin; the fault is detected.
    Upheld,
    /// Significantly outside the margin; a fault as large as stated is excluded.
    Rejected,
    /// Neither.
    Undecided,
}

impl Verdict {
    /// The word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Upheld => "upheld",
            Verdict::Rejected => "rejected",
            Verdict::Undecided => "undecided",
        }
    }
}

/// A claim with its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The claim.
    pub claim: Claim,
    /// The interval that the verdict used: simultaneous over all claims of the study.
    pub interval: Interval,
    /// p-value before the adjustment.
    pub p: f64,
    /// p-value after Holm over all claims of the study.
    pub adjusted: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is undecided and what would decide it; empty otherwise.
    pub advice: String,
}

impl Judged {
    /// Statistic, error and unit in one phrase.
    pub fn measured(&self) -> String {
        let (statistic, unit) = (&self.claim.statistic, self.claim.unit);
        // The tails of a p-value are as good as the normal distribution is there: not at all.
        if matches!(self.claim.kind, Kind::Fits | Kind::Refused) && statistic.value() < 1e-12 {
            return "below 10⁻¹²".to_string();
        }
        let text = match statistic.maps() {
            None => number(unit.shown(statistic.value())),
            Some(_) => with_error(unit.shown(statistic.value()), unit.shown(statistic.std_error())),
        };
        unit.after(&text)
    }
}

/// Judges all claims of a study together.
///
/// Rejections (and detections) are significant after Holm at [`FAMILY_WISE`]; intervals have the level 1 -
/// `FAMILY_WISE` / number of claims, so that all hold at once with that probability. A statistic of fewer than
/// [`MIN_MAPS`] maps, or with a heavy tail, decides nothing; nor does a seed that was looked at when the claim was chosen.
pub fn judge(claims: Vec<Claim>, seed: u64) -> Vec<Judged> {
    let share = FAMILY_WISE / claims.len().max(1) as f64;
    // A claim that cannot be decided must not borrow significance from the others.
    let p_values: Vec<f64> =
        claims.iter().map(|c| if obstacle(c, seed).is_some() { 1.0 } else { c.p() }).collect();
    let adjusted = holm(&p_values);
    let judge_one = |((claim, p), adjusted): ((Claim, f64), f64)| {
        let interval = claim.statistic.interval(1.0 - share);
        let (verdict, advice) = match obstacle(&claim, seed) {
            Some(advice) => (Verdict::Undecided, advice),
            None => match decide(&claim, &interval, adjusted <= FAMILY_WISE) {
                Verdict::Undecided => (Verdict::Undecided, advice(&claim, share)),
                verdict => (verdict, String::new()),
            },
        };
        Judged { claim, interval, p, adjusted, verdict, advice }
    };
    claims.into_iter().zip(p_values).zip(adjusted).map(judge_one).collect()
}

/// Why a claim's statistic decides nothing, if so.
fn obstacle(claim: &Claim, seed: u64) -> Option<String> {
    let statistic = &claim.statistic;
    match statistic.maps() {
        _ if matches!(claim.basis, Basis::ChosenAfter { seeds, .. } if seeds.contains(&seed)) => {
            Some(format!("seed {seed} was looked at when this was chosen: another seed can judge it"))
        }
        Some(maps) if maps < MIN_MAPS => Some(format!("{maps} maps; a verdict needs {MIN_MAPS}")),
        _ if statistic.is_heavy_tailed() => Some("heavy-tailed: a few maps carry the variance".to_string()),
        _ => None,
    }
}

fn decide(claim: &Claim, interval: &Interval, is_significant: bool) -> Verdict {
    match claim.kind {
        Kind::Within(_) if is_significant => Verdict::Rejected,
        Kind::Within(margin) if interval.is_within(&margin) => Verdict::Upheld,
        // A difference that is seen but excluded from being as large as stated rejects the claim.
        Kind::Differs { from, by } if by > 0.0 && from - by < interval.low && interval.high < from + by => {
            Verdict::Rejected
        }
        Kind::Differs { from, by }
            if is_significant && (interval.low >= from + by || interval.high <= from - by) =>
        {
            Verdict::Upheld
        }
        Kind::Fits if is_significant => Verdict::Rejected,
        Kind::Fits if claim.statistic.value() > FIT_LEVEL => Verdict::Upheld,
        Kind::Refused if is_significant => Verdict::Upheld,
        _ => Verdict::Undecided,
    }
}

/// How many maps would decide, if the estimate stays where it is: the error falls as one over the root of the maps,
/// and a verdict with 99 per cent power needs (t + 2.4) errors.
fn advice(claim: &Claim, share: f64) -> String {
    if matches!(claim.kind, Kind::Fits | Kind::Refused) {
        return "the test of fit neither refuses clearly nor accepts: more maps would decide".to_string();
    }
    let Some(maps) = claim.statistic.maps() else { return "the bound on its error is too wide".to_string() };
    let needed_errors = student_critical(share, maps - 1) + POWER_QUANTILE;
    let ratio = needed_errors * claim.statistic.std_error() / claim.distance();
    let factor = ratio * ratio;
    if !factor.is_finite() || factor > 1e4 {
        return "the estimate lies on the margin's edge: more than 10,000 times the maps".to_string();
    }
    // A verdict at more than the present maps was missed by luck only: twice the maps, at least.
    let factor = factor.max(2.0);
    format!(
        "about {} maps of this size would decide ({} times the photons)",
        (factor * maps as f64).ceil(),
        number((factor * 10.0).ceil() / 10.0)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::math::{ln, sin_cos};
    use turbid::rng::{Purpose, Stream};
    use turbid::stats::Moments;

    const SEED: u64 = 100;

    fn estimate(set: u64, maps: u64, mean: f64, deviation: f64) -> Estimate {
        let mut stream = Stream::new(23, Purpose::Synthetic, set, 0);
        let normal =
            |s: &mut Stream| (-2.0 * ln(s.open_unit())).sqrt() * sin_cos(std::f64::consts::TAU * s.unit()).1;
        Estimate::mean(&(0..maps).map(|_| mean + deviation * normal(&mut stream)).collect::<Moments>())
    }

    fn within(statistic: Estimate) -> Claim {
        Claim::within("a", "a", Unit::ONE, statistic, 0.95, 1.05)
    }

    fn verdict(claim: Claim) -> Verdict {
        judge(vec![claim], SEED)[0].verdict
    }

    #[test]
    fn the_three_verdicts_of_a_margin() {
        assert_eq!(verdict(within(estimate(0, 64, 1.0, 0.05))), Verdict::Upheld);
        assert_eq!(verdict(within(estimate(0, 64, 1.2, 0.05))), Verdict::Rejected);
        assert_eq!(verdict(within(estimate(0, 64, 1.0, 1.0))), Verdict::Undecided);
        // Outside the margin, but not significantly.
        assert_eq!(verdict(within(estimate(0, 64, 1.06, 0.05))), Verdict::Undecided);
    }

    /// Verdicts turn where the interval does, to a part in a million: 64 values of 1 and -1 have the mean 0 and the error
    /// sqrt(64/63)/8; the level of one claim is 1e-3, of two half of it.
    #[test]
    fn verdicts_turn_at_the_ends_of_the_interval() {
        let statistic = Estimate::mean(&(0..64).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect());
        let error = (64.0f64 / 63.0).sqrt() / 8.0;
        // The t of 63 degrees that is exceeded with 1e-3 and 5e-4.
        for (claims, critical) in [(1, student_critical(1e-3, 63)), (2, student_critical(5e-4, 63))] {
            let end = critical * error;
            let first = |claim: Claim| judge(vec![claim; claims], SEED)[0].verdict;
            for (part, within, beyond) in [
                (1.0 + 1e-6, Verdict::Upheld, Verdict::Rejected),
                (1.0 - 1e-6, Verdict::Undecided, Verdict::Undecided),
            ] {
                let to = end * part;
                let claim = |low, high| Claim::within("a", "a", Unit::ONE, statistic, low, high);
                assert_eq!(first(claim(-to, to)), within, "{claims} claims, {part} of the interval");
                assert_eq!(first(claim(to, 10.0)), beyond, "{claims} claims, margin from {part} of the end");
                assert_eq!(first(claim(-10.0, -to)), beyond, "{claims} claims, margin to {part} of the end");
            }
        }
        assert!((student_critical(1e-3, 63) - 3.451_769).abs() < 1e-6, "{}", student_critical(1e-3, 63));
    }

    #[test]
    fn the_three_verdicts_of_a_fault() {
        let fault = |statistic| Claim::detected("a", "a", Unit::ONE, statistic, 1.0, 0.05);
        assert_eq!(verdict(fault(estimate(0, 64, 1.1, 0.05))), Verdict::Upheld);
        assert_eq!(verdict(fault(estimate(0, 64, 1.0, 0.05))), Verdict::Rejected);
        assert_eq!(verdict(fault(estimate(0, 64, 1.0, 1.0))), Verdict::Undecided);
        // Seen, but too small to be the fault that was planted.
        assert_eq!(verdict(fault(estimate(0, 64, 1.01, 0.001))), Verdict::Rejected);
    }

    #[test]
    fn few_maps_and_heavy_tails_decide_nothing() {
        let few = judge(vec![within(estimate(0, 63, 2.0, 0.01))], SEED);
        assert_eq!(few[0].verdict, Verdict::Undecided);
        assert!(few[0].advice.contains("63 maps"));
        let heavy: Moments = (0..1000).map(|i| if i == 0 { 1000.0 } else { 0.999 }).collect();
        assert!(judge(vec![within(Estimate::mean(&heavy))], SEED)[0].advice.contains("heavy-tailed"));
    }

    /// What was chosen after a look at seeds 1 and 2 is judged by any other, and takes no part in the family with them.
    #[test]
    fn a_seed_that_was_looked_at_decides_nothing() {
        let claim = || within(estimate(0, 64, 1.2, 0.05)).chosen_after("margin", &[1, 2]);
        assert_eq!(judge(vec![claim()], 3)[0].verdict, Verdict::Rejected);
        let same = judge(vec![claim()], 2);
        assert_eq!((same[0].verdict, same[0].p), (Verdict::Undecided, 1.0));
        assert!(same[0].advice.contains("seed 2 was looked at"), "{}", same[0].advice);
    }

    #[test]
    fn sharpness_is_half_the_margin_in_errors() {
        let sampled = within(estimate(0, 64, 1.0, 0.05));
        let expected = 0.05 / sampled.statistic.std_error();
        assert!((sampled.sharpness().unwrap() - expected).abs() < 1e-9 * expected);
        assert_eq!(within(Estimate::exact(1.0, 1e-9)).sharpness(), None);
        assert_eq!(Claim::at_most("a", "a", Unit::ONE, estimate(0, 64, 1.0, 0.05), 2.0).sharpness(), None);
    }

    #[test]
    fn computed_values_are_judged_by_their_bound() {
        assert_eq!(verdict(within(Estimate::exact(1.0, 1e-9))), Verdict::Upheld);
        assert_eq!(verdict(within(Estimate::exact(1.051, 1e-9))), Verdict::Rejected);
        assert_eq!(verdict(within(Estimate::exact(1.05, 1e-9))), Verdict::Undecided);
        assert_eq!(verdict(within(Estimate::exact(f64::NAN, 1e-9))), Verdict::Rejected);
    }

    #[test]
    fn tests_of_fit() {
        for (p, fits, refused) in [
            (0.3, Verdict::Upheld, Verdict::Undecided),
            (5e-4, Verdict::Rejected, Verdict::Upheld),
            (f64::NAN, Verdict::Rejected, Verdict::Undecided),
        ] {
            assert_eq!(verdict(Claim::fits("a", "a", p)), fits, "{p}");
            assert_eq!(verdict(Claim::refused("a", "a", p)), refused, "{p}");
        }
        // Among ten claims 5e-4 is neither a fit nor, after Holm, a misfit.
        let many = |claim: Claim| judge(std::iter::repeat_n(claim, 10).collect(), SEED)[0].verdict;
        assert_eq!(many(Claim::fits("a", "a", 5e-4)), Verdict::Undecided);
        assert_eq!(many(Claim::refused("a", "a", 5e-4)), Verdict::Undecided);
        assert_eq!(many(Claim::refused("a", "a", 5e-5)), Verdict::Upheld);
    }

    #[test]
    fn one_sided_margins() {
        let at_most = |s| verdict(Claim::at_most("a", "a", Unit::ONE, s, 0.01));
        assert_eq!(at_most(estimate(0, 64, -5.0, 0.01)), Verdict::Upheld);
        assert_eq!(at_most(estimate(0, 64, 5.0, 0.01)), Verdict::Rejected);
        assert_eq!(
            verdict(Claim::at_least("a", "a", Unit::ONE, estimate(0, 64, 5.0, 0.01), 0.0)),
            Verdict::Upheld
        );
    }

    /// The advice is kept: with as many maps as it asks for, the claim is decided in most of 100 studies.
    #[test]
    fn the_advised_number_of_maps_decides() {
        let judged = judge(vec![within(estimate(1, 64, 1.0, 0.2))], SEED);
        assert_eq!(judged[0].verdict, Verdict::Undecided);
        let distance = judged[0].claim.distance();
        let maps: u64 = judged[0].advice.split(' ').nth(1).unwrap().parse().unwrap();
        // The advice holds for a truth where the estimate was; this one has its margin at that distance.
        let decided = (0..100)
            .filter(|&s| {
                let claim = Claim::within(
                    "a",
                    "a",
                    Unit::ONE,
                    estimate(s, maps, 1.0, 0.2),
                    1.0 - distance,
                    1.0 + distance,
                );
                verdict(claim) != Verdict::Undecided
            })
            .count();
        assert!(decided >= 90, "{decided} of 100 with {maps} maps");
    }

    /// Truth on the margin's edge, where rejecting and upholding are both wrong as often as they ever are. 20,000
    /// studies of one claim at the family's 1e-3: each kind of mistake happens at most about that often.
    #[test]
    fn false_verdicts_on_the_edge_are_rare() {
        let (mut upheld, mut rejected) = (0, 0);
        for set in 0..20_000 {
            // Wide enough that the far edge does not matter, narrow enough that the near one does.
            match verdict(within(estimate(set, 64, 1.05, 0.05))) {
                Verdict::Upheld => upheld += 1,
                Verdict::Rejected => rejected += 1,
                Verdict::Undecided => {}
            }
        }
        // One side of a two-sided 1e-3: 10 expected each; 40 has probability 1e-12.
        assert!(
            (1..40).contains(&upheld) && (1..40).contains(&rejected),
            "{upheld} upheld, {rejected} rejected"
        );
    }
}
