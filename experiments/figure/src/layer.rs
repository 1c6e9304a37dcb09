//! What a panel shows: plain lists of numbers, each with a look and a label for the legend.

use crate::axis::Axis;
use crate::palette::{Color, Dash, Marker, Shading};
use serde::{Deserialize, Serialize};

/// Points, with intervals along either axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Entry in the legend; layers of one label share an entry, an empty label has none.
    pub label: String,
    /// Colour of markers and bars.
    pub color: Color,
    /// Shape.
    pub marker: Marker,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// (low, high) along x for each point, drawn as bars with caps.
    pub x_interval: Option<Vec<(f64, f64)>>,
    /// (low, high) along y for each point, drawn as bars with caps.
    pub y_interval: Option<Vec<(f64, f64)>>,
}

impl Points {
    /// Points in the colour and shape of a class, without intervals.
    #[must_use]
    pub fn new(label: impl Into<String>, class: usize, x: Vec<f64>, y: Vec<f64>) -> Self {
        let (color, marker) = (Color::Class(class), Marker::of_class(class));
        Self { label: label.into(), color, marker, x, y, x_interval: None, y_interval: None }
    }

    /// The same points with intervals along y.
    #[must_use]
    pub fn with_y_interval(mut self, interval: Vec<(f64, f64)>) -> Self {
        self.y_interval = Some(interval);
        self
    }

    /// The same points with intervals along x.
    #[must_use]
    pub fn with_x_interval(mut self, interval: Vec<(f64, f64)>) -> Self {
        self.x_interval = Some(interval);
        self
    }
}

/// Straight pieces through the points in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Entry in the legend.
    pub label: String,
    /// Colour.
    pub color: Color,
    /// Pattern.
    pub dash: Dash,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
}

impl Line {
    /// A line in the colour and pattern of a class.
    #[must_use]
    pub fn new(label: impl Into<String>, class: usize, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), color: Color::Class(class), dash: Dash::of_class(class), x, y }
    }

    /// A solid black line: theory, or what is exact.
    #[must_use]
    pub fn theory(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), color: Color::Black, dash: Dash::Solid, x, y }
    }

    /// The same line in another pattern.
    #[must_use]
    pub fn with_dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }
}

/// The area between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Entry in the legend.
    pub label: String,
    /// Colour, drawn light.
    pub color: Color,
    /// Abscissae.
    pub x: Vec<f64>,
    /// (low, high) at each abscissa.
    pub interval: Vec<(f64, f64)>,
}

impl Band {
    /// A band in the colour of a class.
    #[must_use]
    pub fn new(label: impl Into<String>, class: usize, x: Vec<f64>, interval: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), color: Color::Class(class), x, interval }
    }
}

/// Bars over bins, standing on zero (on a logarithmic axis, on the border).
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Entry in the legend.
    pub label: String,
    /// Colour.
    pub color: Color,
    /// Edges of the bins, one more than heights.
    pub edges: Vec<f64>,
    /// Height of each bar.
    pub heights: Vec<f64>,
    /// Values below the first edge, said beside the bars.
    pub below: usize,
    /// Values above the last edge, said beside the bars.
    pub above: usize,
}

impl Histogram {
    /// Bars of given heights in the colour of a class.
    #[must_use]
    pub fn new(label: impl Into<String>, class: usize, edges: Vec<f64>, heights: Vec<f64>) -> Self {
        Self { label: label.into(), color: Color::Class(class), edges, heights, below: 0, above: 0 }
    }

    /// The density of values, to be held against a probability density.
    ///
    /// height = count / (n * width of the bin), n counting **all** values: bars and those outside sum to 1.
    /// A value on an edge belongs to the bin above it; on the last edge, to the last bin.
    #[must_use]
    pub fn density(label: impl Into<String>, class: usize, values: &[f64], edges: Vec<f64>) -> Self {
        let bins = edges.len().saturating_sub(1);
        let mut counts = vec![0_usize; bins];
        let (mut below, mut above) = (0, 0);
        for v in values {
            let at_or_below = edges.partition_point(|e| e <= v);
            match at_or_below {
                0 => below += 1,
                i if i <= bins => counts[i - 1] += 1,
                _ if bins > 0 && edges[bins] == *v => counts[bins - 1] += 1,
                _ => above += 1,
            }
        }
        let n = values.len().max(1) as f64;
        let heights =
            counts.iter().zip(edges.windows(2)).map(|(&c, e)| c as f64 / (n * (e[1] - e[0]))).collect();
        Self { label: label.into(), color: Color::Class(class), edges, heights, below, above }
    }
}

