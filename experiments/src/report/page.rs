//! The page.

use super::style::CSS;
use crate::harness::{
    FAMILY_WISE, FigureFiles, Judged, Kind, MIN_MAPS, Prediction, Provenance, Row, SectionReport, Settings,
    Table, Verdict, number, row_label, with_error,
};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Predictions shown in a section; the rest is in predictions.csv.
const SHOWN: usize = 30;

/// Running numbers of figures and tables.
#[derive(Default)]
struct Numbers {
    figure: u32,
    table: u32,
}

/// The whole page, self-contained.
pub fn page(study: &str, settings: &Settings, sections: &[SectionReport], provenance: &Provenance) -> String {
    let title = match sections {
        [only] => only.experiment.title,
        _ => "What does photon mapping’s speed cost in accuracy?",
    };
    let mut numbers = Numbers::default();
    let page = html! {
        (DOCTYPE)
        html lang="en-GB" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "turbid: " (title) }
                style { (PreEscaped(CSS)) }
            }
            body {
                header {
                    div.kicker { "turbid · " @if study == "study" { "the whole study" } @else { "experiment " (study) } }
                    h1 { (title) }
                    div.byline { (provenance.date) " · " (provenance.settings) " · version " (provenance.version) ", revision " (provenance.revision) }
                }
                (overview(sections, &mut numbers))
                @for part in sections { (section(part, sections.len() > 1, &mut numbers)) }
                (methods(sections, &mut numbers))
                (circumstances(study, settings, provenance, &mut numbers))
            }
        }
    };
    page.into_string()
}

fn overview(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let count = |verdict| sections.iter().flat_map(|s| &s.judged).filter(|j| j.verdict == verdict).count();
    let claims: usize = sections.iter().map(|s| s.judged.len()).sum();
    html! {
        @if sections.len() > 1 {
            p {
                "A photon map estimates light in fog, water or smoke from stored photons: fast, and biased by design. "
                "This study measures that bias. Each experiment predicts a number from theory, writes it down, measures it on "
                "independent photon maps, and compares it with a prediction or an exact solution. "
                "Every claim states its margin before the measurement."
            }
        }
        div.counts {
            @for verdict in [Verdict::Upheld, Verdict::Rejected, Verdict::Undecided] {
                span { b { (count(verdict)) } (verdict.word()) }
            }
        }
        @if sections.iter().any(|s| !s.section.summary.is_empty()) && sections.len() > 1 {
            ul {
                @for part in sections {
                    @if let Some(headline) = part.section.summary.first() {
                        li { a href=(format!("#{}", part.experiment.name)) { (part.experiment.title) } ": " (headline) }
                    }
                }
            }
        }
        @if claims > 0 && sections.len() > 1 {
            (table_frame(numbers, "All claims with their verdicts. Measured values carry one standard error over independent maps.", html! {
                thead { tr { th { "claim" } th.n { "measured" } th.n { "claimed" } th.n { "maps" } th { "verdict" } } }
                tbody {
                    @for part in sections {
                        @if !part.judged.is_empty() {
                            tr.group { td colspan="5" { a href=(format!("#{}", part.experiment.name)) { (part.experiment.title) } } }
                        }
                        @for judged in &part.judged {
                            tr {
                                td.claim { (judged.claim.text) (advice(judged)) }
                                td.n { (judged.measured()) }
                                td.n { (judged.claim.margin()) }
                                td.n { (maps(judged)) }
                                td { (badge(judged.verdict)) }
                            }
                        }
                    }
                }
            }))
        }
    }
}

fn advice(judged: &Judged) -> Markup {
    html! { @if !judged.advice.is_empty() { div.advice { (judged.advice) } } }
}

fn maps(judged: &Judged) -> String {
    judged.claim.statistic.maps().map_or_else(|| "computed".to_string(), |maps| maps.to_string())
}

fn badge(verdict: Verdict) -> Markup {
    html! { span class=(format!("badge {}", verdict.word())) { (verdict.word()) } }
}

