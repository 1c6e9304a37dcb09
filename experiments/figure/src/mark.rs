//! What is finally drawn, in points of 1/72 inch, y down: strokes, areas, markers, text.
//!
//! Both formats are made from the same list, so that they show the same thing.

use crate::layer::Align;
use crate::palette::Marker;

/// A place on the page [pt].
pub(crate) type Point = (f64, f64);

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Paint {
    pub(crate) rgb: (u8, u8, u8),
    pub(crate) alpha: f64,
}

impl Paint {
    pub(crate) const INK: Self = Self::solid((0, 0, 0));
    pub(crate) const PAPER: Self = Self::solid((255, 255, 255));

    /// The same colour on paper, as light as at this opacity, but hiding what is under it.
    pub(crate) fn tint((r, g, b): (u8, u8, u8), alpha: f64) -> Self {
        let mix = |c: u8| (255.0 + alpha * (f64::from(c) - 255.0)).round() as u8;
        Self::solid((mix(r), mix(g), mix(b)))
    }

    pub(crate) const fn solid(rgb: (u8, u8, u8)) -> Self {
        Self { rgb, alpha: 1.0 }
    }
}

/// A line of text. Baselines run right, or up where `upright`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    pub(crate) text: String,
    /// A point of the baseline: its start, middle or end.
    pub(crate) at: Point,
    pub(crate) align: Align,
    pub(crate) size: f64,
    pub(crate) bold: bool,
    pub(crate) upright: bool,
    pub(crate) paint: Paint,
}

/// A marker with a rim of paper around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Symbol {
    pub(crate) shape: Marker,
    pub(crate) center: Point,
    /// That of a disc about as heavy.
    pub(crate) radius: f64,
    pub(crate) paint: Paint,
    /// Width of the rim.
    pub(crate) rim: f64,
}

/// One thing on the page.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mark {
    Stroke { points: Vec<Point>, width: f64, paint: Paint },
    Area { points: Vec<Point>, paint: Paint },
    Symbol(Symbol),
    Text(Text),
}

/// A rectangle on the page [pt].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        x >= self.left && x <= self.right() && y >= self.top && y <= self.bottom()
    }

    pub(crate) fn grown(&self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2.0 * by,
            height: self.height + 2.0 * by,
        }
    }

    pub(crate) fn corners(&self) -> Vec<Point> {
        vec![
            (self.left, self.top),
            (self.right(), self.top),
            (self.right(), self.bottom()),
            (self.left, self.bottom()),
        ]
    }
}

/// Everything on the page, in the order of drawing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Page {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Title of the document, not drawn.
    pub(crate) name: String,
    pub(crate) marks: Vec<Mark>,
}
