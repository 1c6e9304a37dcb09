//! The isotropic slab against the reference table, row by row.

use crate::support::table::{check, incidence, number, rows};
use std::collections::HashMap;
use turbid_analytic::{IsotropicSlab, Value};

#[test]
fn every_row_is_reproduced_within_its_digits_and_within_the_bound() {
    let mut slabs: HashMap<[String; 3], IsotropicSlab> = HashMap::new();
    for row in rows("slab_iso.csv", 223) {
        let (tau, w) = (number(&row, "tau"), number(&row, "w"));
        let quantity = row["quantity"].as_str();
        let mu0 = &row[if quantity == "X" || quantity == "Y" { "mu" } else { "mu0" }];
        let key = [&row["tau"], &row["w"], mu0].map(String::clone);
        let slab = slabs.entry(key).or_insert_with(|| IsotropicSlab::new(tau, w, incidence(mu0)).unwrap());
        let scale = |v: Value, f: f64| Value { value: v.value * f, error: v.error * f, ..v };
        let (t, mu) = (|| number(&row, "t"), || number(&row, "mu"));
        let got = match quantity {
            "R" => slab.reflectance(),
            "T_total" => slab.transmittance(),
            "T_diffuse" => slab.transmittance_diffuse(),
            "A" => slab.absorptance(),
            "fluence" => slab.fluence(t()).unwrap(),
            "radiance_up" | "radiance_down_diffuse" => slab.radiance(t(), mu()).unwrap(),
            "X" => scale(slab.fluence(0.0).unwrap(), mu()),
            "Y" => scale(slab.fluence(tau).unwrap(), mu()),
            other => panic!("{other}"),
        };
        check(&row, got);
        let value = number(&row, "value");
        assert!(got.error < 1e-12 * value.abs().max(1.0), "{row:?}: {got:?}");
        assert!((got.value - value).abs() < 1e-12 * value.abs(), "{row:?}: {got:?}");
    }
}
