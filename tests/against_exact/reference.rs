//! Rows of tests/reference/*.csv: each value with the error that its stated digits leave.

use serde::Deserialize;

/// A value and the bound of its error.
pub type Reference = (f64, f64);

#[derive(Debug, Clone, Deserialize)]
pub struct SlabRow {
    pub tau: f64,
    pub albedo: f64,
    pub g: f64,
    pub mu0: String,
    pub t: Option<f64>,
    pub quantity: String,
    pub value: f64,
    pub digits: i32,
}

#[derive(Debug, Clone, Deserialize)]
pub struct RadianceRow {
    pub tau: f64,
    pub albedo: f64,
    pub g: f64,
    pub mu0: f64,
    pub t: f64,
    pub mu: f64,
    pub dphi: f64,
    pub value: f64,
    pub digits: i32,
}

#[derive(Debug, Clone, Deserialize)]
struct SphereRow {
    radius: f64,
    albedo: f64,
    r: Option<f64>,
    quantity: String,
    value: f64,
    digits: i32,
}

pub fn rows<T: for<'a> Deserialize<'a>>(text: &str) -> Vec<T> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// A value of n correct digits is wrong by at most 10^-(n-1) of itself.
pub fn known(value: f64, digits: i32) -> Reference {
    (value, value * 10f64.powi(1 - digits))
}

/// The row of a ball of this radius and albedo; `r` of a fluence.
pub fn sphere(radius: f64, albedo: f64, quantity: &str, r: Option<f64>) -> Reference {
    let all: Vec<SphereRow> = rows(include_str!("../reference/sphere.csv"));
    let is_it = |row: &&SphereRow| {
        row.radius == radius && row.albedo == albedo && row.quantity == quantity && row.r == r
    };
    let row = all.iter().find(is_it).unwrap();
    known(row.value, row.digits)
}

/// Every row of the slabs.
pub fn slabs() -> Vec<SlabRow> {
    rows(include_str!("../reference/slab_hg.csv"))
}

/// Every row of the radiances.
pub fn radiances() -> Vec<RadianceRow> {
    rows(include_str!("../reference/slab_hg_radiance.csv"))
}
