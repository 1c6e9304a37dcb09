//! Units of numbers.

use serde::Serialize;

/// The unit of a quantity, in plain characters: `1`, `%`, `W/L^2`, `mfp`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Unit(&'static str);

impl Unit {
    /// No unit.
    pub const ONE: Unit = Unit("1");
    /// Per cent, of the exact value at the same place unless the text says otherwise.
    pub const PERCENT: Unit = Unit("%");
    /// Mean free paths.
    pub const MFP: Unit = Unit("mfp");
    /// Fluence and irradiance.
    pub const FLUENCE: Unit = Unit("W/L^2");
    /// Radiance.
    pub const RADIANCE: Unit = Unit("W/(L^2 sr)");

    /// Any other unit; an empty one does not compile in a constant.
    pub const fn new(name: &'static str) -> Self {
        assert!(!name.is_empty(), "a unit has a name; 1 means none");
        Unit(name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.0
    }

    /// A number in text followed by the unit; a number with its error is put in brackets.
    pub fn after(self, text: &str) -> String {
        match self.0 {
            "1" => text.to_string(),
            name if text.contains('±') => format!("({text}) {}", name.replace("^2", "²").replace("^3", "³")),
            name => format!("{text} {}", name.replace("^2", "²").replace("^3", "³")),
        }
    }
}
