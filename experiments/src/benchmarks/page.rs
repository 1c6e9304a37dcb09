//! The page: a section a set, with its picture, its table, its sums of squares and verdicts.

use super::comparison::{Answered, Comparison, LEVEL, Row, Verdict};
use super::set::Set;
use super::sets::ALL;
use super::settings::Settings;
use crate::harness::{duration, number};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const CSS: &str = "
:root { --ink: #1c1f23; --soft: #5b6470; --line: #d5dae0; --good: #1d6b3a; --bad: #a3231f; --open: #8a5a00; }
* { box-sizing: border-box; }
body { max-width: 1080px; margin: 0 auto; padding: 40px 24px 80px; color: var(--ink); background: #fff; font: 17px/1.5 Charter, 'Bitstream Charter', Georgia, serif; }
h1 { font-size: 34px; line-height: 1.2; margin: 0 0 10px; font-weight: 600; }
h2 { font-size: 25px; margin: 56px 0 6px; padding-top: 16px; border-top: 2px solid var(--ink); font-weight: 600; }
p { max-width: 46em; margin: 0 0 12px; }
table, pre, .soft, .badge, summary { font-family: system-ui, 'Segoe UI', Arial, 'DejaVu Sans', sans-serif; }
.soft { color: var(--soft); font-size: 14.5px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: 8px 0 16px; }
th { text-align: left; vertical-align: bottom; border-bottom: 1.5px solid var(--ink); padding: 4px 16px 4px 0; }
td { border-bottom: 1px solid var(--line); padding: 4px 16px 4px 0; vertical-align: top; }
.n { text-align: right; white-space: nowrap; }
img { display: block; width: 100%; height: auto; margin: 12px 0; }
.badge { font-size: 12.5px; font-weight: 600; border-radius: 3px; padding: 1px 8px; white-space: nowrap; border: 1px solid currentColor; }
.agrees { color: var(--good); } .differs { color: #fff; background: var(--bad); border-color: var(--bad); } .open { color: var(--open); border-style: dashed; }
summary { cursor: pointer; color: #1a4f8b; font-size: 14px; padding: 4px 0; }
a { color: #1a4f8b; text-decoration: none; } a:hover { text-decoration: underline; }
pre { background: #f5f6f8; border: 1px solid var(--line); border-radius: 4px; padding: 10px 12px; font-size: 13px; white-space: pre-wrap; }
@media (max-width: 560px) { body { padding: 20px 14px 48px; font-size: 16px; } h1 { font-size: 26px; } }
@media print { body { max-width: none; padding: 0; font-size: 10pt; } h2 { break-after: avoid; } tr, img { break-inside: avoid; } }
";

/// The page of all sets that were answered.
pub fn page(answered: &[Answered], settings: &Settings) -> Markup {
    let found: Vec<(&Set, &Answered)> =
        ALL.iter().filter_map(|set| Some((*set, answered.iter().find(|a| a.set == set.name)?))).collect();
    let comparisons = || found.iter().flat_map(|(_, a)| &a.comparisons);
    let count = |verdict: Verdict| comparisons().filter(|c| c.verdict() == verdict).count();
    let values: u64 = comparisons().filter(|c| !c.is_among_ours()).map(|c| c.chi_squared().1).sum();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "turbid: benchmarks of other communities" }
                style { (PreEscaped(CSS)) }
            }
            body {
                h1 { "Numbers that others published, beside turbid's" }
                p {
                    (found.len()) " sets, " (values) " comparisons with published numbers, by exact solutions, paths, light tracing and photon maps, and where "
                    "nobody published any, of our own methods with each other: " (count(Verdict::Agrees)) " answers agree, " (count(Verdict::Differs)) " differ, " (count(Verdict::Open))
                    " are open. Every difference is explained in its section, or named as unexplained."
                }
                p.soft {
                    "Each value of ours is held against theirs over the combined error: the standard error of both, or the proven bound of an exact "
                    "value, and the rounding of a printed number (a unit of its last digit over the root of 12). The squares of these add up to "
                    "chi-squared, with as many degrees of freedom as there are values; an answer differs where chance would give a larger sum, or one "
                    "difference as large, with a probability below " (number(LEVEL)) ". Values whose error cannot be trusted are shown, and not counted. Bins of one run share its photons: neighbours vary together, and their sum is the rougher for it. The bias detected is one common "
                    "to all values that would be found with a probability of 99 per cent."
                }
                div.scroll { table {
                    thead { tr {
                        th { "Set" } th { "Answered by" } th.n { "Values" } th.n { "χ²" } th.n { "p" } th.n { "Detects a bias of" } th { "Verdict" } th.n { "Time" }
                    } }
                    @for (set, a) in &found { @for (index, c) in a.comparisons.iter().enumerate() { (summary(set, c, index == 0)) } }
                } }
                @for (set, a) in &found { (section(set, a)) }
                h2 { "Once more" }
                p { "On another machine, with another seed, or with numbers of another code:" }
                pre { "cargo run --release --bin benchmarks" (if settings.quick { " -- --quick" } else { "" }) }
            }
        }
    }
}

fn badge(verdict: Verdict) -> Markup {
    html! { span class=(format!("badge {}", verdict.word())) { (verdict.word()) } }
}

fn p_value(p: Option<f64>) -> String {
    match p {
        None => "–".to_string(),
        Some(p) if p < 1e-12 => "< 10⁻¹²".to_string(),
        Some(p) => number(p),
    }
}

fn percent(x: Option<f64>) -> String {
    x.map_or("–".to_string(), |x| format!("{} %", two_digits(100.0 * x)))
}

/// To two significant digits.
fn two_digits(x: f64) -> String {
    let text = format!("{x:.1e}");
    number(text.parse().unwrap_or(x))
}

fn summary(set: &Set, c: &Comparison, is_first: bool) -> Markup {
    let (sum, n) = c.chi_squared();
    html! {
        tr {
            td { @if is_first { a href=(format!("#{}", set.name)) { (set.title) } } }
            td { (c.by) }
            td.n { (n) @if n < c.rows.len() as u64 { " of " (c.rows.len()) } }
            td.n { @if n > 0 { (number(sum)) } @else { "–" } }
            td.n { (p_value(c.p())) }
            td.n { (percent(c.detects())) }
            td { (badge(c.verdict())) }
            td.n { (duration(c.seconds)) }
        }
    }
}

fn section(set: &Set, a: &Answered) -> Markup {
    let different = a.comparisons.iter().filter(|c| c.verdict() == Verdict::Differs);
    html! {
        h2 id=(set.name) { (set.title) }
        p { (set.about) }
        p.soft { (set.source) ". " (set.trust) }
        img src=(format!("{}.png", set.name)) alt=(format!("{}: values of both, and differences over combined errors", set.title));
        p.soft {
            "Above: " (above(set)) " Below: differences over combined errors, of which 95 per cent lie between the lines if all is understood; "
            "what lies beyond is drawn at the border."
        }
        @for c in different { (difference(set, c)) }
        @for c in &a.comparisons { (rows(c)) }
    }
}

fn above(set: &Set) -> &'static str {
    match set.plot {
        super::set::Plot::Curves { .. } => "lines are ours, markers theirs.",
        super::set::Plot::Rows => "relative differences, with intervals of 95 per cent.",
    }
}

fn difference(set: &Set, c: &Comparison) -> Markup {
    let why = set.explained.iter().find(|(by, _)| *by == c.by).map(|(_, why)| *why);
    html! {
        p {
            strong { "Differs, by " (c.by) ". " }
            @if let Some(row) = c.worst() {
                "The largest difference is " (row.z().map_or(String::new(), two_digits)) " errors, "
                (percent(row.relative())) " (" (row.case) ", " (row.quantity) "). "
            }
            @match why { Some(why) => (why), None => "It is not explained." }
        }
    }
}

fn rows(c: &Comparison) -> Markup {
    html! {
        details {
            summary { (c.rows.len()) " values by " (c.by) }
            div.scroll { table {
                thead { tr {
                    th { "Case" } th { "Quantity" } th.n { "At" } th.n { "Theirs" } th.n { "Their error" } th.n { "Ours" } th.n { "Our error" } th.n { "Difference" } th.n { "Over error" }
                } }
                @for row in &c.rows { (one(row)) }
            } }
        }
    }
}

fn one(row: &Row) -> Markup {
    let value = |x: Option<f64>| x.map_or("–".to_string(), |x| format!("{x:.6e}"));
    let error = |x: Option<f64>| x.map_or("none".to_string(), |x| format!("{x:.1e}"));
    html! {
        tr {
            td { (row.case) } td { (row.quantity) } td.n { (number(row.at)) }
            td.n { (value(row.theirs)) }
            td.n { @if row.theirs.is_some() { (error(row.their_error)) } @else { "–" } }
            td.n { (value(Some(row.ours))) } td.n { (error(row.our_error)) }
            td.n { (percent(row.relative())) }
            td.n { (row.z().map_or("–".to_string(), |z| format!("{z:.2}"))) }
        }
    }
}