fn section(part: &SectionReport, has_heading: bool, numbers: &mut Numbers) -> Markup {
    html! {
        section id=(part.experiment.name) {
            @if has_heading { h2 { (part.experiment.title) } }
            p.question { (part.experiment.question) }
            @for paragraph in &part.section.summary { p { (paragraph) } }
            @for figure in part.section.figures.iter().take(1) { (draw(figure, numbers)) }
            @if !part.judged.is_empty() { (claims(&part.judged, numbers)) }
            @for figure in part.section.figures.iter().skip(1) { (draw(figure, numbers)) }
            @for table in &part.section.tables { (print_table(table, numbers)) }
            @if !part.predictions.is_empty() { (predictions(part, numbers)) }
            @if !part.section.notes.is_empty() {
                h3 { "Notes" }
                @for note in &part.section.notes { p.note { (note) } }
            }
        }
    }
}

fn claims(judged: &[Judged], numbers: &mut Numbers) -> Markup {
    let caption = "What is claimed here. The interval is the one that decides: it holds for all claims of the study at once.";
    table_frame(
        numbers,
        caption,
        html! {
            thead { tr { th { "claim" } th.n { "measured" } th.n { "interval" } th.n { "claimed" } th.n { "p (Holm)" } th { "verdict" } } }
            tbody {
                @for judged in judged {
                    tr {
                        td.claim { (judged.claim.text) (advice(judged)) }
                        td.n { (judged.measured()) }
                        td.n { (interval(judged)) }
                        td.n { (judged.claim.margin()) }
                        td.n { (p_value(judged.adjusted)) }
                        td { (badge(judged.verdict)) }
                    }
                }
            }
        },
    )
}

fn interval(judged: &Judged) -> String {
    let (low, high) = (judged.interval.low, judged.interval.high);
    // A p-value has no interval.
    if matches!(judged.claim.kind, Kind::Fits | Kind::Refused) {
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

fn draw(figure: &FigureFiles, numbers: &mut Numbers) -> Markup {
    numbers.figure += 1;
    // The declaration before the root element has no place inside a page.
    let svg = figure.svg.find("<svg").map_or("", |start| &figure.svg[start..]);
    html! {
        figure {
            (PreEscaped(svg))
            figcaption { b { "Figure " (numbers.figure) "." } " " (figure.caption) }
        }
    }
}

/// Columns whose filled cells all look like numbers are set flush right.
fn is_numeric(table: &Table, column: usize) -> bool {
    let mut cells =
        table.rows.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty()).peekable();
    cells.peek().is_some()
        && cells.all(|cell| cell.starts_with(|c: char| c.is_ascii_digit() || "−-(∞<>".contains(c)))
}

fn print_table(table: &Table, numbers: &mut Numbers) -> Markup {
    let class = |column: usize| if is_numeric(table, column) { "n" } else { "" };
    table_frame(
        numbers,
        &table.caption,
        html! {
            thead { tr { @for (i, column) in table.columns.iter().enumerate() { th class=(class(i)) { (column) } } } }
            tbody {
                @for row in &table.rows {
                    tr { @for (i, cell) in row.iter().enumerate() { td class=(class(i)) { (cell) } } }
                }
            }
        },
    )
}

fn table_frame(numbers: &mut Numbers, caption: &str, content: Markup) -> Markup {
    numbers.table += 1;
    html! {
        div.scroll { table { caption { b { "Table " (numbers.table) "." } " " (caption) } (content) } }
    }
}

fn predictions(part: &SectionReport, numbers: &mut Numbers) -> Markup {
    let more = part.predictions.len().saturating_sub(SHOWN);
    let measured = |p: &Prediction| {
        let own = |row: &&Row| row.key() == (p.case.as_str(), p.quantity.as_str());
        part.section
            .rows
            .iter()
            .find(own)
            .map(|row| with_error(row.value().0, row.value().1))
            .unwrap_or_default()
    };
    let rows = part.predictions.iter().take(SHOWN);
    let rows = rows.map(|p| {
        vec![
            p.case.clone(),
            row_label(&p.quantity, p.unit.name()),
            number(p.value),
            measured(p),
            p.source.clone(),
        ]
    });
    let tail = if more == 0 {
        String::new()
    } else {
        format!(" The first {SHOWN} of {}; all are in predictions.csv.", part.predictions.len())
    };
    let table = Table {
        caption: format!("What was predicted, before the measurement.{tail}"),
        columns: ["case", "quantity", "predicted", "measured", "source"].map(String::from).to_vec(),
        rows: rows.collect(),
    };
    print_table(&table, numbers)
}

fn methods(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let claims: usize = sections.iter().map(|s| s.judged.len()).sum();
    html! {
        h2 { "How verdicts are reached" }
        p {
            "Photons of one map are shared by all its estimates, so errors come from independent maps: each map gives one value, and "
            "means are judged by Student’s t with one degree of freedom less than there are maps. A verdict needs at least " (MIN_MAPS) " maps."
        }
        p {
            "A claim is " b { "upheld" } " if the whole interval lies within the margin that it states; " b { "rejected" }
            " if the measurement lies outside significantly, after Holm’s correction over all " (claims) " claims of the study; "
            b { "undecided" } " if neither holds. A planted fault is upheld if it is seen with the same significance. "
            "The probability of any wrong rejection or detection in the whole study is at most " (number(FAMILY_WISE))
            ", and so is that of anything upheld wrongly. Intervals of 95 per cent are drawn in figures and decide nothing."
        }
        @if !sections.is_empty() {
            (table_frame(numbers, "Work done. Counts are results and repeat exactly; seconds belong to this machine.", html! {
                thead { tr { th { "experiment" } th.n { "cells" } th { "counts" } th.n { "CPU time" } } }
                tbody {
                    @for part in sections {
                        tr {
                            td { (part.experiment.title) }
                            td.n { (part.cells.0) }
                            td { (counters(part)) }
                            td.n { (crate::harness::duration(part.cells.1)) }
                        }
                    }
                }
            }))
        }
    }
}

fn counters(part: &SectionReport) -> String {
    let texts: Vec<String> =
        part.counters.iter().map(|(name, count)| format!("{} {name}", grouped(*count))).collect();
    texts.join(", ")
}

/// A whole number with thin spaces between thousands.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    text
}

