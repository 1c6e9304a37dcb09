//! Lines and areas cut at the border of a plot, and lines cut into dashes.

use crate::mark::{Point, Rect};

/// The part of the segment inside the rectangle (Liang and Barsky 1984).
pub(crate) fn segment(r: &Rect, a: Point, b: Point) -> Option<(Point, Point)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
    for (p, q) in [(-dx, a.0 - r.left), (dx, r.right() - a.0), (-dy, a.1 - r.top), (dy, r.bottom() - a.1)] {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            t0 = t0.max(q / p);
        } else {
            t1 = t1.min(q / p);
        }
    }
    let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    // Ends that were inside stay bit for bit, so that neighbouring pieces join.
    (t0 <= t1).then(|| (if t0 == 0.0 { a } else { at(t0) }, if t1 == 1.0 { b } else { at(t1) }))
}

/// The pieces of a line inside the rectangle.
pub(crate) fn polyline(r: &Rect, points: &[Point]) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for w in points.windows(2) {
        let Some((a, b)) = segment(r, w[0], w[1]) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&a) => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// The part of an area inside the rectangle (Sutherland and Hodgman 1974).
pub(crate) fn polygon(r: &Rect, points: &[Point]) -> Vec<Point> {
    let mut out = points.to_vec();
    for (vertical, border, sign) in
        [(true, r.left, 1.0), (true, r.right(), -1.0), (false, r.top, 1.0), (false, r.bottom(), -1.0)]
    {
        let along = |p: Point| if vertical { p.0 } else { p.1 };
        let depth = |p: Point| sign * (along(p) - border);
        let input = std::mem::take(&mut out);
        for (i, &b) in input.iter().enumerate() {
            let a = input[(i + input.len() - 1) % input.len()];
            let (da, db) = (depth(a), depth(b));
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                out.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
            if db >= 0.0 {
                out.push(b);
            }
        }
    }
    out
}

/// A line cut into strokes and gaps of these lengths in turn; the whole line where there are none.
pub(crate) fn dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    if pattern.is_empty() {
        return vec![points.to_vec()];
    }
    let mut strokes: Vec<Vec<Point>> = Vec::new();
    let (mut phase, mut left, mut drawing) = (0, pattern[0], true);
    if let Some(&first) = points.first() {
        strokes.push(vec![first]);
    }
    for w in points.windows(2) {
        let (a, b) = (w[0], w[1]);
        let length = libm::hypot(b.0 - a.0, b.1 - a.1);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let t = done / length;
            let p = (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
            match (drawing, strokes.last_mut()) {
                (true, Some(stroke)) => stroke.push(p),
                _ => strokes.push(vec![p]),
            }
            drawing = !drawing;
            phase = (phase + 1) % pattern.len();
            left = pattern[phase];
        }
        left -= length - done;
        if drawing && let Some(stroke) = strokes.last_mut() {
            stroke.push(b);
        }
    }
    strokes.retain(|s| s.len() > 1);
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect { left: 0.0, top: 0.0, width: 1.0, height: 1.0 };

    fn area(p: &[Point]) -> f64 {
        (0..p.len())
            .map(|i| (p[i], p[(i + 1) % p.len()]))
            .map(|(a, b)| 0.5 * (a.0 * b.1 - b.0 * a.1))
            .sum::<f64>()
            .abs()
    }

    #[test]
    fn a_line_is_cut_where_it_crosses() {
        assert_eq!(segment(&UNIT, (-1.0, 0.5), (2.0, 0.5)), Some(((0.0, 0.5), (1.0, 0.5))));
        assert_eq!(segment(&UNIT, (-1.0, 1.5), (2.0, 1.5)), None);
        let pieces = polyline(&UNIT, &[(0.2, 0.5), (0.5, 2.0), (0.8, 0.5), (0.9, 0.5)]);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[1].len(), 3);
        assert!((pieces[0][1].0 - 0.3).abs() < 1e-15 && pieces[0][1].1 == 1.0);
    }

    #[test]
    fn an_area_keeps_what_is_inside() {
        let half = polygon(&UNIT, &[(0.0, 0.0), (2.0, 0.0), (0.0, 2.0)]);
        assert!((area(&half) - 1.0).abs() < 1e-15, "the corner opposite lies on the cut");
        let diamond = polygon(&UNIT, &[(0.5, -0.5), (1.5, 0.5), (0.5, 1.5), (-0.5, 0.5)]);
        assert!((area(&diamond) - 1.0).abs() < 1e-15);
        assert!(polygon(&UNIT, &[(2.0, 0.0), (3.0, 0.0), (3.0, 1.0)]).is_empty());
    }

    #[test]
    fn dashes_have_their_lengths_and_turn_corners() {
        let strokes = dashes(&[(0.0, 0.0), (3.0, 0.0), (3.0, 7.0)], &[4.0, 2.0]);
        assert_eq!(strokes[0], [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0)]);
        assert_eq!(strokes[1], [(3.0, 3.0), (3.0, 7.0)]);
        assert_eq!(dashes(&[(0.0, 0.0), (1.0, 0.0)], &[]).len(), 1);
    }
}
