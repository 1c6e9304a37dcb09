//! The page.

use super::claims;
use super::contents::contents;
use super::figures;
use super::style::CSS;
use super::tables::{self, Numbers};
use crate::harness::{
    FAMILY_WISE, FIT_LEVEL, FigureFiles, MIN_MAPS, Provenance, Row, SectionReport, Settings, Table, Verdict,
    number, row_label, with_error,
};
use crate::prediction::Prediction;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Predictions shown in a section; the rest is in predictions.csv.
const SHOWN: usize = 30;

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
    let count = |verdict| claims::count(sections.iter().flat_map(|s| &s.judged), verdict);
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
        @if sections.len() > 1 {
            (contents(sections))
            (claims::overview(sections, numbers))
        }
    }
}

fn section(part: &SectionReport, has_heading: bool, numbers: &mut Numbers) -> Markup {
    html! {
        section id=(part.experiment.name) {
            @if has_heading {
                h2 { (part.experiment.title) " " a.up href="#contents" title="to the contents" { "↑" } }
            }
            p.question { (part.experiment.question) }
            @for paragraph in &part.section.summary { p { (paragraph) } }
            @for figure in part.section.figures.iter().take(1) { (draw(part, figure, numbers)) }
            @if !part.judged.is_empty() { (claims::own(part, numbers)) }
            @for figure in part.section.figures.iter().skip(1) { (draw(part, figure, numbers)) }
            @for table in &part.section.tables { (tables::plain(table, numbers)) }
            @if !part.predictions.is_empty() { (predictions(part, numbers)) }
            @if !part.section.notes.is_empty() {
                h3 { "Notes" }
                @for note in &part.section.notes { p.note { (note) } }
            }
        }
    }
}

fn draw(part: &SectionReport, figure: &FigureFiles, numbers: &mut Numbers) -> Markup {
    numbers.figure += 1;
    figures::figure(part.experiment.name, figure, numbers.figure)
}

fn predictions(part: &SectionReport, numbers: &mut Numbers) -> Markup {
    let more = part.predictions.len().saturating_sub(SHOWN);
    let measured = |p: &Prediction| {
        let own = |row: &&Row| row.key() == (p.case.as_str(), p.quantity.as_str());
        part.section
            .rows
            .iter()
            .find(own)
            .map(|row| with_error(p.unit.shown(row.value().0), p.unit.shown(row.value().1)))
            .unwrap_or_default()
    };
    let rows = part.predictions.iter().take(SHOWN);
    let rows = rows.map(|p| {
        vec![
            p.case.clone(),
            row_label(&p.quantity, p.unit),
            number(p.unit.shown(p.value)),
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
    tables::plain(&table, numbers)
}

fn methods(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let claims: usize = sections.iter().map(|s| s.judged.len()).sum();
    html! {
        h2 id="methods" { "How verdicts are reached" }
        p {
            "Photons of one map are shared by all its estimates, so errors come from independent maps: each map gives one value, and "
            "means are judged by Student’s t with one degree of freedom less than there are maps. A verdict needs at least " (MIN_MAPS) " maps."
        }
        p {
            "A claim is " b { "upheld" } " if the whole interval lies within the margin that it states; " b { "rejected" }
            " if the measurement lies outside significantly, after Holm’s correction over all " (claims) " claims of the study; "
            b { "undecided" } " if neither holds. A planted fault is upheld if it is detected with the same significance. "
            "A test of fit has no margin: it is upheld while its p is above " (number(FIT_LEVEL)) ", which shows that nothing large is overlooked, not that nothing is. "
            "The probability of any wrong rejection or detection in the whole study is at most " (number(FAMILY_WISE))
            ", and so is that of anything with a margin upheld wrongly, as far as means over maps are normal; the coverage of the "
            "intervals is an experiment of its own. ± is one standard error. Intervals of 95 per cent are drawn in figures and decide nothing."
        }
        @if !sections.is_empty() {
            (tables::frame(numbers, "Work done. Counts are results and repeat exactly; seconds belong to this machine.", html! {
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
        h2.flow id="origin" { "Where this comes from" }
        @if p.foreign > 0 {
            p.warning { (p.foreign) " of " (p.cells) " cells were made by another build of the program and reused on request." }
        }
        @if p.late_predictions {
            p.warning { "Predictions changed after some cells had been measured." }
        }
        (tables::frame(numbers, "Circumstances of the measurement.", html! {
            tbody { @for (name, value) in facts { tr { td { (name) } td { (value) } } } }
        }))
        h3 { "To repeat it" }
        pre { (settings.command(study)) }
        p {
            "The same settings and seed give the same bits in " code { "results.csv" } " on any number of threads. Beside this page: "
            code { "results.csv" } " (every quantity), " code { "claims.csv" } " (the verdicts), " code { "predictions.csv" } ", "
            code { "timing.csv" } ", " code { "provenance.json" } ", " code { "figures/" } " (SVG and PNG for one and for two columns of print, and a table of each figure) and " code { "cells/" } " (every map). "
            "A figure whose table in " code { "figures/" } " was edited is drawn again, here too, by the same command with " code { "--replot" } ": nothing is measured."
        }
    }
}
