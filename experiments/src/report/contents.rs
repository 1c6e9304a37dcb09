//! The list of contents: each experiment with its verdicts, its headline and its figures.

use super::claims::{badge, count};
use super::figures::anchor;
use crate::harness::{SectionReport, Verdict};
use maud::{Markup, html};

/// The list, for a study of more than one experiment.
pub(super) fn contents(sections: &[SectionReport]) -> Markup {
    // Figures are numbered through the page, in the order of the sections.
    let mut next = 0;
    html! {
        nav.contents id="contents" aria-label="Contents" {
            ol {
                @for part in sections {
                    li {
                        div.line {
                            a.title href=(format!("#{}", part.experiment.name)) { (part.experiment.title) }
                            span.verdicts {
                                @for verdict in [Verdict::Upheld, Verdict::Rejected, Verdict::Undecided] {
                                    @let n = count(&part.judged, verdict);
                                    @if n > 0 { b { (n) } " " (badge(verdict)) }
                                }
                            }
                        }
                        @if let Some(headline) = part.section.summary.first() { p.headline { (headline) } }
                        @if !part.section.figures.is_empty() {
                            p.places {
                                "Figures"
                                @for figure in &part.section.figures {
                                    @let stem = format!("{}-{}", part.experiment.name, figure.name);
                                    " " a href=(format!("#{}", anchor(&stem))) title=(figure.name) { (increased(&mut next)) }
                                }
                            }
                        }
                    }
                }
                li { div.line { a.title href="#methods" { "How verdicts are reached" } } }
                li { div.line { a.title href="#origin" { "Where this comes from, and how to repeat it" } } }
            }
        }
    }
}

fn increased(next: &mut u32) -> u32 {
    *next += 1;
    *next
}
