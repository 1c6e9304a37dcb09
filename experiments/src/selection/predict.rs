//! What theory says of every case, before anything is measured.

use super::cases::{LARGEST, Selector, THUMB, all, name};
use super::fields::Field;
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;

/// Mean error and mean squared error of a radius, relative to the exact value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// The radius [mfp].
    pub radius: f64,
    /// What it blurs.
    pub blur: f64,
    /// Mean squared error.
    pub squared: f64,
}

impl Expected {
    /// Of one radius for all maps.
    pub fn new(field: Field, photons: u64, radius: f64) -> anyhow::Result<Self> {
        let ball = field.ball(radius)?;
        let blur = ball.mean - 1.0;
        Ok(Expected { radius, blur, squared: blur * blur + ball.variance() / photons as f64 })
    }

    /// Of the best radius up to the largest: in steps that are worth a thousandth of the error.
    pub fn best(field: Field, photons: u64) -> anyhow::Result<Self> {
        let mut best = Expected::new(field, photons, LARGEST)?;
        for step in 1..128 {
            let radius = LARGEST * libm::exp2(-f64::from(step) / 16.0);
            let found = Expected::new(field, photons, radius)?;
            if found.squared < best.squared {
                best = found;
            }
        }
        Ok(best)
    }
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for (field, photons) in all(settings) {
        let best = Expected::best(field, photons)?;
        for (selector, expected) in
            [(Selector::Oracle, best), (Selector::Fixed, Expected::new(field, photons, THUMB)?)]
        {
            let name = name(field, photons, selector);
            let source = "exact kernel mean";
            predictions.push(Prediction::new(&name, "error", Unit::ONE, (expected.blur, 1e-9), source));
            let source = "squared blur and variance of independent photons";
            let squared = (expected.squared, 1e-9 * expected.squared);
            predictions.push(Prediction::new(name, "squared error", Unit::ONE, squared, source));
        }
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the field is smooth and photons are many, r^(c+4) = cB/(4 A^2 N).
    #[test]
    fn best_radii_follow_their_law() {
        let bend = [
            (Field::Places, 1.0 / 0.6, 0.1),
            (Field::Rays, 1.0 / 0.6, 0.125),
            (Field::Beams, 0.8 / 0.6, 1.0 / 6.0),
        ];
        for (field, slope, coefficient) in bend {
            let (photons, c) = (1_000_000_000, field.codimension());
            let a = coefficient * slope * slope;
            let at = 0.01;
            let b = field.ball(at).unwrap().weight * libm::pow(at, c);
            let law = libm::pow(c * b / (4.0 * a * a * photons as f64), 1.0 / (c + 4.0));
            let found = Expected::best(field, photons).unwrap().radius;
            assert!((found / law - 1.0).abs() < 0.05, "{field:?}: {found} {law}");
        }
    }
}
