//! Figures for print: plain numbers in, SVG, PNG and LaTeX out, with an embedded font (DejaVu Sans).
//!
//! A [`Figure`] is a grid of [`Panel`]s; a panel has two [`Axis`] and a list of [`Layer`]s. Nothing is lost without a
//! word: numbers that are not finite are refused, points beyond a given range become arrows at the border, values
//! beyond a histogram are counted beside it. The same figure gives the same bytes on every machine. Nothing is written
//! to disk: the caller does that.
//!
//! ```
//! use turbid_figure::{Axis, Figure, Line, Panel, Points};
//!
//! let photons = vec![1e3, 1e4, 1e5];
//! let measured = Points::new("measured", 0, photons.clone(), vec![0.31, 0.11, 0.033])
//!     .with_y_interval(vec![(0.26, 0.36), (0.09, 0.13), (0.028, 0.038)]);
//! let theory = Line::theory("N to the -1/2", photons, vec![0.316, 0.1, 0.0316]);
//! let panel = Panel::new(Axis::log("Photons emitted", ""), Axis::log("Relative error", "")).with(theory).with(measured);
//! let svg = Figure::new(vec![panel]).svg()?;
//! assert!(svg.contains("Photons emitted"));
//! # Ok::<(), turbid_figure::Error>(())
//! ```

mod areas;
mod axis;
mod check;
mod clip;
mod crowd;
mod draw;
mod error;
mod extent;
mod figure;
mod frame;
mod layer;
mod legend;
mod mark;
mod note;
mod number;
mod obstacles;
mod output;
mod page;
mod palette;
mod plot;
mod png;
mod relayout;
mod scale;
mod shape;
mod style;
mod svg;
mod table;
mod tex;
mod text;
mod ticks;
#[cfg(test)]
mod vision;

pub use axis::{Axis, Scale};
pub use error::Error;
pub use figure::{Corner, Figure, Legend, Panel, Width};
pub use layer::{Align, Along, At, Band, Heatmap, Histogram, Layer, Line, Note, Points, Rule};
pub use palette::{Color, Dash, Marker, Shading};
pub use tex::latex;
