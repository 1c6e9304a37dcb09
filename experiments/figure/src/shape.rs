//! Markers and arrows.

use crate::mark::{Mark, Paint, Point};
use crate::palette::{Color, Marker};

/// White rim that keeps neighbours apart [pt].
const RIM: f64 = 0.35;
/// Length of an arrow [pt].
pub(crate) const ARROW: f64 = 5.0;

/// A marker about as heavy as a disc of this radius.
pub(crate) fn marker(shape: Marker, (x, y): Point, radius: f64, color: Color, marks: &mut Vec<Mark>) {
    let paint = Paint::solid(color.rgb());
    // Corner distances that give each shape the area of the disc: pi r^2 = 2 d^2 (square), 1.299 d^2 (triangle).
    let turns: &[(f64, f64)] = match shape {
        Marker::Circle => {
            for (radius, paint) in [(radius + RIM, Paint::PAPER), (radius, paint)] {
                marks.push(Mark::Disc { center: (x, y), radius, paint });
            }
            return;
        }
        Marker::Square => &[(-0.886, -0.886), (0.886, -0.886), (0.886, 0.886), (-0.886, 0.886)],
        Marker::Diamond => &[(0.0, -1.253), (1.253, 0.0), (0.0, 1.253), (-1.253, 0.0)],
        Marker::Triangle => &[(0.0, -1.555), (1.347, 0.778), (-1.347, 0.778)],
        Marker::TriangleDown => &[(0.0, 1.555), (1.347, -0.778), (-1.347, -0.778)],
        Marker::Cross | Marker::Plus => {
            let arms =
                if shape == Marker::Cross { [(0.9, 0.9), (0.9, -0.9)] } else { [(1.25, 0.0), (0.0, 1.25)] };
            for (width, paint) in [(0.6 * radius + RIM, Paint::PAPER), (0.5 * radius, paint)] {
                for (dx, dy) in arms {
                    let points = vec![(x - radius * dx, y - radius * dy), (x + radius * dx, y + radius * dy)];
                    marks.push(Mark::Stroke { points, width, paint });
                }
            }
            return;
        }
    };
    for (size, paint) in [(radius + 1.4 * RIM, Paint::PAPER), (radius, paint)] {
        let points = turns.iter().map(|(dx, dy)| (x + size * dx, y + size * dy)).collect();
        marks.push(Mark::Area { points, paint });
    }
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
