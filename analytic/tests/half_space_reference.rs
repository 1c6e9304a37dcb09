//! The half-space and the infinite medium against their reference tables, row by row.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::HashMap;
use turbid_analytic::half_space::hopf_constant;
use turbid_analytic::{HalfSpace, Incidence, InfiniteMedium, Value};

type Row = HashMap<String, String>;

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// The table has `digits` correct digits, so a deviation of 10^-(digits-1) of the value is allowed; the bound must
/// cover the deviation but for the table's own last digit, and be small.
fn check(file: &str, count: usize, answer: impl Fn(&Row) -> Value) {
    let path = format!("{}/tests/reference/{file}", env!("CARGO_MANIFEST_DIR"));
    let mut rows = 0;
    for record in csv::Reader::from_path(path).unwrap().deserialize() {
        let row: Row = record.unwrap();
        let got = answer(&row);
        let (value, digits) = (number(&row, "value"), number(&row, "digits"));
        let off = (got.value - value).abs();
        let id = &row["id"];
        // A table of more than 16 digits is compared at 16.
        let digits = digits.min(16.0);
        assert!(off <= libm::pow(10.0, 1.0 - digits) * value.abs(), "{id}: {got:?}, table {value:e}");
        assert!(
            off <= got.error + 2.0 * libm::pow(10.0, -digits) * value.abs(),
            "{id}: {got:?} off by {off:e}"
        );
        assert!(got.error < 1e-13 * value.abs(), "{id}: {got:?}");
        rows += 1;
    }
    assert_eq!(rows, count);
}

#[test]
fn half_space() {
    check("halfspace_H.csv", 30, |row| {
        let quantity = row["quantity"].as_str();
        if quantity == "hopf_q_inf" {
            return hopf_constant();
        }
        let space = HalfSpace::new(number(row, "w")).unwrap();
        let beam = || Incidence::Beam { mu0: number(row, "mu0") };
        match quantity {
            "H" => space.h(number(row, "mu")).unwrap(),
            "R_plane" => space.reflectance(beam()).unwrap(),
            "R_spherical" => space.reflectance(Incidence::Diffuse).unwrap(),
            "radiance_up_mu0_1_unit_irradiance" => space.radiance(beam(), number(row, "mu")).unwrap(),
            other => panic!("{other}"),
        }
    });
}

#[test]
fn infinite() {
    check("infinite.csv", 31, |row| {
        let medium = InfiniteMedium::henyey_greenstein(number(row, "w"), number(row, "g")).unwrap();
        match row["quantity"].as_str() {
            "diffusion_exponent_k" => medium.decays()[0],
            "fluence_point" => medium.fluence(number(row, "r")).unwrap(),
            "fluence_point_asymptotic_mode" => medium.asymptotic_fluence(number(row, "r")).unwrap(),
            "fluence_point_P1_diffusion" => medium.diffusion_fluence(number(row, "r")).unwrap(),
            "mean_square_r_fluence_weighted" => medium.mean_square_radius().unwrap(),
            other => panic!("{other}"),
        }
    });
}
