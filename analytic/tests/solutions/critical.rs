//! Critical sizes against tables and limits.

use crate::support::table::{check, number, rows};
use libm::{atan, sqrt};
use turbid_analytic::critical::{critical_half_thickness, critical_radius};
use turbid_analytic::{Critical, CriticalShape};

#[test]
fn table() {
    for row in rows("critical.csv", 15) {
        let shape = match row["geometry"].as_str() {
            "critical_slab" => CriticalShape::Slab,
            _ => CriticalShape::Sphere,
        };
        let critical = Critical::new(shape, number(&row, "w")).unwrap();
        let got = match row["quantity"].as_str() {
            "flux_ratio" => critical.flux_ratio(number(&row, "r")).unwrap(),
            _ => critical.size(),
        };
        check(&row, got);
        assert!(got.error < 1e-12 * number(&row, "value"), "{row:?} {got:?}");
    }
}

/// Printed by Sood, Forster and Parsons (2003) after Kaper, Lindeman and Leaf (1974): sizes to the last digit printed,
/// and the flux of the sphere at c = 1.30. Their flux of the slab, 0.9669506, 0.8686259, 0.7055218 and 0.4461912 at
/// 0.25, 0.5, 0.75 and 1, differs by up to 4 in the last place, and is left out.
#[test]
fn published_values() {
    let half = |c: f64| critical_half_thickness(c).unwrap().value;
    let radius = |c: f64| critical_radius(c).unwrap().value;
    for (c, printed) in [(1.3, 0.937_725_56), (1.4, 0.736_603_55)] {
        assert!((half(c) - printed).abs() < 1e-8, "{c}: {}", half(c));
    }
    for (c, printed) in [(1.3, 2.424_824_980_2), (1.4, 1.985_343_432_4)] {
        assert!((radius(c) - printed).abs() < 1e-10, "{c}: {}", radius(c));
    }
    let sphere = Critical::new(CriticalShape::Sphere, 1.3).unwrap();
    for (x, printed) in [(0.25, 0.932_449_07), (0.5, 0.745_533_32), (0.75, 0.480_954_13), (1.0, 0.171_777_06)]
    {
        let got = sphere.flux_ratio(x).unwrap().value;
        assert!((got - printed).abs() < 1.01e-8, "{x}: {got}");
    }
}

/// c -> 1: pi/(2 kappa) and pi/kappa less Milne's extrapolation length, c atan(kappa)/kappa = 1.
#[test]
fn nearly_conservative_bodies_end_at_the_extrapolation_length() {
    const MILNE: f64 = 0.710_446_089_598_763_1;
    for excess in [1e-12, 1e-9, 1e-6] {
        let c = 1.0 + excess;
        let mut kappa = sqrt(3.0 * (c - 1.0));
        // Newton on (c-1) - (1 - atan(k)/k) c: 1 - atan(k)/k = k^2/3 - k^4/5 + ...
        for _ in 0..3 {
            let square = kappa * kappa;
            kappa = sqrt(3.0 * ((c - 1.0) / c + square * square / 5.0 - square * square * square / 7.0));
        }
        assert!(excess < 1e-7 || (c * atan(kappa) / kappa - 1.0).abs() < 1e-15);
        let pi = std::f64::consts::PI;
        let slab = critical_half_thickness(c).unwrap();
        let sphere = critical_radius(c).unwrap();
        // The extrapolation length is Milne's divided by c, to higher order in c - 1; roundings of the size.
        let tolerance = |size: f64| 2.0 * excess + 1e-14 * size;
        assert!((slab.value - (0.5 * pi / kappa - MILNE)).abs() < tolerance(slab.value), "{c}: {slab:?}");
        assert!((sphere.value - (pi / kappa - MILNE)).abs() < tolerance(sphere.value), "{c}: {sphere:?}");
    }
}

#[test]
fn refusals_name_the_parameter() {
    for c in [1.0, 0.9, f64::NAN, f64::INFINITY, 1001.0, -2.0] {
        let error = critical_radius(c).err().unwrap().to_string();
        assert!(error.starts_with("secondaries is"), "{error}");
    }
    let body = Critical::new(CriticalShape::Slab, 1.5).unwrap();
    assert!(body.flux_ratio(1.0 + 1e-15).is_err() && body.flux_ratio(f64::NAN).is_err());
    assert_eq!(body.flux_ratio(0.0).unwrap().value, 1.0);
}
