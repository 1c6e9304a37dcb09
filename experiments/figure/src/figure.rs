//! Panels in a grid.

use crate::axis::Axis;
use crate::layer::Layer;
use serde::{Deserialize, Serialize};

/// Width in print.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Width {
    /// One column of a journal, 85 mm.
    Single,
    /// Both columns, 175 mm.
    Double,
    /// Any other width, in millimetres.
    Millimetres(f64),
}

impl Width {
    /// The width in millimetres.
    #[must_use]
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Single => 85.0,
            Self::Double => 175.0,
            Self::Millimetres(mm) => mm,
        }
    }
}

/// A corner or a side of the plot, inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it")]
pub enum Corner {
    TopRight,
    TopLeft,
    BottomRight,
    BottomLeft,
    Top,
    Bottom,
    Right,
    Left,
}

/// Where the legend of a panel stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Legend {
    /// Inside where no data are, else below the panel.
    Auto,
    /// Inside, there, whatever it covers.
    Inside(Corner),
    /// Outside, to the right.
    Right,
    /// Outside, below.
    Below,
    /// None.
    Hidden,
}

/// Axes and what stands between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Heading; empty for none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is shown.
    pub layers: Vec<Layer>,
    /// Where the legend stands, unless the figure has one for all panels.
    pub legend: Legend,
}

impl Panel {
    /// A panel without heading, its legend where no data are.
    #[must_use]
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { title: String::new(), x, y, layers: Vec::new(), legend: Legend::Auto }
    }

    /// The same panel with a heading.
    #[must_use]
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The same panel with one more layer.
    #[must_use]
    pub fn with(mut self, layer: impl Into<Layer>) -> Self {
        self.layers.push(layer.into());
        self
    }

    /// The same panel with its legend there.
    #[must_use]
    pub fn with_legend(mut self, legend: Legend) -> Self {
        self.legend = legend;
        self
    }
}

/// A whole figure.
///
/// The same figure gives the same bytes, everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Heading; empty for none, as in a paper, where the caption says it.
    pub title: String,
    /// Width in print.
    pub width: Width,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// Height of the plots of each row over their width; empty for 0.75 in every row.
    pub heights: Vec<f64>,
    /// One legend below for all panels, each entry once, instead of one in each.
    pub shared_legend: bool,
}

impl Figure {
    /// A figure of one column of panels, in the width of one column of print.
    #[must_use]
    pub fn new(panels: Vec<Panel>) -> Self {
        Self {
            title: String::new(),
            width: Width::Single,
            panels,
            columns: 1,
            heights: Vec::new(),
            shared_legend: false,
        }
    }
}
