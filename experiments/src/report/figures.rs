//! Figures in the page, and new drawings in the place of old ones.

use crate::harness::FigureFiles;
use maud::{Markup, PreEscaped, html};

/// A figure of an experiment with its running number.
pub(super) fn figure(experiment: &str, figure: &FigureFiles, number: u32) -> Markup {
    element(&format!("{experiment}-{}", figure.name), &figure.svg, &figure.caption, &number.to_string())
}

/// The place of a figure in the page; `stem` is the name of its files.
pub(super) fn anchor(stem: &str) -> String {
    format!("figure-{stem}")
}

fn element(stem: &str, svg: &str, caption: &str, number: &str) -> Markup {
    // The declaration before the root element has no place inside a page.
    let drawing = svg.find("<svg").map_or("", |start| &svg[start..]);
    html! {
        figure id=(anchor(stem)) class=[is_narrow(drawing).then_some("narrow")] {
            (PreEscaped(drawing))
            figcaption { b { "Figure " (number) "." } " " (caption) }
        }
    }
}

/// Whether a drawing is made for one column of print.
fn is_narrow(svg: &str) -> bool {
    let width = svg.strip_prefix("<svg width=\"").and_then(|rest| rest.split_once("mm\""));
    width.and_then(|(text, _)| text.parse::<f64>().ok()).is_some_and(|mm| mm < 130.0)
}

/// The page with another drawing and caption of one figure; `None` if the page does not have the figure.
pub fn with_figure(page: &str, stem: &str, svg: &str, caption: &str) -> Option<String> {
    const END: &str = "</figure>";
    let start = page.find(&format!("<figure id=\"{}\"", anchor(stem)))?;
    let end = start + page[start..].find(END)? + END.len();
    let (_, numbered) = page[start..end].split_once("<b>Figure ")?;
    let (number, _) = numbered.split_once('.')?;
    Some(format!("{}{}{}", &page[..start], element(stem, svg, caption, number).into_string(), &page[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_figure_is_replaced_and_keeps_its_number() {
        let old = |stem| element(stem, "<svg width=\"175.00mm\">old</svg>", "Old & worn.", "7").into_string();
        let page = format!("<p>before</p>{}{}<p>after</p>", old("a-b"), old("a-b-c"));
        let svg = "<svg width=\"85.00mm\">new</svg>";
        let new = with_figure(&page, "a-b", svg, "New <here>.").unwrap();
        let expected = format!(
            "<p>before</p><figure id=\"figure-a-b\" class=\"narrow\">{svg}<figcaption><b>Figure 7.</b> \
             New &lt;here&gt;.</figcaption></figure>{}<p>after</p>",
            old("a-b-c")
        );
        assert_eq!(new, expected);
        assert_eq!(with_figure(&page, "a", svg, ""), None);
    }
}
