//! What the rows are about, and what one row is.

/// The extremes, in the order of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Optical thickness 1e-12 to 1e6.
    Thickness,
    /// Albedo 0 to 1.
    Albedo,
    /// Asymmetry to 1 - 1e-9, both signs.
    Asymmetry,
    /// The unit of length, 2^-40 to 2^40.
    Scale,
    /// Far from the origin.
    Position,
    /// Photons emitted.
    Number,
    /// Neighbours gathered.
    Nearest,
    /// Photons in one place.
    Coincident,
    /// Along and across faces.
    Faces,
    /// What cannot be answered.
    Refusal,
    /// Nothing extreme, asked sharply.
    Ordinary,
}

impl Class {
    /// Every class.
    pub const ALL: [Class; 11] = [
        Class::Thickness,
        Class::Albedo,
        Class::Asymmetry,
        Class::Scale,
        Class::Position,
        Class::Number,
        Class::Nearest,
        Class::Coincident,
        Class::Faces,
        Class::Refusal,
        Class::Ordinary,
    ];
    /// The classes that have sampled rows.
    pub const SAMPLED: [Class; 7] = [
        Class::Thickness,
        Class::Albedo,
        Class::Asymmetry,
        Class::Position,
        Class::Number,
        Class::Faces,
        Class::Ordinary,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Class::Thickness => "thickness",
            Class::Albedo => "albedo",
            Class::Asymmetry => "asymmetry",
            Class::Scale => "scale",
            Class::Position => "position",
            Class::Number => "number",
            Class::Nearest => "nearest",
            Class::Coincident => "coincident",
            Class::Faces => "faces",
            Class::Refusal => "refusal",
            Class::Ordinary => "ordinary",
        }
    }
}

/// Batches of histories behind a sampled row: one a cell.
pub const BATCHES: u64 = 64;

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// What it is about.
    pub class: Class,
    /// Its case, unique.
    pub name: String,
    /// What the simulator says.
    pub value: f64,
    /// What is exact.
    pub exact: f64,
    /// How far apart the two may be: roundings, counted.
    pub bound: f64,
}

impl Checked {
    /// A row; a bound of 0 asks for the very same number.
    pub fn new(class: Class, name: impl Into<String>, value: f64, exact: f64, bound: f64) -> Self {
        Checked { class, name: name.into(), value, exact, bound }
    }
}
