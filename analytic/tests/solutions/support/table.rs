//! Tables of reference values: one row a value, with the parameters that it belongs to and its number of correct digits.

use std::collections::HashMap;
use turbid_analytic::{Incidence, Value};

pub type Row = HashMap<String, String>;

/// All rows of a table of the folder `reference`.
pub fn rows(file: &str, count: usize) -> Vec<Row> {
    let path = format!("{}/tests/reference/{file}", env!("CARGO_MANIFEST_DIR"));
    let rows: Vec<Row> =
        csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), count);
    rows
}

pub fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} of {row:?}"))
}

/// A column that holds a cosine or the word diffuse.
pub fn incidence(word: &str) -> Incidence {
    if word == "diffuse" { Incidence::Diffuse } else { Incidence::Beam { mu0: word.parse().unwrap() } }
}

/// The table has `digits` correct digits, so a deviation of 10^-(digits-1) of the value is allowed; the bound must cover
/// it but for half a unit of the table's own last digit. More than 16 digits are compared at 16.
pub fn check(row: &Row, got: Value) {
    check_to(row, got, 0.5);
}

/// As [`check`], of a table whose own error may be so many units of its last digit.
pub fn check_to(row: &Row, got: Value, units: f64) {
    let (value, digits) = (number(row, "value"), number(row, "digits").min(16.0));
    let unit = libm::pow(10.0, -digits) * value.abs();
    let off = (got.value - value).abs();
    assert!(off <= 10.0 * unit, "{row:?}: {got:?} differs by {off:e}");
    assert!(off <= got.error + units * unit, "{row:?}: {got:?} differs by {off:e}");
}
