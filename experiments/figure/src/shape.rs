//! Markers and arrows.

use crate::mark::{Mark, Paint, Point};
use crate::palette::{Color, Marker};

/// Length of an arrow [pt].
pub(crate) const ARROW: f64 = 5.0;

/// The corners of a marker about as heavy as a disc of this radius, relative to its centre; none for the disc itself.
pub(crate) fn corners(shape: Marker, radius: f64) -> Vec<Point> {
    /// Half the width of a cross's arms.
    const ARM: f64 = 0.27;
    // Distances that give the first shapes the area of the disc: pi r^2 = 2 d^2 (square), 1.299 d^2 (triangle).
    let turns: &[(f64, f64)] = match shape {
        Marker::Circle => &[],
        Marker::Square => &[(-0.886, -0.886), (0.886, -0.886), (0.886, 0.886), (-0.886, 0.886)],
        Marker::Diamond => &[(0.0, -1.253), (1.253, 0.0), (0.0, 1.253), (-1.253, 0.0)],
        Marker::Triangle => &[(0.0, -1.555), (1.347, 0.778), (-1.347, 0.778)],
        Marker::TriangleDown => &[(0.0, 1.555), (1.347, -0.778), (-1.347, -0.778)],
        Marker::Cross | Marker::Plus => &[
            (ARM, -1.25),
            (ARM, -ARM),
            (1.25, -ARM),
            (1.25, ARM),
            (ARM, ARM),
            (ARM, 1.25),
            (-ARM, 1.25),
            (-ARM, ARM),
            (-1.25, ARM),
            (-1.25, -ARM),
            (-ARM, -ARM),
            (-ARM, -1.25),
        ],
    };
    let s = std::f64::consts::FRAC_1_SQRT_2;
    let turned =
        |(x, y): (f64, f64)| if shape == Marker::Cross { (s * (x - y), s * (x + y)) } else { (x, y) };
    turns.iter().map(|&t| turned(t)).map(|(x, y)| (radius * x, radius * y)).collect()
}

/// An arrow head whose tip touches the border, for a point that lies beyond it in this direction.
pub(crate) fn arrow(tip: Point, (dx, dy): (f64, f64), color: Color, marks: &mut Vec<Mark>) {
    let norm = libm::hypot(dx, dy);
    let (dx, dy) = (dx / norm, dy / norm);
    for (length, half, paint) in [(ARROW + 0.8, 2.9, Paint::PAPER), (ARROW, 2.1, Paint::solid(color.rgb()))] {
        let foot = (tip.0 - length * dx, tip.1 - length * dy);
        let points =
            vec![tip, (foot.0 - half * dy, foot.1 + half * dx), (foot.0 + half * dy, foot.1 - half * dx)];
        marks.push(Mark::Area { points, paint });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Point]) -> f64 {
        let next = points.iter().cycle().skip(1);
        0.5 * points.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>().abs()
    }

    #[test]
    fn filled_markers_are_as_heavy_as_the_disc() {
        for shape in [Marker::Square, Marker::Diamond, Marker::Triangle, Marker::TriangleDown] {
            // The distances have three digits, an area twice their relative error.
            let ratio = area(&corners(shape, 2.0)) / (4.0 * std::f64::consts::PI);
            assert!((ratio - 1.0).abs() < 2e-3, "{shape:?}: {ratio}");
        }
    }

    #[test]
    fn the_cross_is_the_plus_turned() {
        let far = |shape| corners(shape, 1.0).iter().map(|p| libm::hypot(p.0, p.1)).fold(0.0, f64::max);
        assert!((far(Marker::Cross) - far(Marker::Plus)).abs() < 1e-14);
        assert!((area(&corners(Marker::Cross, 1.0)) - area(&corners(Marker::Plus, 1.0))).abs() < 1e-14);
    }
}
