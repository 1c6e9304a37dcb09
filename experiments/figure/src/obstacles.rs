//! What a legend must not cover.

use crate::clip;
use crate::layer::Layer;
use crate::mark::Point;
use crate::note::note_box;
use crate::plot::Plot;
use crate::text::Fonts;

/// Places that a legend should leave free, close enough together that none slips through it.
pub(crate) fn between(plot: &Plot, layers: &[Layer], fonts: &Fonts) -> Vec<Point> {
    let mut out = Vec::new();
    let mut along = |path: &[Point]| {
        for piece in clip::polyline(&plot.rect, path) {
            for w in piece.windows(2) {
                let steps = (libm::hypot(w[1].0 - w[0].0, w[1].1 - w[0].1) / 3.0).ceil().max(1.0) as usize;
                let part = |i: usize| i as f64 / steps as f64;
                out.extend(
                    (0..=steps).map(|i| {
                        (w[0].0 + part(i) * (w[1].0 - w[0].0), w[0].1 + part(i) * (w[1].1 - w[0].1))
                    }),
                );
            }
        }
    };
    for layer in layers {
        match layer {
            Layer::Points(l) => {
                for (i, (&x, &y)) in l.x.iter().zip(&l.y).enumerate() {
                    let u = (plot.spans.x.unit(x).clamp(0.0, 1.0), plot.spans.y.unit(y).clamp(0.0, 1.0));
                    let p = (plot.x_at(u.0), plot.y_at(u.1));
                    along(&[p, p]);
                    if let Some(intervals) = &l.x_interval {
                        along(&[plot.at(intervals[i].0, y), plot.at(intervals[i].1, y)]);
                    }
                    if let Some(intervals) = &l.y_interval {
                        along(&[plot.at(x, intervals[i].0), plot.at(x, intervals[i].1)]);
                    }
                }
            }
            Layer::Line(l) => along(&plot.path(&l.x, l.y.iter().copied())),
            Layer::Band(l) => {
                for (i, w) in l.x.windows(2).enumerate() {
                    for part in 0..=8 {
                        let f = f64::from(part) / 8.0;
                        let mix = |a: f64, b: f64| a + f * (b - a);
                        let (p, q) = (l.interval[i], l.interval[i + 1]);
                        along(&[plot.at(w[0], mix(p.0, p.1)), plot.at(w[1], mix(q.0, q.1))]);
                    }
                }
            }
            Layer::Histogram(l) => {
                for (edges, &height) in l.edges.windows(2).zip(&l.heights) {
                    let bar = plot.bar(edges, height);
                    along(&bar);
                }
            }
            Layer::Note(l) => along(&note_box(plot, l, fonts).1.corners()),
            // A map is everywhere; a rule may pass behind a legend, whose paper is opaque.
            Layer::Heatmap(_) | Layer::Rule(_) => {}
        }
    }
    out
}
