//! Profiles and widths of every case, before anything is measured.

use super::cases::Case;
use super::measure::all_cases;
use super::profile::{equivalent_width, rise_width};
use super::shaft::{CAP, density};
use super::waves;
use crate::harness::{Settings, Unit};
use crate::prediction::{Prediction, Predictions};
use crate::setups::Size;
use crate::theory::referee_kernel;
use anyhow::Context;
use turbid::transport::in_parallel;
use turbid_analytic::Value;
use turbid_analytic::edge::{Edge, NearestEdge};

/// What theory says of one case; widths in mean free paths, profiles over the exact fluence inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Theory {
    /// Expected profile at each place, with the bound on its error.
    pub profile: Vec<(f64, f64)>,
    /// Expectation far inside.
    pub plateau: f64,
    /// From 10 to 90 per cent of the plateau, exact.
    pub rise: f64,
    /// The same read off the expected profile at the places of the probes.
    pub rise_probed: f64,
    /// Inverse slope at the edge, exact.
    pub equivalent: f64,
    /// The same read off the expected profile at the places of the probes.
    pub equivalent_probed: f64,
}

/// The exact edge of a case.
pub enum Exact {
    /// Fixed radius, with the radius.
    Radius(Edge, f64),
    /// The k nearest.
    Nearest(NearestEdge),
}

impl Exact {
    /// The edge of a case. Lengths are mean free paths, in which the shaft decays by e.
    pub fn new(case: &Case) -> anyhow::Result<Self> {
        let kernel = referee_kernel(case.kernel);
        Ok(match case.size {
            Size::Nearest(k) => {
                let k = u32::try_from(k)?;
                Exact::Nearest(NearestEdge::new(kernel, k, density(case.photons), 1.0, CAP)?)
            }
            _ => Exact::Radius(Edge::new(kernel, case.scale())?, case.scale()),
        })
    }

    /// Expectation far inside, over the exact fluence.
    pub fn plateau(&self) -> anyhow::Result<Value> {
        Ok(match self {
            Exact::Radius(edge, _) => edge.plateau(),
            Exact::Nearest(edge) => edge.plateau()?,
        })
    }

    /// Expectation at a distance inside [mfp], over the exact fluence inside.
    pub fn at(&self, inside: f64) -> anyhow::Result<(f64, f64)> {
        Ok(match self {
            Exact::Radius(edge, r) => {
                let (share, plateau) = (edge.spread(inside / r)?, edge.plateau());
                (share.value * plateau.value, share.error * plateau.value + plateau.error * share.value)
            }
            Exact::Nearest(edge) => {
                let mean = edge.mean(inside)?;
                (mean.value, mean.error)
            }
        })
    }

    /// Widths [mfp]: from 10 to 90 per cent, and the inverse slope.
    pub fn widths(&self) -> anyhow::Result<(f64, f64)> {
        Ok(match self {
            Exact::Radius(edge, r) => (r * edge.rise_width()?.value, r * edge.equivalent_width().value),
            Exact::Nearest(edge) => (edge.rise_width()?.value, edge.equivalent_width()?.value),
        })
    }
}

impl Theory {
    fn new(case: &Case) -> anyhow::Result<Self> {
        let exact = Exact::new(case)?;
        let inside: Vec<f64> = case.places().iter().map(|p| p * case.scale()).collect();
        let profile = inside.iter().map(|&h| exact.at(h)).collect::<anyhow::Result<Vec<_>>>()?;
        let plateau = exact.plateau()?.value;
        let (rise, equivalent) = exact.widths()?;
        let y: Vec<f64> = profile.iter().map(|p| p.0).collect();
        let rise_probed = rise_width(&inside, &y, plateau);
        let equivalent_probed =
            equivalent_width(&inside, &y, plateau).context("an expected profile does not rise")?;
        Ok(Theory { profile, plateau, rise, rise_probed, equivalent, equivalent_probed })
    }

