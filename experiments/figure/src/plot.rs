//! The layers of a panel as marks.

use crate::areas::{heatmap, histogram};
use crate::clip;
use crate::crowd::Look;
use crate::extent::Spans;
use crate::layer::{Align, Along, At, Band, Layer, Note, Points};
use crate::mark::{Mark, Paint, Point, Rect};
use crate::palette::{Color, Dash};
use crate::shape;
use crate::text::{Fonts, SMALL, plain};

/// Width of lines of data [pt].
pub(crate) const LINE: f64 = 1.1;
/// Width of rules [pt].
pub(crate) const RULE: f64 = 0.7;
/// Opacity of bands and bars.
pub(crate) const LIGHT: f64 = 0.28;
/// At most this many arrows stand in a row before they hide each other.
const STACK: usize = 8;

/// A rectangle on the page with its axes.
pub(crate) struct Plot {
    pub(crate) rect: Rect,
    pub(crate) spans: Spans,
}

impl Plot {
    /// The place of data coordinates.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        (self.x_at(self.spans.x.unit(x)), self.y_at(self.spans.y.unit(y)))
    }

    pub(crate) fn x_at(&self, unit: f64) -> f64 {
        self.rect.left + unit * self.rect.width
    }

    pub(crate) fn y_at(&self, unit: f64) -> f64 {
        self.rect.bottom() - unit * self.rect.height
    }

    pub(crate) fn path(&self, x: &[f64], y: impl IntoIterator<Item = f64>) -> Vec<Point> {
        x.iter().zip(y).map(|(&x, y)| self.at(x, y)).collect()
    }

    fn outline(&self, band: &Band) -> Vec<Point> {
        let mut points = self.path(&band.x, band.interval.iter().map(|i| i.0));
        points.extend(self.path(&band.x, band.interval.iter().map(|i| i.1)).into_iter().rev());
        points
    }

    /// The outline of a bar, from its lower left corner; it stands on zero, on a logarithmic axis below the border.
    pub(crate) fn bar(&self, edges: &[f64], height: f64) -> Vec<Point> {
        let (a, b) = (self.at(edges[0], height), self.at(edges[1], 0.0));
        vec![(a.0, b.1), a, (b.0, a.1), b]
    }

    fn rule(&self, along: Along) -> [Point; 2] {
        let r = &self.rect;
        match along {
            Along::Horizontal(v) => {
                let y = self.y_at(self.spans.y.unit(v));
                [(r.left, y), (r.right(), y)]
            }
            Along::Vertical(v) => {
                let x = self.x_at(self.spans.x.unit(v));
                [(x, r.bottom()), (x, r.top)]
            }
            Along::Diagonal => [(0.0, 0.0), (1.0, 1.0)].map(|(a, b)| (self.x_at(a), self.y_at(b))),
        }
    }

    /// The line y = x, bent where the scales differ.
    fn diagonal(&self) -> Vec<Point> {
        let (x, y) = (&self.spans.x, &self.spans.y);
        if x.scale == y.scale {
            let (low, high) = (x.low.max(y.low), x.high.min(y.high));
            return [low, high]
                .map(|t| (self.x_at(x.unit_of_transformed(t)), self.y_at(y.unit_of_transformed(t))))
                .to_vec();
        }
        (0..=400)
            .map(|i| x.scale.backward(x.low + (x.high - x.low) * f64::from(i) / 400.0))
            .map(|v| self.at(v, v))
            .collect()
    }
}

/// Draws all layers: what covers areas first, then rules, lines, bars of intervals, points, notes.
pub(crate) fn draw(plot: &Plot, layers: &[Layer], fonts: &Fonts, marks: &mut Vec<Mark>) {
    let look = Look::of(layers);
    let mut late = Vec::new();
    let mut last = Vec::new();
    let mut lines = Vec::new();
    for layer in layers {
        match layer {
            Layer::Heatmap(l) => heatmap(plot, l, marks),
            Layer::Band(l) => {
                let points = clip::polygon(&plot.rect, &plot.outline(l));
                marks.push(Mark::Area { points, paint: light(l.color) });
            }
            Layer::Histogram(l) => histogram(plot, l, fonts, marks, &mut last),
            Layer::Rule(l) => {
                let points =
                    if l.along == Along::Diagonal { plot.diagonal() } else { plot.rule(l.along).to_vec() };
                stroke(&plot.rect, &points, RULE, l.color, l.dash, &mut late);
            }
            Layer::Line(l) => {
                stroke(&plot.rect, &plot.path(&l.x, l.y.iter().copied()), LINE, l.color, l.dash, &mut lines)
            }
            Layer::Points(_) => {}
            Layer::Note(l) => note(plot, l, fonts, &mut last),
        }
    }
    marks.append(&mut late);
    marks.append(&mut lines);
    for layer in layers {
        if let Layer::Points(l) = layer {
            bars(plot, l, &look, marks);
        }
    }
    let mut tips = Vec::new();
    for turn in 0..look.turns {
        for layer in layers {
            if let Layer::Points(l) = layer {
                points(plot, l, turn, &look, &mut tips, marks);
            }
        }
    }
    marks.append(&mut last);
}

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

