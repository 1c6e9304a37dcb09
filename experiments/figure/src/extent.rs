//! The limits of a panel's axes, from its data.

use crate::axis::{Axis, Scale};
use crate::error::Error;
use crate::figure::Panel;
use crate::layer::{Along, Heatmap, Layer};
use crate::palette::Shading;
use crate::scale::{NARROWEST, Span};

/// The limits of the two axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spans {
    pub(crate) x: Span,
    pub(crate) y: Span,
}

/// Smallest and largest of the numbers that have a place on the axis.
struct Extent<'a> {
    axis: &'a Axis,
    limits: Option<(f64, f64)>,
}

impl<'a> Extent<'a> {
    fn of(axis: &'a Axis) -> Self {
        Self { axis, limits: None }
    }

    fn add(&mut self, values: impl IntoIterator<Item = f64>) {
        for v in values {
            if v > 0.0 || !self.axis.scale.is_log() {
                self.limits = Some(self.limits.map_or((v, v), |(a, b)| (a.min(v), b.max(v))));
            }
        }
    }
}

/// The limits of the axes of a panel.
pub(crate) fn spans(number: usize, panel: &Panel) -> Result<Spans, Error> {
    let (mut x, mut y) = (Extent::of(&panel.x), Extent::of(&panel.y));
    let ends = |intervals: &[(f64, f64)]| intervals.iter().flat_map(|i| [i.0, i.1]).collect::<Vec<_>>();
    let (mut bars, mut edge_to_edge) = (false, false);
    for layer in &panel.layers {
        match layer {
            Layer::Points(l) => {
                x.add(l.x.iter().copied());
                y.add(l.y.iter().copied());
                x.add(ends(l.x_interval.as_deref().unwrap_or_default()));
                y.add(ends(l.y_interval.as_deref().unwrap_or_default()));
            }
            Layer::Line(l) => {
                x.add(l.x.iter().copied());
                y.add(l.y.iter().copied());
            }
            Layer::Band(l) => {
                x.add(l.x.iter().copied());
                y.add(ends(&l.interval));
            }
            Layer::Histogram(l) => {
                x.add(l.edges.iter().copied());
                y.add(l.heights.iter().copied());
                y.add([0.0]);
                bars = true;
            }
            Layer::Rule(l) => match l.along {
                Along::Horizontal(v) => y.add([v]),
                Along::Vertical(v) => x.add([v]),
                Along::Diagonal => {}
            },
            Layer::Heatmap(l) => {
                x.add(l.x_edges.iter().copied());
                y.add(l.y_edges.iter().copied());
                edge_to_edge = true;
            }
            Layer::Note(_) => {}
        }
    }
    let diagonal = panel.layers.iter().any(|l| matches!(l, Layer::Rule(r) if r.along == Along::Diagonal));
    if diagonal && panel.x.range.is_none() && panel.y.range.is_none() && panel.x.scale == panel.y.scale {
        let (a, b) = (x.limits, y.limits);
        x.add(b.into_iter().flat_map(|l| [l.0, l.1]));
        y.add(a.into_iter().flat_map(|l| [l.0, l.1]));
    }
    let span = |e: &Extent<'_>, floor| match e.limits.or(e.axis.range) {
        // Only numbers without a place on a clipped logarithmic axis: any decade shows their arrows.
        None if e.axis.scale.is_log() => Ok(Span::of(e.axis, (1.0, 10.0), false)),
        None => Err(Error::Empty { place: format!("panel {number}") }),
        Some(limits) if edge_to_edge && e.axis.range.is_none() && apart(e.axis.scale, limits) => {
            Ok(Span::exact(e.axis.scale, limits))
        }
        Some(limits) => Ok(Span::of(e.axis, limits, floor && limits.0 == 0.0)),
    };
    Ok(Spans { x: span(&x, false)?, y: span(&y, bars)? })
}

/// Whether the limits differ on the scale, and not by rounding alone.
fn apart(scale: Scale, (low, high): (f64, f64)) -> bool {
    let (low, high) = (scale.forward(low), scale.forward(high));
    high - low > (1e-12 * low.abs().max(high.abs())).max(NARROWEST)
}

/// The limits of a colour bar: symmetric about zero where the colours are.
pub(crate) fn colors(map: &Heatmap) -> Span {
    let scale = map.quantity.scale;
    let mut data = Extent::of(&map.quantity);
    data.add(map.values.iter().copied());
    let (low, high) = map.quantity.range.or(data.limits).unwrap_or((1.0, 10.0));
    let limits = match map.shading {
        Shading::Diverging if !scale.is_log() => {
            let limit = low.abs().max(high.abs());
            let limit = if limit > 0.0 { limit } else { 1.0 };
            (-limit, limit)
        }
        _ => (low, high),
    };
    if apart(scale, limits) { Span::exact(scale, limits) } else { Span::around(scale, limits, false) }
}
