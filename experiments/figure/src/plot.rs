//! Where data land on the page.

use crate::extent::Spans;
use crate::layer::{Along, Band};
use crate::mark::{Point, Rect};

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

    pub(crate) fn outline(&self, band: &Band) -> Vec<Point> {
        let mut points = self.path(&band.x, band.interval.iter().map(|i| i.0));
        points.extend(self.path(&band.x, band.interval.iter().map(|i| i.1)).into_iter().rev());
        points
    }

    /// The outline of a bar, from its lower left corner; it stands on zero, on a logarithmic axis below the border.
    pub(crate) fn bar(&self, edges: &[f64], height: f64) -> Vec<Point> {
        let (a, b) = (self.at(edges[0], height), self.at(edges[1], 0.0));
        vec![(a.0, b.1), a, (b.0, a.1), b]
    }

    pub(crate) fn rule(&self, along: Along) -> [Point; 2] {
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
    pub(crate) fn diagonal(&self) -> Vec<Point> {
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