/// Bars of intervals with caps; an end beyond the border has no cap.
fn bars(plot: &Plot, l: &Points, look: &Look, marks: &mut Vec<Mark>) {
    let (width, cap, paint) = (look.bar, look.cap, look.bar_paint(l));
    let mut bar = |a: Point, b: Point, across: Point| {
        if let Some((p, q)) = clip::segment(&plot.rect, a, b) {
            marks.push(Mark::Stroke { points: vec![p, q], width, paint });
            for end in [a, b] {
                if cap > 0.0 && plot.rect.grown(1e-6).contains(end) {
                    let points =
                        vec![(end.0 - across.0, end.1 - across.1), (end.0 + across.0, end.1 + across.1)];
                    marks.push(Mark::Stroke { points, width, paint });
                }
            }
        }
    };
    for (i, (&x, &y)) in l.x.iter().zip(&l.y).enumerate() {
        if let Some(intervals) = &l.x_interval {
            bar(plot.at(intervals[i].0, y), plot.at(intervals[i].1, y), (0.0, cap));
        }
        if let Some(intervals) = &l.y_interval {
            bar(plot.at(x, intervals[i].0), plot.at(x, intervals[i].1), (cap, 0.0));
        }
    }
}

/// Markers of one turn; arrows at the border for points beyond it, moved inwards where they would hide each other.
fn points(plot: &Plot, l: &Points, turn: usize, look: &Look, tips: &mut Vec<Point>, marks: &mut Vec<Mark>) {
    let side = |unit: f64| if unit < -1e-9 { -1.0 } else { f64::from(unit > 1.0 + 1e-9) };
    for (&x, &y) in l.x.iter().zip(&l.y).skip(turn).step_by(look.turns) {
        let (u, v) = (plot.spans.x.unit(x), plot.spans.y.unit(y));
        let (right, down) = (side(u), -side(v));
        if right == 0.0 && down == 0.0 {
            marks.push(look.symbol(l, plot.at(x, y)));
            continue;
        }
        let mut tip = (plot.x_at(u.clamp(0.0, 1.0)), plot.y_at(v.clamp(0.0, 1.0)));
        let taken = |p: Point| tips.iter().any(|t| libm::hypot(t.0 - p.0, t.1 - p.1) < 0.9 * shape::ARROW);
        for _ in 0..STACK {
            if taken(tip) {
                tip = (tip.0 - shape::ARROW * right, tip.1 - shape::ARROW * down);
            }
        }
        tips.push(tip);
        shape::arrow(tip, (right, down), l.color, marks);
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Scale;
    use crate::layer::Line;
    use crate::scale::Span;

    fn plot(x: Span, y: Span) -> Plot {
        Plot { rect: Rect { left: 30.0, top: 10.0, width: 200.0, height: 100.0 }, spans: Spans { x, y } }
    }

    #[test]
    fn data_land_where_the_scales_say() {
        let p = plot(Span::exact(Scale::Log, (1.0, 1e4)), Span::exact(Scale::Linear, (-1.0, 1.0)));
        assert_eq!(p.at(1.0, -1.0), (30.0, 110.0));
        assert_eq!(p.at(100.0, 0.5), (130.0, 35.0));
        assert_eq!(p.at(1e4, 1.0), (230.0, 10.0));
    }

    #[test]
    fn a_line_keeps_its_slope_beyond_the_border() {
        // From (0, 0) to (1, 1e6): at the upper border, y = 1, x is 1e-6 of the width.
        let p = plot(Span::exact(Scale::Linear, (0.0, 1.0)), Span::exact(Scale::Linear, (0.0, 1.0)));
        let mut marks = Vec::new();
        let line = Line::new("", 0, vec![0.0, 1.0], vec![0.0, 1e6]);
        draw(&p, &[line.into()], &Fonts::load().unwrap(), &mut marks);
        let [Mark::Stroke { points, .. }] = marks.as_slice() else { panic!("{marks:?}") };
        assert!(
            (points[1].0 - 30.0 - 200e-6).abs() < 1e-9 && (points[1].1 - 10.0).abs() < 1e-9,
            "{points:?}"
        );
    }

    #[test]
    fn arrows_at_one_place_stand_in_a_row() {
        let p = plot(Span::exact(Scale::Linear, (0.0, 1.0)), Span::exact(Scale::Linear, (0.0, 1.0)));
        let mut marks = Vec::new();
        let points = Points::new("", 0, vec![0.5; 3], vec![-1.0, -2.0, -3.0]);
        draw(&p, &[points.into()], &Fonts::load().unwrap(), &mut marks);
        let tips: Vec<f64> = marks
            .iter()
            .filter_map(|m| if let Mark::Area { points, .. } = m { Some(points[0].1) } else { None })
            .collect();
        assert_eq!(tips, [110.0, 110.0, 105.0, 105.0, 100.0, 100.0]);
    }

    #[test]
    fn the_diagonal_is_where_y_is_x_even_between_unlike_scales() {
        let p = plot(Span::exact(Scale::Linear, (0.0, 10.0)), Span::exact(Scale::Log, (1.0, 100.0)));
        for q in p.diagonal().iter().filter(|q| p.rect.contains(**q)) {
            let x = 10.0 * (q.0 - 30.0) / 200.0;
            let y = libm::exp10(2.0 * (110.0 - q.1) / 100.0);
            assert!((x / y - 1.0).abs() < 1e-12, "{x} {y}");
        }
    }
}
