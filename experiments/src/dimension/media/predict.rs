//! What theory says of the exponents, before anything is measured.

use super::cases::{Medium, Method, sizes};
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;

/// The case of an exponent.
pub fn name(medium: Medium, method: Method) -> String {
    format!("{} {}", medium.name(), method.name())
}

/// The quantity.
pub const EXPONENT: &str = "exponent of the typical error";

/// The predictions: what the exponents tend to, with kernels far from faces, light from all sides and ever more photons.
pub fn predict(settings: &Settings) -> Vec<Prediction> {
    let sizes = sizes(settings);
    let mut predictions = Vec::new();
    for medium in Medium::ALL {
        for method in Method::ALL {
            let source = match method {
                Method::Planes => "squared errors fall as ln N/N",
                Method::Debiased => "no schedule of levels has a better exponent than the plain estimate",
                _ => "variance over r^c, squared blur r^4",
            };
            let value = method.exponent(sizes[0], sizes[sizes.len() - 1]);
            predictions.push(Prediction::new(
                name(medium, method),
                EXPONENT,
                Unit::ONE,
                (value, 0.0),
                source,
            ));
        }
    }
    predictions
}