    /// The theory of a case, as it was written down.
    pub fn recall(known: &Predictions, case: &Case) -> anyhow::Result<Self> {
        let name = case.name();
        let find = |quantity: &str| known.get(&name, quantity);
        let value = |quantity: &str| find(quantity).map(|(value, _)| value);
        Ok(Theory {
            profile: case
                .places()
                .iter()
                .map(|&p| find(&Case::quantity(p)))
                .collect::<anyhow::Result<_>>()?,
            plateau: value(PLATEAU)?,
            rise: value(RISE_EXACT)?,
            rise_probed: value(RISE)?,
            equivalent: value(EQUIVALENT_EXACT)?,
            equivalent_probed: value(EQUIVALENT)?,
        })
    }
}

/// Names of quantities.
pub const PLATEAU: &str = "plateau";
/// The 10-90 width as it is measured, between probes.
pub const RISE: &str = "10-90 width";
const RISE_EXACT: &str = "10-90 width, exact";
/// The inverse slope as it is measured, between probes.
pub const EQUIVALENT: &str = "equivalent width";
const EQUIVALENT_EXACT: &str = "equivalent width, exact";

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let cases = all_cases(settings);
    let theories = in_parallel(cases.len(), |i| Theory::new(&cases[i]));
    let mut predictions = Vec::new();
    for (case, theory) in cases.into_iter().zip(theories) {
        let theory = theory?;
        let name = case.name();
        let mut add = |quantity: &str, unit, value: (f64, f64), source: &str| {
            predictions.push(Prediction::new(&name, quantity, unit, value, source));
        };
        let source = if case.size.is_nearest() {
            "edge of a decaying shaft, law of the k-th photon"
        } else {
            "edge of a decaying shaft, kernel"
        };
        for (place, value) in case.places().iter().zip(&theory.profile) {
            add(&Case::quantity(*place), Unit::ONE, *value, source);
        }
        add(PLATEAU, Unit::ONE, (theory.plateau, 1e-10), source);
        add(RISE_EXACT, Unit::MFP, (theory.rise, 1e-9), source);
        add(EQUIVALENT_EXACT, Unit::MFP, (theory.equivalent, 1e-9), source);
        let probed = "the same functional of the expected profile at the probes";
        add(RISE, Unit::MFP, (theory.rise_probed, 1e-9), probed);
        add(EQUIVALENT, Unit::MFP, (theory.equivalent_probed, 1e-9), probed);
    }
    predictions.extend(waves::predict()?);
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::estimators::Kernel;

    fn theory(size: Size, photons: u64) -> (Theory, f64) {
        let case = Case { photons, size, is_deviation: false, kernel: Kernel::Uniform };
        (Theory::new(&case).unwrap(), case.scale())
    }

    /// Laws without decay, printed to three decimals, which decay over a small ball changes by s^2/50 of them at most.
    #[test]
    fn widths_tend_to_those_without_decay() {
        let (fixed, r) = theory(Size::Radius(0.1), 1);
        assert!((fixed.rise / r - 1.2168).abs() < 1e-3 && (fixed.equivalent / r - 4.0 / 3.0).abs() < 1e-3);
        for (k, rise, equivalent) in [(20, 1.895, 1.632), (100, 1.932, 1.671)] {
            let (nearest, r0) = theory(Size::Nearest(k), 64_000_000);
            assert!((nearest.rise / r0 - rise).abs() < 1e-3, "{k}: {}", nearest.rise / r0);
            assert!((nearest.equivalent / r0 - equivalent).abs() < 1e-3, "{k}: {}", nearest.equivalent / r0);
        }
    }

    /// What is read between probes is the width, within a part in two hundred.
    #[test]
    fn probes_are_dense_enough() {
        for size in [Size::Radius(0.4), Size::Nearest(50)] {
            let (t, _) = theory(size, 64_000);
            assert!((t.rise_probed / t.rise - 1.0).abs() < 5e-3, "{t:?}");
            assert!((t.equivalent_probed / t.equivalent - 1.0).abs() < 5e-3, "{t:?}");
        }
    }
}
