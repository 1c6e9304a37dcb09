//! What a question gets back: its parameters as they were understood, and rows of values.

use crate::unit::Unit;
use serde::ser::{Serialize, SerializeMap, Serializer};
use turbid_analytic::Value;

/// A parameter or a coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// A number, kept bit by bit.
    Number(f64),
    /// A count.
    Whole(u64),
    /// A word.
    Text(String),
}

impl From<f64> for Field {
    fn from(number: f64) -> Self {
        Field::Number(number)
    }
}

impl From<u32> for Field {
    fn from(number: u32) -> Self {
        Field::Whole(u64::from(number))
    }
}

impl From<u64> for Field {
    fn from(number: u64) -> Self {
        Field::Whole(number)
    }
}

impl From<String> for Field {
    fn from(text: String) -> Self {
        Field::Text(text)
    }
}

impl From<&str> for Field {
    fn from(text: &str) -> Self {
        Field::Text(text.into())
    }
}

impl std::fmt::Display for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Field::Number(number) => write!(f, "{}", shortest(*number)),
            Field::Whole(number) => write!(f, "{number}"),
            Field::Text(text) => write!(f, "{text}"),
        }
    }
}

impl Serialize for Field {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Field::Number(number) => serializer.serialize_f64(*number),
            Field::Whole(number) => serializer.serialize_u64(*number),
            Field::Text(text) => serializer.serialize_str(text),
        }
    }
}

/// All digits that it takes to read the same number again, in the shorter of the two notations.
pub fn shortest(number: f64) -> String {
    let (plain, scientific) = (format!("{number}"), format!("{number:e}"));
    if plain.len() <= scientific.len().max(8) { plain } else { scientific }
}

/// Named numbers and words, in order.
pub type Fields = Vec<(&'static str, Field)>;

/// One value: of what, where, how large, how well known.
#[derive(Debug, Clone)]
pub struct Row {
    /// What it is, as a word such as `fluence`.
    pub quantity: &'static str,
    /// Where, when more than one of its kind is asked.
    pub at: Fields,
    /// The value, its bound, how it is known.
    pub value: Value,
    /// What the value is a multiple of.
    pub unit: Unit,
}

/// The answer to one question, or the first value of the one quantity that is wanted.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// The subcommand.
    pub problem: &'static str,
    /// What was asked.
    pub parameters: Fields,
    /// What is known.
    pub rows: Vec<Row>,
    wanted: Option<&'static str>,
}

impl Answer {
    /// An answer without rows, to all that is asked or to what is wanted alone.
    pub fn new(wanted: Option<&'static str>) -> Self {
        Answer { wanted, ..Answer::default() }
    }

    /// Names the subcommand.
    pub fn of(&mut self, problem: &'static str) -> &mut Self {
        self.problem = problem;
        self
    }

    /// Adds a parameter.
    pub fn with(&mut self, name: &'static str, field: impl Into<Field>) -> &mut Self {
        self.parameters.push((name, field.into()));
        self
    }

    /// Refuses numbers that are not finite: no problem has them, so that one here is a fault.
    pub fn check(&self) -> anyhow::Result<()> {
        for row in &self.rows {
            let Value { value, error, .. } = row.value;
            anyhow::ensure!(
                value.is_finite() && error.is_finite(),
                "{} is {value} ± {error}: internal error, please report",
                row.quantity
            );
        }
        Ok(())
    }

    /// Adds a value at a place, or at none.
    pub fn add(&mut self, quantity: &'static str, unit: Unit, at: &[(&'static str, Field)], value: Value) {
        if self.wanted.is_none_or(|wanted| wanted == quantity && self.rows.is_empty()) {
            self.rows.push(Row { quantity, at: at.to_vec(), value, unit });
        }
    }

    /// Adds a value that is computed only where it is wanted.
    pub fn ask(
        &mut self,
        quantity: &'static str,
        unit: Unit,
        at: &[(&'static str, Field)],
        value: impl FnOnce() -> anyhow::Result<Value>,
    ) -> anyhow::Result<()> {
        if self.wanted.is_none_or(|wanted| wanted == quantity && self.rows.is_empty()) {
            self.add(quantity, unit, at, value()?);
        }
        Ok(())
    }

    /// Adds a value that is given only where it is wanted by name.
    pub fn ask_by_name(
        &mut self,
        quantity: &'static str,
        unit: Unit,
        value: impl FnOnce() -> anyhow::Result<Value>,
    ) -> anyhow::Result<()> {
        if self.is_one() { self.ask(quantity, unit, &[], value) } else { Ok(()) }
    }

    /// Whether one quantity is wanted alone.
    pub fn is_one(&self) -> bool {
        self.wanted.is_some()
    }

    /// The names of all coordinates, in the order in which rows use them first.
    pub fn coordinates(&self) -> Vec<&'static str> {
        let mut names = Vec::new();
        for (name, _) in self.rows.iter().flat_map(|row| &row.at) {
            if !names.contains(name) {
                names.push(*name);
            }
        }
        names
    }
}

/// Values in the order of a list, under their names.
struct Named<'a>(&'a Fields);

impl Serialize for Named<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, field)| (name, field)))
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("quantity", self.quantity)?;
        for (name, field) in &self.at {
            map.serialize_entry(name, field)?;
        }
        map.serialize_entry("value", &self.value.value)?;
        map.serialize_entry("error", &self.value.error)?;
        map.serialize_entry("unit", &self.unit)?;
        map.serialize_entry("method", self.value.method)?;
        map.end()
    }
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("problem", self.problem)?;
        map.serialize_entry("parameters", &Named(&self.parameters))?;
        map.serialize_entry("values", &self.rows)?;
        map.end()
    }
}

impl Row {
    /// The coordinate of this name, empty for none.
    pub fn place(&self, name: &str) -> String {
        self.at.iter().find(|(n, _)| *n == name).map_or_else(String::new, |(_, field)| field.to_string())
    }
}
