//! Notes as marks.

use crate::layer::{Align, At, Note};
use crate::mark::{Mark, Paint, Point, Rect};
use crate::plot::Plot;
use crate::text::{Fonts, SMALL, plain};

/// Where a note is put, and the paper behind it.
pub(crate) fn note_box(plot: &Plot, l: &Note, fonts: &Fonts) -> (Point, Rect) {
    let at = match l.at {
        At::Data(x, y) => plot.at(x, y),
        At::Fraction(x, y) => (plot.x_at(x), plot.y_at(y)),
    };
    let width = fonts.width(&l.text, SMALL, false);
    let left = match l.align {
        Align::Start => at.0,
        Align::Middle => at.0 - 0.5 * width,
        Align::End => at.0 - width,
    };
    (at, Rect { left, top: at.1 - SMALL, width, height: 1.3 * SMALL })
}

pub(crate) fn note(plot: &Plot, l: &Note, fonts: &Fonts, marks: &mut Vec<Mark>) {
    let (at, rect) = note_box(plot, l, fonts);
    marks.push(Mark::Area { points: rect.corners(), paint: Paint { alpha: 0.8, ..Paint::PAPER } });
    marks.push(Mark::Text(plain(&l.text, at, l.align, SMALL)));
}
