//! What is known before anything is measured.

use super::cases::Class;
use super::lattice::{changed_sides, kernel_on_lattice};
use super::measure::large_cases;
use super::storage::{self, K, RADIUS, Rule};
use super::stretched::{Case, nearest_on_lattice};
use super::{sampled, stretched};
use crate::harness::{Settings, Unit};
use crate::prediction::Prediction;
use crate::theory::{clustering, nearest_clustering};
use std::f64::consts::PI;
use turbid::estimators::Kernel;
use turbid::transport::in_parallel;

/// Stored photons per volume in the furnace: fluence over the power of a photon, 4 pi over those emitted.
fn density(settings: &Settings) -> f64 {
    storage::FLUENCE * storage::photons(settings) as f64 / (4.0 * PI)
}

/// What storage does to a gather of the furnace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Storage {
    /// Mean difference from double precision, over the exact value.
    pub mean: f64,
    /// Bound on its error.
    pub error: f64,
    /// Root mean square difference, over the exact value.
    pub root_mean_square: f64,
    /// Standard error of one estimate, over the exact value.
    pub noise: f64,
    /// What clusters add to the mean.
    pub clusters: f64,
}

/// The prediction for a spacing of stored coordinates [mfp].
///
/// Fixed radius: the kernel on the lattice, and as many photons as change sides, each a history of its own, since the
/// layer in which they do is thin. Nearest: the distance of the k-th has an error of h / (sqrt 18) on average over
/// directions, the photon's and the query point's roundings together, while that is small against the distance from
/// one photon to the next; when it is not, as many change sides as at a fixed radius.
pub fn storage(settings: &Settings, rule: Rule, spacing: f64) -> anyhow::Result<Storage> {
    let (albedo, g, n) = (1.0, 0.0, density(settings));
    let ball = |r: f64| n * 4.0 / 3.0 * PI * r * r * r;
    // Arithmetic in single precision: distances squared, cubed radii, sums.
    let floor = 3.0 / f64::from(1u32 << 24);
    Ok(match rule {
        Rule::Fixed => {
            let in_radii = spacing / RADIUS;
            let (mean, error) = if in_radii < 1e-5 {
                (0.0, 1e-9)
            } else {
                let (value, error) = kernel_on_lattice(Kernel::Uniform, in_radii)?;
                (value - 1.0, error)
            };
            let moved = changed_sides(in_radii) / ball(RADIUS);
            let noise = ((1.0 + clustering(albedo, g, RADIUS)) / ball(RADIUS)).sqrt();
            let root_mean_square = (mean * mean + moved).sqrt();
            Storage { mean, error: error + floor, root_mean_square, noise, clusters: 0.0 }
        }
        Rule::Nearest => {
            let r = libm::cbrt(3.0 * K as f64 / (4.0 * PI * n));
            let (mean, error) = nearest_on_lattice(Kernel::Uniform, K, storage::CAP, n, spacing)?;
            let shift = 3.0 * spacing / r / 18f64.sqrt();
            let moved = changed_sides(spacing / r) / K as f64;
            let root_mean_square = (mean * mean + (shift * shift).min(moved) + floor * floor).sqrt();
            let noise = ((1.0 + clustering(albedo, g, r)) / (K as f64 - 2.0)).sqrt();
            let clusters = nearest_clustering(albedo, g, n, K);
            Storage { mean, error, root_mean_square, noise, clusters }
        }
    })
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let rows = sampled::all();
    let one = |row: &sampled::Sampled| {
        let (exact, unit) = ((row.exact)()?, row.unit());
        Ok(Prediction::new(row.name.clone(), "value", unit, exact, row.source))
    };
    let mut predictions =
        in_parallel(rows.len(), |i| one(&rows[i])).into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mut add = |case: String, quantity: &str, unit, value, error, source: &str| {
        predictions.push(Prediction::new(case, quantity, unit, (value, error), source));
    };
    for (case, value, error) in large_cases(settings)? {
        add(case, "rate", Unit::ONE, value, error, "Beer and Lambert; mean of e^-t over a ball");
    }
    for power in storage::POWERS {
        for rule in Rule::ALL {
            let Storage { mean, error, root_mean_square, noise, clusters } =
                storage(settings, rule, storage::spacing(power))?;
            let case = storage::case(rule, power);
            add(case.clone(), "difference", Unit::FRACTION, mean, error, "kernel on a lattice");
            let ratio = root_mean_square / noise;
            add(case.clone(), "rms difference", Unit::ONE, ratio, 0.0, "photons that change sides");
            add(case.clone(), "error", Unit::FRACTION, mean + clusters, error, "and clusters");
        }
    }
    for case in stretched::POWERS.into_iter().flat_map(Case::all) {
        let (value, error) = case.predicted(settings)?;
        add(case.name(), "error", Unit::FRACTION, value, error, "kernel on a lattice");
    }
    Ok(predictions)
}

/// The class of a checked row, from its case.
pub fn class_of(case: &str) -> Option<Class> {
    let (name, _) = case.split_once(": ")?;
    Class::ALL.into_iter().find(|class| class.name() == name)
}
