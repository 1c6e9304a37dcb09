//! What a treatment costs in variance: independent photons of uniform density below one face.

use super::exact;
use crate::harness::{CellId, CellOutput, Group, Settings, Unit};
use crate::prediction::Prediction;
use crate::setups::Size;
use crate::theory::referee_kernel;
use glam::DVec3;
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::{Shape, Slab};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::stats::Moments;
use turbid_analytic::boundary::{Body, treated_variance};

/// The group of its maps.
pub const GROUP: &str = "spread";
/// Photons expected in the unit box.
const PHOTONS: u64 = 30_000;
/// The radius [box].
pub const RADIUS: f64 = 0.08;
/// Depths over the radius.
pub const DEPTHS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Probes along a side; their balls do not meet.
const SIDE: usize = 6;

/// One question: a depth over the radius, a kernel and a treatment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Depth over the radius.
    pub depth: f64,
    /// Kernel.
    pub kernel: Kernel,
    /// Treatment.
    pub treatment: Treatment,
}

impl Spread {
    /// All of them.
    pub fn all() -> Vec<Spread> {
        let mut all = Vec::new();
        for treatment in Treatment::ALL {
            for kernel in Kernel::ALL {
                all.extend(DEPTHS.map(|depth| Spread { depth, kernel, treatment }));
            }
        }
        all
    }

    /// Its name.
    pub fn name(&self) -> String {
        let size = Size::Radius(RADIUS).name();
        format!("spread x={} {size} {} {}", self.depth, self.kernel.name(), self.treatment.name())
    }

    /// The exact mean over the density, and the exact variance over that of a whole ball, with their bounds.
    pub fn exact(&self) -> anyhow::Result<((f64, f64), (f64, f64))> {
        let (kernel, treatment) = (referee_kernel(self.kernel), exact::referee(self.treatment));
        let at = [0.0, 0.0, self.depth];
        let mean = exact::uniform_mean(treatment, kernel, Body::HalfSpace, at, 1.0)?;
        let factor = treated_variance(treatment, kernel, Body::HalfSpace, at, 1.0)?;
        Ok((mean, (factor.value, factor.error)))
    }
}

/// The number of photons expected.
fn photons(settings: &Settings) -> u64 {
    settings.photons(PHOTONS, PHOTONS)
}

/// The maps.
pub fn group(settings: &Settings) -> Group {
    let photons = photons(settings);
    Group::new(GROUP, settings.pick(288, 1024), 2.0 * photons as f64, measure).holding(photons)
}

/// Measures one map: mean over its probes, and their variance over that expected in a whole ball.
fn measure(settings: &Settings, cell: &CellId) -> anyhow::Result<CellOutput> {
    let number = photons(settings);
    let field = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::ONE)?;
    let map = field.map(Number::Expected(number), settings.seed, cell.stream("boundary"))?;
    let gather = Gather::radius(RADIUS)?;
    let mut output = CellOutput::new();
    output.count("photons emitted", number);
    let medium = Shape::Slab(Slab::new(0.0, 2.0)?);
    let boundary = Boundary::of(&medium)?;
    for spread in Spread::all() {
        let estimator = Estimator::new(spread.kernel, gather).treated(spread.treatment);
        let whole = estimator.expected_relative_variance(number as f64, 1.0);
        let place = |i: usize| (i as f64 + 0.5) / SIDE as f64;
        let probes =
            (0..SIDE * SIDE).map(|i| DVec3::new(place(i % SIDE), place(i / SIDE), spread.depth * RADIUS));
        let values: Moments =
            probes.map(|probe| estimator.collision_density(&map, probe, &boundary).value[0]).collect();
        output.count("estimates", values.n());
        output.push(spread.name(), "density", values.mean());
        output.push(spread.name(), "variance factor", values.variance() / whole);
    }
    Ok(output)
}

/// The predictions.
pub fn predict() -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for spread in Spread::all() {
        let (mean, factor) = spread.exact()?;
        for (quantity, (value, error), source) in [
            ("density", mean, "exact mean of the treated kernel"),
            ("variance factor", factor, "integral of the treated kernel's square"),
        ] {
            predictions.push(Prediction::new(spread.name(), quantity, Unit::ONE, (value, error), source));
        }
    }
    Ok(predictions)
}