/// Where a rule runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Across the panel at this ordinate.
    Horizontal(f64),
    /// Up the panel at this abscissa.
    Vertical(f64),
    /// Where y = x. Axes without given ranges then get the same one.
    Diagonal,
}

/// A thin line from border to border.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Entry in the legend.
    pub label: String,
    /// Colour.
    pub color: Color,
    /// Pattern.
    pub dash: Dash,
    /// Where.
    pub along: Along,
}

impl Rule {
    /// A grey unbroken rule without an entry in the legend.
    #[must_use]
    pub fn new(along: Along) -> Self {
        Self { label: String::new(), color: Color::Grey, dash: Dash::Solid, along }
    }

    /// The same rule with an entry in the legend.
    #[must_use]
    pub fn with_label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// The same rule in another pattern.
    #[must_use]
    pub fn with_dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }
}

/// Colours over a grid of cells, with a colour bar. One to a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Heatmap {
    /// Borders between columns, one more than columns.
    pub x_edges: Vec<f64>,
    /// Borders between rows, one more than rows.
    pub y_edges: Vec<f64>,
    /// One number a cell: all columns of the first row (lowest y), then the next row.
    pub values: Vec<f64>,
    /// Colours.
    pub shading: Shading,
    /// What the colours mean. With a range, values beyond it take the end colour and the bar ends in an arrow.
    pub quantity: Axis,
}

/// Which way text extends from where it is put.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Align {
    /// To the right.
    Start,
    /// Both ways.
    Middle,
    /// To the left.
    End,
}

/// Where text is put.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum At {
    /// At data coordinates.
    Data(f64, f64),
    /// At fractions of the panel, (0, 0) bottom left.
    Fraction(f64, f64),
}

/// A short text in the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// The text.
    pub text: String,
    /// Where its end or middle stands.
    pub at: At,
    /// Which way it extends.
    pub align: Align,
}

/// One thing that a panel shows. Whatever the order in the list, maps and bands lie under rules, lines and points.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Layer {
    /// Points with intervals.
    Points(Points),
    /// A line.
    Line(Line),
    /// The area between two curves.
    Band(Band),
    /// Bars over bins.
    Histogram(Histogram),
    /// A thin line from border to border.
    Rule(Rule),
    /// Colours over a grid.
    Heatmap(Heatmap),
    /// A short text.
    Note(Note),
}

macro_rules! layer_from {
    ($($kind:ident),*) => {$(
        impl From<$kind> for Layer {
            fn from(layer: $kind) -> Self {
                Self::$kind(layer)
            }
        }
    )*};
}
layer_from!(Points, Line, Band, Histogram, Rule, Heatmap, Note);

impl Layer {
    /// The entry in the legend; empty for none.
    pub(crate) fn label(&self) -> &str {
        match self {
            Self::Points(l) => &l.label,
            Self::Line(l) => &l.label,
            Self::Band(l) => &l.label,
            Self::Histogram(l) => &l.label,
            Self::Rule(l) => &l.label,
            Self::Heatmap(_) | Self::Note(_) => "",
        }
    }

    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Points(_) => "points",
            Self::Line(_) => "line",
            Self::Band(_) => "band",
            Self::Histogram(_) => "histogram",
            Self::Rule(_) => "rule",
            Self::Heatmap(_) => "heatmap",
            Self::Note(_) => "note",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_counts_every_value_once() {
        let values = [-7.0, -1.0, -0.5, 0.0, 0.25, 1.0, 1.5, 2.0, 2.1, 9.0];
        let h = Histogram::density("", 0, &values, vec![-1.0, 0.0, 1.0, 2.0]);
        assert_eq!((h.below, h.above), (1, 2));
        assert_eq!(h.heights, [0.2, 0.2, 0.3]);
        let wide = Histogram::density("", 0, &values, vec![-10.0, 0.0, 10.0]);
        assert_eq!(wide.heights, [0.03, 0.07]);
    }
}
