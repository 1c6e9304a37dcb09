//! The page.

use super::claims;
use super::contents::contents;
use super::figures;
use super::style::CSS;
use super::tables::{self, Numbers};
use crate::harness::{
    ANSWER, FAMILY_WISE, FIT_LEVEL, FigureFiles, GEOMETRIC, LEFT_OVER, MIN_MAPS, PREDICTED, Provenance, Row,
    SectionReport, Settings, Table, number, percent, row_label, with_error,
};
use crate::prediction::Prediction;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Predictions shown in a section; the rest is in predictions.csv.
const SHOWN: usize = 30;

/// The whole page, self-contained.
pub fn page(study: &str, settings: &Settings, sections: &[SectionReport], provenance: &Provenance) -> String {
    let title = match (settings.question.as_deref().and_then(|q| q.title.as_deref()), sections) {
        (Some(asked), _) => asked,
        (None, [only]) => only.experiment.title,
        _ => "What does photon mapping’s speed cost in accuracy?",
    };
    let kicker = match (&settings.question, study) {
        (Some(question), _) => format!("study {}", question.stem()),
        (None, "study") => "the whole study".to_string(),
        (None, experiment) => format!("experiment {experiment}"),
    };
    // A study of the user's own claims nothing.
    let is_judged = settings.question.is_none();
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
                    div.kicker { "turbid · " (kicker) }
                    h1 { (title) }
                    div.byline { (provenance.date) " · " (provenance.settings) " · version " (provenance.version) ", revision " (provenance.revision) }
                }
                @if let [only] = sections {
                    (section(only, false, &mut numbers))
                } @else {
                    (whole_study(sections, &mut numbers))
                }
                @if is_judged {
                    section.behind[sections.len() > 1] id="claims" {
                        @if sections.len() > 1 { h2.flow { "All claims" } } @else { h3 { "Claims" } }
                        (claims::appendix(sections, &mut numbers))
                    }
                    (methods(sections, &mut numbers))
                }
                (circumstances(study, settings, provenance, &mut numbers))
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string()
}

/// Filters the claims by words, and opens what a link or a printer asks for.
const SCRIPT: &str = "
const find = document.getElementById('find');
if (find) find.addEventListener('input', () => {
  const words = find.value.toLowerCase().split(/\\s+/);
  for (const row of document.querySelectorAll('#all-claims tr')) {
    const text = row.textContent.toLowerCase();
    row.hidden = !words.every(word => text.includes(word));
  }
});
function show() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let element = target; element; element = element.parentElement)
    if (element.tagName === 'DETAILS') element.open = true;
  if (target) target.scrollIntoView();
}
addEventListener('hashchange', show);
show();
";

/// The answer first, then the list of contents, then everything else.
fn whole_study(sections: &[SectionReport], numbers: &mut Numbers) -> Markup {
    let (first, others) = match sections {
        [first, others @ ..] if first.experiment.name == ANSWER => (Some(first), others),
        _ => (None, sections),
    };
    let judged: Vec<_> = sections.iter().flat_map(|s| s.judged.iter().cloned()).collect();
    html! {
        @if let Some(answer) = first { (section(answer, false, numbers)) }
        p {
            "A photon map estimates light in fog, water or smoke from stored photons: fast, and biased by design. This study \
             predicts its errors from theory, writes them down, measures them on independent photon maps, and compares them \
             with exact solutions."
        }
        p.verdicts { a href="#claims" { (judged.len()) " claims" } ": " (claims::verdicts(&judged)) }
        (contents(sections))
        @for part in others { (section(part, true, numbers)) }
    }
}

