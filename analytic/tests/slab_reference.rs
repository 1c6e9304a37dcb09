//! The isotropic slab against the reference table, row by row.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::HashMap;
use turbid_analytic::{Incidence, IsotropicSlab, Value};

fn incidence(word: &str) -> Incidence {
    if word == "diffuse" { Incidence::Diffuse } else { Incidence::Beam { mu0: word.parse().unwrap() } }
}

/// The table has `digits` correct digits, so a deviation of 10^-(digits-1) of the value is allowed; the bound must
/// cover the deviation but for the table's own last digits.
#[test]
fn every_row_is_reproduced_within_its_digits_and_within_the_bound() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/slab_iso.csv");
    let mut slabs: HashMap<[String; 3], IsotropicSlab> = HashMap::new();
    let mut rows = 0;
    let mut worst = (0.0, String::new());
    for record in csv::Reader::from_path(path).unwrap().deserialize() {
        let row: HashMap<String, String> = record.unwrap();
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        let (tau, w) = (number("tau"), number("w"));
        let quantity = row["quantity"].as_str();
        let chandrasekhar = quantity == "X" || quantity == "Y";
        let mu0 = if chandrasekhar { row["mu"].clone() } else { row["mu0"].clone() };
        let key = [row["tau"].clone(), row["w"].clone(), mu0.clone()];
        let slab = slabs.entry(key).or_insert_with(|| IsotropicSlab::new(tau, w, incidence(&mu0)).unwrap());
        let scale = |v: Value, f: f64| Value { value: v.value * f, error: v.error * f, ..v };
        let got = match quantity {
            "R" => slab.reflectance(),
            "T_total" => slab.transmittance(),
            "T_diffuse" => slab.transmittance_diffuse(),
            "A" => slab.absorptance(),
            "fluence" => slab.fluence(number("t")).unwrap(),
            "radiance_up" | "radiance_down_diffuse" => slab.radiance(number("t"), number("mu")).unwrap(),
            "X" => scale(slab.fluence(0.0).unwrap(), number("mu")),
            "Y" => scale(slab.fluence(tau).unwrap(), number("mu")),
            other => panic!("{other}"),
        };
        let (value, digits) = (number("value"), number("digits"));
        let off = (got.value - value).abs();
        let id = &row["id"];
        assert!(
            off <= libm::pow(10.0, 1.0 - digits) * value.abs(),
            "{id} {quantity}: {got:?}, table {value:e}"
        );
        let last = 2.0 * libm::pow(10.0, -digits) * value.abs();
        assert!(off <= got.error + last, "{id} {quantity}: {got:?} off by {off:e}");
        assert!(got.error < 1e-12 * value.abs().max(1.0), "{id} {quantity}: {got:?}");
        if off / value.abs() > worst.0 {
            worst = (off / value.abs(), format!("{id} {quantity} {got:?}"));
        }
        rows += 1;
    }
    assert_eq!(rows, 223);
    assert!(worst.0 < 1e-12, "{worst:?}");
}
