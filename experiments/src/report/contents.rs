//! The list of contents: each experiment with its verdicts and its figures.

use super::claims;
use super::figures::anchor;
use crate::harness::SectionReport;
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
                        a.title href=(format!("#{}", part.experiment.name)) { (part.experiment.title) }
                        span.places {
                            @for figure in &part.section.figures {
                                @let stem = format!("{}-{}", part.experiment.name, figure.name);
                                " " a href=(format!("#{}", anchor(&stem))) title=(figure.name) { "Fig. " (increased(&mut next)) }
                            }
                        }
                        span.verdicts { (claims::verdicts(&part.judged)) }
                    }
                }
                li { a.title href="#claims" { "All claims" } }
                li { a.title href="#methods" { "How verdicts are reached, and five words" } }
                li { a.title href="#origin" { "Where this comes from, and how to repeat it" } }
            }
        }
    }
}

fn increased(next: &mut u32) -> u32 {
    *next += 1;
    *next
}