/// A section on one screen: question, headline, first figure; the rest behind a line to open, where there are others.
fn section(part: &SectionReport, is_one_of_many: bool, numbers: &mut Numbers) -> Markup {
    let own = &part.section;
    // The answer is its sentences, its figure and its table.
    let is_whole = !is_one_of_many;
    let first = if is_whole { own.summary.len() } else { 1 };
    // Drawn in the order of the page, which numbers them.
    let figure = own.figures.first().map(|figure| draw(part, figure, numbers));
    let rest = html! {
        @for paragraph in own.summary.iter().skip(first) { p { (paragraph) } }
        @for figure in own.figures.iter().skip(1) { (draw(part, figure, numbers)) }
        @for table in &own.tables { (tables::plain(table, numbers)) }
        @if !part.predictions.is_empty() && !own.rows.is_empty() { (predictions(part, numbers)) }
        @if !own.notes.is_empty() {
            h3 { "Notes" }
            @for note in &own.notes { p.note { (note) } }
        }
    };
    html! {
        section id=(part.experiment.name) {
            @if is_one_of_many {
                h2 { (part.experiment.title) " " a.up href="#contents" title="to the contents" { "↑" } }
            }
            @if part.experiment.name != ANSWER { p.question { (part.experiment.question) } }
            @for paragraph in own.summary.iter().take(first) { p { (paragraph) } }
            @if let Some(figure) = figure { (figure) }
            @if is_one_of_many { (claims::line(part)) }
            @if is_whole { (rest) } @else if has_more(part) { details.rest { summary { (more(part)) } (rest) } }
        }
    }
}

/// Whether there is anything behind the first figure.
fn has_more(part: &SectionReport) -> bool {
    let own = &part.section;
    own.summary.len() > 1 || own.figures.len() > 1 || !own.tables.is_empty() || !own.notes.is_empty()
}

/// What there is.
fn more(part: &SectionReport) -> String {
    let own = &part.section;
    let some = |n: usize, one: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {one}s")),
    };
    let parts = [
        some(own.figures.len().saturating_sub(1), "more figure"),
        some(own.tables.len(), "table"),
        some(part.predictions.len(), "prediction"),
        some(own.notes.len(), "note"),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { "More".to_string() } else { format!("More: {}", parts.join(", ")) }
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
        p {
            "A claim asks what somebody who chooses settings would act on: a predicted error within " (number(percent(PREDICTED))) " %, a width or a "
            "loss at a face within " (number(percent(GEOMETRIC))) " %, an unexplained error within " (number(percent(LEFT_OVER))) " % of the exact value, alike for all of a kind. "
            "Which of them the default study can decide was read from the standard errors of its run with seed 1 (version 0.1.0); the rest are "
            "reported numbers without a verdict. Claims marked † had their margin, statistic or range chosen after their outcome "
            "with the seeds named there had been seen: those seeds cannot judge them."
        }
        h3 { "Five words of this project" }
        dl.words {
            @for (word, meaning) in WORDS { dt { (word) } dd { (meaning) } }
        }
        @if !sections.is_empty() {
            div.behind { (tables::frame(numbers, "Work done. Counts are results and repeat exactly; seconds belong to this machine.", html! {
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
            })) }
        }
    }
}

/// What a reader meets here and in no textbook.
const WORDS: [(&str, &str); 5] = [
    (
        "referee",
        "the library of exact solutions, written without knowledge of the simulator, that every estimate is compared with",
    ),
    (
        "error budget",
        "the predicted terms of a mean error (k nearest, clusters, blur, edge, step, storage), and the test that their sum is what was measured",
    ),
    ("probe", "a place, or a place and a direction, at which every photon map of a group is asked"),
    (
        "cell",
        "the smallest piece of a study: one independent photon map or batch of paths with random numbers of its own, kept on disk",
    ),
    ("left over", "a measured error less the predicted one, in per cent of the exact value"),
];

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
        div.behind {
            (tables::frame(numbers, "Circumstances of the measurement.", html! {
                tbody { @for (name, value) in facts { tr { td { (name) } td { (value) } } } }
            }))
        }
        h3 { "To repeat it" }
        pre { (settings.command(study)) }
        p.behind {
            "The same settings and seed give the same bits in " code { "results.csv" } " on any number of threads. Beside this page: "
            code { "results.csv" } " (every quantity), " code { "claims.csv" } " (the verdicts), " code { "answers.csv" } " (the first table), " code { "headlines.csv" } " and " code { "numbers.tex" } " (headline numbers, the latter as LaTeX commands), " code { "predictions.csv" } ", "
            code { "timing.csv" } ", " code { "provenance.json" } ", " code { "figures/" } " (SVG and PNG for one and for two columns of print, LaTeX, and a table of each figure) and " code { "cells/" } " (every map). "
            "A figure whose table in " code { "figures/" } " was edited is drawn again, here too, by the same command with " code { "--replot" } ": nothing is measured."
        }
    }
}
