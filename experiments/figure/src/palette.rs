//! Colours, marker shapes and dash patterns that stay apart for every reader, and in grey.

use serde::{Deserialize, Serialize};

/// The colour of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Color {
    /// One of the seven classes, counted from 0 and round again.
    Class(usize),
    /// For what all classes are held against: theory, identity, zero.
    Black,
    /// For what stands behind.
    Grey,
}

/// The classes: blue, vermilion, bluish green, reddish purple, orange, sky blue and dark grey.
///
/// The hues are those of Okabe and Ito (2008) without their yellow, since thin lines of it vanish on white. In grey
/// theirs run together (vermilion, green and purple within 7 of 100 steps of lightness, orange and sky blue within 1);
/// here lightness rises in equal steps from class to class, and colours were searched for that are then as far apart
/// as can be for dichromats. The tests in `vision.rs` say how far.
const CLASSES: [(u8, u8, u8); 7] = [
    (43, 79, 196),
    (224, 81, 15),
    (31, 123, 84),
    (212, 118, 159),
    (242, 173, 55),
    (66, 178, 228),
    (69, 69, 69),
];

impl Color {
    pub(crate) fn rgb(self) -> (u8, u8, u8) {
        match self {
            Self::Class(i) => CLASSES[i % CLASSES.len()],
            Self::Black => (0, 0, 0),
            Self::Grey => (120, 120, 120),
        }
    }
}

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square on its side.
    Square,
    /// A triangle, point up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle, point down.
    TriangleDown,
    /// A cross of two diagonals.
    Cross,
    /// A cross of two straights.
    Plus,
}

impl Marker {
    /// The shape that goes with a class, so that classes differ in grey too.
    #[must_use]
    pub fn of_class(class: usize) -> Self {
        [
            Self::Circle,
            Self::Square,
            Self::Triangle,
            Self::Diamond,
            Self::TriangleDown,
            Self::Cross,
            Self::Plus,
        ][class % 7]
    }
}

/// The pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long strokes.
    Dashed,
    /// Dots.
    Dotted,
    /// A stroke and a dot in turn.
    DashDot,
}

impl Dash {
    /// The pattern that goes with a class.
    #[must_use]
    pub fn of_class(class: usize) -> Self {
        [Self::Solid, Self::Dashed, Self::DashDot, Self::Dotted][class % 4]
    }

    /// Lengths of stroke and gap in turn, in line widths; a stroke of one width is a dot.
    pub(crate) fn pattern(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[5.0, 2.6],
            Self::Dotted => &[1.0, 1.8],
            Self::DashDot => &[5.5, 1.9, 1.0, 1.9],
        }
    }
}

/// The colours of a heat map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shading {
    /// Blue below zero, white at zero, red above, with limits symmetric about zero: for signed errors. Fine lines across
    /// what is below zero tell the sign in grey, too.
    Diverging,
    /// Dark to light: for what has no sign. Lightness is monotonic, so that it survives grey.
    Sequential,
}

/// RdBu of Brewer and Harrower (ColorBrewer 2003), blue first.
const DIVERGING: [(u8, u8, u8); 11] = [
    (5, 48, 97),
    (33, 102, 172),
    (67, 147, 195),
    (146, 197, 222),
    (209, 229, 240),
    (247, 247, 247),
    (253, 219, 199),
    (244, 165, 130),
    (214, 96, 77),
    (178, 24, 43),
    (103, 0, 31),
];

/// Viridis of Smith and van der Walt (2015), at nine equal steps.
const SEQUENTIAL: [(u8, u8, u8); 9] = [
    (68, 1, 84),
    (71, 44, 122),
    (59, 81, 139),
    (44, 113, 142),
    (33, 144, 141),
    (39, 173, 129),
    (92, 200, 99),
    (170, 220, 50),
    (253, 231, 37),
];

impl Shading {
    /// The colour at u from 0 (lowest) to 1 (highest), held at the ends.
    pub fn rgb(self, u: f64) -> (u8, u8, u8) {
        let table: &[(u8, u8, u8)] = match self {
            Self::Diverging => &DIVERGING,
            Self::Sequential => &SEQUENTIAL,
        };
        let at = u.clamp(0.0, 1.0) * (table.len() - 1) as f64;
        let i = (at as usize).min(table.len() - 2);
        let (a, b, f) = (table[i], table[i + 1], at - i as f64);
        let mix = |a: u8, b: u8| (f64::from(a) + f * (f64::from(b) - f64::from(a))).round() as u8;
        (mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
    }

    /// The colour of the lines across a cell at u: red and blue of one strength are the same grey.
    pub(crate) fn hatch(self, u: f64) -> Option<(u8, u8, u8)> {
        match self {
            Self::Sequential => None,
            // Nearly white on either side of zero: there is no sign to tell.
            Self::Diverging if u >= 0.45 => None,
            Self::Diverging if u >= 0.25 => Some(DIVERGING[0]),
            Self::Diverging => Some((255, 255, 255)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luma((r, g, b): (u8, u8, u8)) -> f64 {
        0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
    }

    #[test]
    fn shadings_hold_their_ends_and_middle() {
        assert_eq!(Shading::Diverging.rgb(0.5), (247, 247, 247));
        assert_eq!(Shading::Diverging.rgb(-3.0), DIVERGING[0]);
        assert_eq!(Shading::Sequential.rgb(2.0), SEQUENTIAL[8]);
        assert_eq!(Shading::Sequential.rgb(0.125), SEQUENTIAL[1]);
    }

    #[test]
    fn sequential_shading_brightens_all_the_way() {
        let l: Vec<f64> = (0..=100).map(|i| luma(Shading::Sequential.rgb(f64::from(i) / 100.0))).collect();
        assert!(l.windows(2).all(|w| w[1] > w[0] - 0.6), "each step within one grey level of rounding");
        assert!(l[100] - l[0] > 150.0);
    }

    #[test]
    fn classes_of_one_marker_or_dash_differ_in_colour_and_none_fades_on_white() {
        for a in 0..7 {
            assert!(luma(Color::Class(a).rgb()) < 190.0);
            for b in 0..a {
                assert_ne!(Marker::of_class(a), Marker::of_class(b));
                assert_ne!(Color::Class(a).rgb(), Color::Class(b).rgb());
            }
        }
    }
}