fn circumstances(study: &str, settings: &Settings, provenance: &Provenance, numbers: &mut Numbers) -> Markup {
    let p = provenance;
    let facts = [
        ("settings", p.settings.clone()),
        ("version", format!("turbid {}, revision {}", p.version, p.revision)),
        ("program", format!("digest {}, {}", p.program, p.rustc)),
        ("machine", format!("{}, {} cores, {} GiB", p.cpu, p.cores, p.memory_gib)),
        ("system", p.system.clone()),
        (
            "measured",
            format!(
                "{} cells, {} of them in the last run on {} threads, {} of CPU time in all",
                p.cells,
                p.measured,
                p.threads,
                crate::harness::duration(p.cpu_seconds)
            ),
        ),
        ("finished", p.date.clone()),
    ];
    html! {
        h2.flow { "Where this comes from" }
        @if p.foreign > 0 {
            p.warning { (p.foreign) " of " (p.cells) " cells were made by another build of the program and reused on request." }
        }
        @if p.late_predictions {
            p.warning { "Predictions changed after some cells had been measured." }
        }
        (table_frame(numbers, "Circumstances of the measurement.", html! {
            tbody { @for (name, value) in facts { tr { td { (name) } td { (value) } } } }
        }))
        h3 { "To repeat it" }
        pre { (settings.command(study)) }
        p {
            "The same settings and seed give the same bits in " code { "results.csv" } " on any number of threads. Beside this page: "
            code { "results.csv" } " (every quantity), " code { "claims.csv" } " (the verdicts), " code { "predictions.csv" } ", "
            code { "timing.csv" } ", " code { "provenance.json" } ", " code { "figures/" } " (SVG and PNG) and " code { "cells/" } " (every map)."
        }
    }
}
