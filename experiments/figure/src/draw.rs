//! The layers of a panel as marks.

use crate::areas::{heatmap, histogram};
use crate::clip;
use crate::crowd::Look;
use crate::layer::{Along, Layer, Points};
use crate::mark::{Mark, Point};
use crate::note::note;
use crate::plot::Plot;
use crate::shape;
use crate::style::{LINE, RULE, light, stroke};
use crate::text::Fonts;

/// At most this many arrows stand in a row before they hide each other.
const STACK: usize = 8;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Scale;
    use crate::extent::Spans;
    use crate::layer::Line;
    use crate::mark::Rect;
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
