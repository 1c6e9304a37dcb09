//! What the suites share: tables of reference values, and inputs of any bits.
pub mod any_input;
pub mod kernels;
pub mod table;

use turbid_analytic::{Incidence, Value};

/// A beam along the normal.
pub const NORMAL: Incidence = Incidence::Beam { mu0: 1.0 };

/// A beam of this cosine.
pub fn beam(mu0: f64) -> Incidence {
    Incidence::Beam { mu0 }
}

/// Two answers agree to `relative` of themselves, and their bounds cover the difference.
pub fn close(name: &str, a: Value, b: Value, relative: f64) {
    let off = (a.value - b.value).abs();
    assert!(off <= relative * b.value.abs() + f64::MIN_POSITIVE, "{name}: {a:?} {b:?} off {off:e}");
    assert!(off <= a.error + b.error, "{name}: {a:?} {b:?} off {off:e}");
}
