//! How points are drawn, by how many there are: a cloud of thousands must not become one blot.

use crate::layer::{Layer, Points};
use crate::mark::{Mark, Paint, Point, Symbol};

/// Sizes of markers and bars in a panel [pt].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    /// Radius of a marker, as of a disc.
    pub(crate) radius: f64,
    /// White rim that keeps neighbours apart.
    rim: f64,
    /// Opacity of markers, so that many at one place look darker than one.
    pub(crate) alpha: f64,
    /// Width of bars.
    pub(crate) bar: f64,
    /// Half the length of their caps; none for 0.
    pub(crate) cap: f64,
    /// Lightness of bars, 1 for the full colour: bars hide each other, points hide bars.
    pub(crate) tint: f64,
    /// Layers draw their points in so many turns, so that no layer hides another.
    pub(crate) turns: usize,
}

impl Look {
    /// Few points: markers as in the legend.
    pub(crate) const FEW: Self =
        Self { radius: 2.1, rim: 0.35, alpha: 1.0, bar: 0.75, cap: 1.8, tint: 1.0, turns: 1 };
    /// Neighbours begin to touch.
    const MANY: Self = Self { radius: 1.4, rim: 0.35, alpha: 1.0, bar: 0.45, cap: 0.9, tint: 1.0, turns: 1 };
    /// Bars of neighbours cover each other: they become a pale background without caps.
    const CROWD: Self =
        Self { radius: 1.15, rim: 0.2, alpha: 0.9, bar: 0.35, cap: 0.0, tint: 0.45, turns: 8 };
    /// Points cover each other: small and translucent.
    const CLOUD: Self = Self { radius: 0.9, rim: 0.0, alpha: 0.6, bar: 0.25, cap: 0.0, tint: 0.28, turns: 8 };

    /// The look of the points of a panel.
    pub(crate) fn of(layers: &[Layer]) -> Self {
        match layers.iter().map(|l| if let Layer::Points(p) = l { p.x.len() } else { 0 }).sum::<usize>() {
            0..=60 => Self::FEW,
            61..=250 => Self::MANY,
            251..=900 => Self::CROWD,
            _ => Self::CLOUD,
        }
    }

    pub(crate) fn symbol(&self, l: &Points, center: Point) -> Mark {
        let paint = Paint { rgb: l.color.rgb(), alpha: self.alpha };
        Mark::Symbol(Symbol { shape: l.marker, center, radius: self.radius, paint, rim: self.rim })
    }

    pub(crate) fn bar_paint(&self, l: &Points) -> Paint {
        Paint::tint(l.color.rgb(), self.tint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_points_are_never_drawn_heavier() {
        let of = |n: usize| Look::of(&[Points::new("", 0, vec![0.0; n], vec![0.0; n]).into()]);
        let looks: Vec<Look> = [1, 60, 61, 250, 251, 900, 901, 100_000].into_iter().map(of).collect();
        for w in looks.windows(2) {
            assert!(w[1].radius <= w[0].radius && w[1].bar <= w[0].bar && w[1].tint <= w[0].tint);
            assert!(w[1].alpha <= w[0].alpha && w[1].cap <= w[0].cap);
        }
        // Ink of markers alone, if none covered another, in a plot of 65 by 49 mm (one column): at most a third is
        // covered by 2,000 points.
        let look = of(2000);
        let ink = 2000.0 * std::f64::consts::PI * look.radius * look.radius;
        assert!(ink < 65.0 * 49.0 * (72.0_f64 / 25.4) * (72.0 / 25.4) / 3.0, "{ink}");
    }

    #[test]
    fn layers_of_one_panel_count_together() {
        let points = |n: usize| Layer::from(Points::new("", 0, vec![0.0; n], vec![0.0; n]));
        assert_eq!(Look::of(&[points(40), points(40)]), Look::of(&[points(80)]));
        assert_ne!(Look::of(&[points(40)]), Look::of(&[points(80)]));
    }
}
