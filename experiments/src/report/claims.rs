//! Claims and verdicts in the page.

use super::tables::{self, Numbers};
use crate::harness::{Judged, Kind, SectionReport, Verdict, number, with_error};
use maud::{Markup, html};

/// Number of claims with a verdict.
pub(super) fn count<'a>(judged: impl IntoIterator<Item = &'a Judged>, verdict: Verdict) -> usize {
    judged.into_iter().filter(|j| j.verdict == verdict).count()
}

pub(super) fn badge(verdict: Verdict) -> Markup {
    html! { span class=(format!("badge {}", verdict.word())) { (verdict.word()) } }
}

/// The place of a claim in the page.
fn anchor(experiment: &str, judged: &Judged) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '-' };
    format!("claim-{experiment}-{}", judged.claim.id.chars().map(safe).collect::<String>())
}

/// The verdicts of one section in a line, which leads to its claims.
pub(super) fn line(part: &SectionReport) -> Markup {
    html! {
        @if let Some(first) = part.judged.first() {
            p.verdicts {
                a href=(format!("#{}", anchor(part.experiment.name, first))) {
                    (part.judged.len()) @if part.judged.len() == 1 { " claim" } @else { " claims" }
                }
                ": " (verdicts(&part.judged))
            }
        }
    }
}

/// "12 upheld, 1 undecided", each with its badge.
pub(super) fn verdicts(judged: &[Judged]) -> Markup {
    html! {
        @for verdict in [Verdict::Upheld, Verdict::Rejected, Verdict::Undecided] {
            @let n = count(judged, verdict);
            @if n > 0 { b { (n) } " " (badge(verdict)) " " }
        }
    }
}

/// The appendix: what is not upheld, then every claim of the study in one table that can be searched.
pub(super) fn appendix(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let all: usize = sections.iter().map(|s| s.judged.len()).sum();
    let is_upheld = |j: &Judged| j.verdict == Verdict::Upheld;
    let open: usize = sections.iter().flat_map(|s| &s.judged).filter(|j| !is_upheld(j)).count();
    let caption = "Every claim of the study. Measured values carry one standard error over independent maps. The interval is the \
                   one that decides: it holds for all claims of the study at once. p is the probability of a measurement so far \
                   outside the claim if it were true, after Holm’s correction (of a planted fault or a missing term: if it were \
                   not there). Also in claims.csv, with half of each margin in standard errors.";
    html! {
        @if open > 0 {
            (list(sections, "Claims that are rejected or undecided.", &|j| !is_upheld(j), false, numbers))
        }
        @if all > 0 {
            details.all open[sections.len() == 1] {
                summary { "All " (all) " claims in one table" }
                @if all > FEW {
                    p.find { label { "Show claims with the words " input id="find" type="search" placeholder="undecided sphere"; } }
                }
                (list(sections, caption, &|_| true, true, numbers))
            }
        }
    }
}

/// Fewer claims than this are found by looking.
const FEW: usize = 12;

/// The chosen claims of all sections; `has_anchors` in the table that links lead to.
fn list(
    sections: &[SectionReport],
    caption: &str,
    choose: &dyn Fn(&Judged) -> bool,
    has_anchors: bool,
    numbers: &mut Numbers,
) -> Markup {
    let is_one = sections.len() == 1;
    let content = html! {
        thead {
            tr {
                @if !is_one { th { "experiment" } }
                th { "claim" } th.n { "measured" } th.n { "interval" } th.n { "claimed" } th.n { "p against it" } th { "verdict" }
            }
        }
        tbody id=[has_anchors.then_some("all-claims")] {
            @for part in sections {
                @for judged in part.judged.iter().filter(|j| choose(j)) {
                    tr {
                        @if !is_one { td { a href=(format!("#{}", part.experiment.name)) { (part.experiment.name) } } }
                        td.claim id=[has_anchors.then(|| anchor(part.experiment.name, judged))] {
                            (judged.claim.text) (basis(judged)) (advice(judged))
                        }
                        td.n { (judged.measured()) }
                        td.n { (interval(judged)) }
                        td.n { (judged.claim.margin()) }
                        td.n { (p_value(judged.adjusted)) }
                        td { (badge(judged.verdict)) }
                    }
                }
            }
        }
    };
    tables::frame(numbers, caption, content)
}

/// What was chosen after which runs.
fn basis(judged: &Judged) -> Markup {
    let words = judged.claim.basis.words();
    html! { @if !words.is_empty() { div.advice { "† " (words) } } }
}

fn advice(judged: &Judged) -> Markup {
    html! { @if !judged.advice.is_empty() { div.advice { (judged.advice) } } }
}

fn interval(judged: &Judged) -> String {
    let shown = |x: f64| judged.claim.unit.shown(x);
    let (low, high) = (shown(judged.interval.low), shown(judged.interval.high));
    // A p-value has no interval, and neither has a computed number.
    if matches!(judged.claim.kind, Kind::Fits | Kind::Refused) || judged.claim.statistic.maps().is_none() {
        return String::new();
    }
    // Both ends to the digit that the interval's width justifies.
    let end = |x: f64| {
        with_error(x, 0.1 * (high - low))
            .split(" ± ")
            .next()
            .unwrap_or_default()
            .trim_start_matches('(')
            .to_string()
    };
    let is_plain =
        with_error(low.abs().max(high.abs()), 0.1 * (high - low)).starts_with(|c: char| c.is_ascii_digit());
    if low.is_finite() && high.is_finite() && high > low && is_plain {
        format!("{} to {}", end(low), end(high))
    } else {
        format!("{} to {}", number(low), number(high))
    }
}

fn p_value(p: f64) -> String {
    match p {
        p if p >= 0.9995 => "1".to_string(),
        p if p >= 0.001 => format!("{p:.3}"),
        p if p < 1e-12 => "below 10⁻¹²".to_string(),
        p => number(format!("{p:.0e}").parse().unwrap_or(p)),
    }
}
