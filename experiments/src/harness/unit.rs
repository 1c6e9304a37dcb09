//! Units of numbers.

use super::format::percent;
use serde::{Serialize, Serializer};

/// The unit of a quantity, in plain characters: `1`, `W/L^2`, `mfp`; and how readers are shown it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unit {
    name: &'static str,
    is_shown_in_percent: bool,
}

impl Unit {
    /// No unit.
    pub const ONE: Unit = Unit::new("1");
    /// A part of the exact value at the same place, unless the text says otherwise: no unit in files, per cent in reports.
    pub const FRACTION: Unit = Unit { name: "1", is_shown_in_percent: true };
    /// Mean free paths.
    pub const MFP: Unit = Unit::new("mfp");
    /// Fluence and irradiance.
    pub const FLUENCE: Unit = Unit::new("W/L^2");
    /// Radiance.
    pub const RADIANCE: Unit = Unit::new("W/(L^2 sr)");

    /// Any other unit; an empty one does not compile in a constant.
    pub const fn new(name: &'static str) -> Self {
        assert!(!name.is_empty(), "a unit has a name; 1 means none");
        Unit { name, is_shown_in_percent: false }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Its name for readers; empty for none.
    pub fn title(self) -> String {
        match self.name {
            _ if self.is_shown_in_percent => "%".to_string(),
            "1" => String::new(),
            name => name.replace("^2", "²").replace("^3", "³"),
        }
    }

    /// A number as readers are shown it.
    pub fn shown(self, x: f64) -> f64 {
        if self.is_shown_in_percent { percent(x) } else { x }
    }

    /// A number in text followed by the unit; a number with its error is put in brackets.
    pub fn after(self, text: &str) -> String {
        match self.title() {
            none if none.is_empty() => text.to_string(),
            name if text.contains('±') => format!("({text}) {name}"),
            name => format!("{text} {name}"),
        }
    }
}

impl Default for Unit {
    fn default() -> Self {
        Unit::ONE
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_have_no_unit_in_files_and_are_per_cent_for_readers() {
        let unit = Unit::FRACTION;
        assert_eq!(serde_json::to_string(&unit).unwrap(), "\"1\"");
        assert_eq!((unit.name(), unit.title().as_str(), unit.shown(-0.25)), ("1", "%", -25.0));
        assert_eq!(unit.after("2 ± 1"), "(2 ± 1) %");
        assert_eq!((Unit::ONE.shown(0.5), Unit::ONE.after("0.5").as_str()), (0.5, "0.5"));
        assert_eq!(Unit::FLUENCE.after("3"), "3 W/L²");
    }
}
