//! What the maps say of each case, and how results are found.

use super::cases::Case;
use super::predict::Theory;
use super::profile::{equivalent_width, rise_width};
use super::shaft::{CAP, density};
use crate::harness::{Cells, Estimate};
use crate::setups::Size;
use std::f64::consts::PI;
use turbid::estimators::Kernel;
use turbid::stats::{Moments, jackknife};
use turbid_analytic::edge::Edge;
use turbid_analytic::kernel as referee;

/// One profile with everything that is known of it.
pub struct CaseResult {
    /// The case.
    pub case: Case,
    /// What was predicted.
    pub theory: Theory,
    /// The profile over the exact fluence inside: at each place, one value a map.
    pub profile: Vec<Vec<f64>>,
    /// Width from 10 to 90 per cent of the mean profile [mfp], by leaving out one map at a time.
    pub rise: Estimate,
    /// Inverse slope of the mean profile [mfp]; none where too few photons make it rise.
    pub equivalent: Option<Estimate>,
    /// Width of each map's own profile [mfp]: biased by its noise.
    pub single: Moments,
}

/// One transfer of a sinusoid.
pub struct Transfer {
    /// The kernel.
    pub kernel: Kernel,
    /// Radius over wavelength.
    pub radius: f64,
    /// Predicted contrast.
    pub predicted: f64,
    /// Bound on its error.
    pub error: f64,
    /// Measured contrast of each map.
    pub maps: Vec<f64>,
}

impl CaseResult {
    pub fn new(case: Case, theory: Theory, cells: &Cells) -> anyhow::Result<Self> {
        let name = case.name();
        let values = |place: &f64| cells.values(&name, &Case::quantity(*place));
        let profile = case.places().iter().map(values).collect::<anyhow::Result<Vec<_>>>()?;
        let inside = inside(&case);
        let maps: Vec<usize> = (0..profile.first().map_or(0, Vec::len)).collect();
        let mean = |maps: &[usize]| -> Vec<f64> {
            let mean = |place: &Vec<f64>| maps.iter().map(|&m| place[m]).sum::<f64>() / maps.len() as f64;
            profile.iter().map(mean).collect()
        };
        let plateau = theory.plateau;
        let rise = jackknife(&maps, |maps| rise_width(&inside, &mean(maps), plateau));
        let equivalent =
            jackknife(&maps, |maps| equivalent_width(&inside, &mean(maps), plateau).unwrap_or(f64::NAN));
        let single = maps.iter().map(|&m| rise_width(&inside, &mean(&[m]), plateau)).collect::<Vec<f64>>();
        let equivalent = (equivalent.value.is_finite() && equivalent.std_error.is_finite())
            .then(|| Estimate::jackknife(&equivalent));
        let rise = Estimate::jackknife(&rise);
        Ok(CaseResult { case, theory, profile, rise, equivalent, single: single.iter().collect() })
    }

    /// Mean profile at one place over maps.
    pub fn mean(&self, index: usize) -> Moments {
        self.profile[index].iter().collect()
    }

    /// Photons that the probes of one place of one map rest on, on average, as many as would give the uniform kernel
    /// its noise.
    pub fn photons(&self, index: usize) -> f64 {
        let case = &self.case;
        let probes = 2.0 * case.along() as f64;
        let ball = |r: f64| density(case.photons) * 4.0 / 3.0 * PI * r * r * r;
        let place = case.places()[index] * case.scale();
        let flat = ball(1.0) / (case.kernel.roughness() * 4.0 / 3.0 * PI);
        match case.size {
            Size::Nearest(k) => {
                let seen = Edge::new(referee::Kernel::Uniform, CAP).and_then(|e| e.spread(place / CAP));
                probes * (k as f64).min(ball(CAP) * seen.map_or(0.0, |share| share.value))
            }
            _ => probes * flat * case.scale() * case.scale() * case.scale() * self.theory.profile[index].0,
        }
    }
}

/// Distances of the probes inside the edge [mfp].
pub fn inside(case: &Case) -> Vec<f64> {
    case.places().iter().map(|p| p * case.scale()).collect()
}

/// The largest number of photons a map.
pub fn largest(results: &[CaseResult]) -> u64 {
    results.iter().map(|r| r.case.photons).max().unwrap_or(0)
}

/// The profile of the largest maps with a gather and kernel.
pub fn find(results: &[CaseResult], size: Size, kernel: Kernel) -> Option<&CaseResult> {
    find_at(results, largest(results), size, kernel)
}

/// The profile of maps of a number of photons.
pub fn find_at(results: &[CaseResult], photons: u64, size: Size, kernel: Kernel) -> Option<&CaseResult> {
    results.iter().find(|r| r.case == Case { photons, size, is_deviation: false, kernel })
}

/// The profile of the largest maps with a kernel at the standard deviation of the uniform one of this radius.
pub fn find_deviation(results: &[CaseResult], radius: f64, kernel: Kernel) -> Option<&CaseResult> {
    let case = Case { photons: largest(results), size: Size::Radius(radius), is_deviation: true, kernel };
    results.iter().find(|r| r.case == case)
}
