//! Histograms and heat maps as marks.

use crate::clip;
use crate::extent::colors;
use crate::layer::{Align, At, Heatmap, Histogram, Note};
use crate::mark::{Mark, Paint, Point};
use crate::note;
use crate::palette::Dash;
use crate::plot::Plot;
use crate::style::{HATCH, light, stroke};
use crate::text::Fonts;

/// Bars with their outline, and the counts of what lies beyond them.
pub(crate) fn histogram(
    plot: &Plot,
    l: &Histogram,
    fonts: &Fonts,
    marks: &mut Vec<Mark>,
    last: &mut Vec<Mark>,
) {
    let mut top: Vec<Point> = Vec::new();
    for (edges, &height) in l.edges.windows(2).zip(&l.heights) {
        let bar = plot.bar(edges, height);
        let area = clip::polygon(&plot.rect, &bar);
        if area.len() > 2 {
            marks.push(Mark::Area { points: area, paint: light(l.color) });
        }
        if top.is_empty() {
            top.push(bar[0]);
        }
        top.extend([bar[1], bar[2]]);
        // A stroke between neighbours keeps the bins countable.
        stroke(&plot.rect, &[bar[2], bar[3]], 0.35, l.color, Dash::Solid, marks);
    }
    if let (Some(&end), Some(&edge)) = (top.last(), l.edges.last()) {
        top.push((end.0, plot.at(edge, 0.0).1));
    }
    stroke(&plot.rect, &top, 0.8, l.color, Dash::Solid, marks);
    for (count, text, at, align) in [
        (l.below, format!("← {} below", l.below), 0.012, Align::Start),
        (l.above, format!("{} above →", l.above), 0.988, Align::End),
    ] {
        if count > 0 {
            let note = Note { text, at: At::Fraction(at, 0.16), align };
            note::note(plot, &note, fonts, last);
        }
    }
}

/// Lines across the cells that need them, on levels counted from the bottom of the plot.
fn hatch(plot: &Plot, l: &Heatmap, marks: &mut Vec<Mark>) {
    let span = colors(l);
    let columns = l.x_edges.len() - 1;
    for (row, y) in l.values.chunks(columns).zip(l.y_edges.windows(2)) {
        let (low, high) = (plot.at(l.x_edges[0], y[0]).1, plot.at(l.x_edges[0], y[1]).1);
        let bottom = plot.rect.bottom();
        let level = |place: f64| ((bottom - place) / HATCH.0 - 0.5).ceil().max(0.0) as usize;
        let most = (plot.rect.height / HATCH.0) as usize;
        let ink = |v: f64| l.shading.hatch(span.unit(v));
        for n in level(low).min(most)..level(high).min(most) {
            let place = bottom - (n as f64 + 0.5) * HATCH.0;
            let mut start = 0;
            for end in 1..=columns {
                if end < columns && ink(row[end]) == ink(row[start]) {
                    continue;
                }
                if let Some(rgb) = ink(row[start]) {
                    let at = |edge: f64| (plot.at(edge, y[0]).0, place);
                    let ends = (at(l.x_edges[start]), at(l.x_edges[end]));
                    if let Some((a, b)) = clip::segment(&plot.rect, ends.0, ends.1) {
                        marks.push(Mark::Stroke {
                            points: vec![a, b],
                            width: HATCH.1,
                            paint: Paint::solid(rgb),
                        });
                    }
                }
                start = end;
            }
        }
    }
}

/// Cells row by row; neighbours of one colour are drawn as one.
pub(crate) fn heatmap(plot: &Plot, l: &Heatmap, marks: &mut Vec<Mark>) {
    /// Each cell reaches this far under the next ones, or seams would show between them [pt].
    const OVERLAP: f64 = 1.0;
    let span = colors(l);
    let columns = l.x_edges.len() - 1;
    for (row, y) in l.values.chunks(columns).zip(l.y_edges.windows(2)) {
        let shade = |v: f64| l.shading.rgb(span.unit(v));
        let mut start = 0;
        for end in 1..=columns {
            if end < columns && shade(row[end]) == shade(row[start]) {
                continue;
            }
            let (a, b) = (plot.at(l.x_edges[start], y[0]), plot.at(l.x_edges[end], y[1]));
            let cell =
                [(a.0, a.1), (a.0, b.1 - OVERLAP), (b.0 + OVERLAP, b.1 - OVERLAP), (b.0 + OVERLAP, a.1)];
            let points = clip::polygon(&plot.rect, &cell);
            if points.len() > 2 {
                marks.push(Mark::Area { points, paint: Paint::solid(shade(row[start])) });
            }
            start = end;
        }
    }
    hatch(plot, l, marks);
}
