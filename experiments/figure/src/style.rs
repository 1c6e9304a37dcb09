//! Widths, opacities and strokes that everything drawn shares.

use crate::clip;
use crate::mark::{Mark, Paint, Point, Rect};
use crate::palette::{Color, Dash};

/// Width of lines of data [pt].
pub(crate) const LINE: f64 = 1.1;

/// Width of rules [pt].
pub(crate) const RULE: f64 = 0.7;

/// Opacity of bands and bars.
pub(crate) const LIGHT: f64 = 0.28;

pub(crate) fn light(color: Color) -> Paint {
    Paint { rgb: color.rgb(), alpha: LIGHT }
}

/// A line in its pattern, cut at the border.
pub(crate) fn stroke(
    rect: &Rect,
    points: &[Point],
    width: f64,
    color: Color,
    dash: Dash,
    marks: &mut Vec<Mark>,
) {
    let pattern: Vec<f64> = dash.pattern().iter().map(|d| d * width).collect();
    let paint = Paint::solid(color.rgb());
    for piece in clip::polyline(rect, points) {
        marks.extend(clip::dashes(&piece, &pattern).into_iter().map(|points| Mark::Stroke {
            points,
            width,
            paint,
        }));
    }
}

/// Distance and width of the lines that tell a sign [pt].
pub(crate) const HATCH: (f64, f64) = (3.0, 0.25);
