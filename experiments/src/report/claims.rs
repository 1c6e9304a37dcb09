//! Claims and verdicts in the page.

use super::tables::{self, Numbers, Row};
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

/// All claims of the study, under a line to open if they are many; what is not upheld stands open above.
pub(super) fn overview(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let all: usize = sections.iter().map(|s| s.judged.len()).sum();
    let is_upheld = |j: &Judged| j.verdict == Verdict::Upheld;
    let open: usize = sections.iter().flat_map(|s| &s.judged).filter(|j| !is_upheld(j)).count();
    let caption =
        "All claims with their verdicts. Measured values carry one standard error over independent maps.";
    html! {
        @if open > 0 {
            (list(sections, "Claims that are rejected or undecided.", &|j| !is_upheld(j), numbers))
        }
        @if all > open {
            details.all {
                summary { "All " (all) " claims in one table" }
                (list(sections, caption, &|_| true, numbers))
            }
        }
    }
}

/// The chosen claims of all sections.
fn list(
    sections: &[SectionReport],
    caption: &str,
    choose: &dyn Fn(&Judged) -> bool,
    numbers: &mut Numbers,
) -> Markup {
    let maps =
        |j: &Judged| j.claim.statistic.maps().map_or_else(|| "computed".to_string(), |m| m.to_string());
    let content = html! {
        thead { tr { th { "claim" } th.n { "measured" } th.n { "claimed" } th.n { "maps" } th { "verdict" } } }
        tbody {
            @for part in sections.iter().filter(|part| part.judged.iter().any(choose)) {
                tr.group { td colspan="5" { a href=(format!("#{}", part.experiment.name)) { (part.experiment.title) } } }
                @for judged in part.judged.iter().filter(|j| choose(j)) {
                    tr {
                        td.claim {
                            a href=(format!("#{}", anchor(part.experiment.name, judged))) { (judged.claim.text) }
                            (advice(judged))
                        }
                        td.n { (judged.measured()) }
                        td.n { (judged.claim.margin()) }
                        td.n { (maps(judged)) }
                        td { (badge(judged.verdict)) }
                    }
                }
            }
        }
    };
    tables::frame(numbers, caption, content)
}

/// The claims of one section.
pub(super) fn own(part: &SectionReport, numbers: &mut Numbers) -> Markup {
    let caption = "What is claimed here. The interval is the one that decides: it holds for all claims of the study at once. p is the probability of a measurement so far outside the claim if it were true, after Holm's correction (of a planted fault or a missing term: if it were not there).";
    let head = html! {
        tr { th { "claim" } th.n { "measured" } th.n { "interval" } th.n { "claimed" } th.n { "p against it" } th { "verdict" } }
    };
    let row = |judged: &Judged| Row {
        cells: html! {
            td.claim id=(anchor(part.experiment.name, judged)) { (judged.claim.text) (advice(judged)) }
            td.n { (judged.measured()) }
            td.n { (interval(judged)) }
            td.n { (judged.claim.margin()) }
            td.n { (p_value(judged.adjusted)) }
            td { (badge(judged.verdict)) }
        },
        is_kept: judged.verdict != Verdict::Upheld,
    };
    tables::table(numbers, caption, head, part.judged.iter().map(row).collect())
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
