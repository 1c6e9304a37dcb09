//! The mean error of a gather in a body of fog, in parts: exact kernel means of the exact field, the k-nearest law for
//! independent photons, and the clusters of one history.

use super::{Exact, Table, nearest_clustering};
use crate::prediction::{PredictedError, Term};
use crate::setups::Setup;
use anyhow::Context;
use std::f64::consts::PI;
use std::sync::OnceLock;
use turbid::estimators::Kernel;
use turbid_analytic::nearest::{nearest_expectation, nearest_expectation_biased};

/// The terms of a gather, in the order of figures.
pub const GATHER_TERMS: [Term; 4] = [Term::Edge, Term::Blur, Term::Nearest, Term::Clusters];

/// A gather of the k nearest photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestGather {
    /// How the photons are weighted.
    pub kernel: Kernel,
    /// Which photon sets the radius.
    pub k: usize,
    /// Largest radius \[mfp\].
    pub cap: f64,
    /// Emitted photons over emitted power: photons per volume where the fluence is 1.
    pub density: f64,
    /// Whether the k-th photon is summed too, wrongly.
    pub is_biased: bool,
}

/// A setup with all that predictions ask of it.
pub struct Gathers {
    setup: Setup,
    exact: Exact,
    /// Largest radius asked of the tables \[mfp\].
    reach: f64,
    /// Kernel means by depth and kernel, tabulated when first asked for.
    profiles: Vec<(f64, Kernel, OnceLock<Table>)>,
}

/// What interpolation of the kernel means adds to the error of a nearest expectation, tested in `table`.
const INTERPOLATION: f64 = 1e-8;

impl Gathers {
    /// The theory of gathers up to radius `reach`. Nearest gathers may be asked at the given depths; histories of albedo
    /// 0 make no clusters.
    pub fn new(setup: Setup, depths: &[f64], reach: f64) -> anyhow::Result<Self> {
        let places = depths.iter().flat_map(|&depth| Kernel::ALL.map(|kernel| (depth, kernel)));
        let profiles = places.map(|(depth, kernel)| (depth, kernel, OnceLock::new())).collect();
        Ok(Gathers { setup, exact: setup.exact()?, reach, profiles })
    }

    /// The exact fluence at a depth, and the bound on its error.
    pub fn exact(&self, t: f64) -> anyhow::Result<(f64, f64)> {
        (self.exact)(t)
    }

    /// The exact fluence against depth.
    pub fn fluence(&self) -> &Exact {
        &self.exact
    }

    /// The table of int_O K_r f against r at one of the depths.
    pub fn profile(&self, depth: f64, kernel: Kernel) -> anyhow::Result<&Table> {
        let found = self.profiles.iter().find(|(d, k, _)| *d == depth && *k == kernel);
        let (_, _, slot) = found.with_context(|| format!("depth {depth} is none of those to be asked"))?;
        if let Some(profile) = slot.get() {
            return Ok(profile);
        }
        // Two threads may tabulate the same means at once; they find the same numbers.
        let profile = self.setup.body.kernel_means(kernel, depth, self.reach, &self.exact)?;
        Ok(slot.get_or_init(|| profile))
    }

    /// The error of a gather of fixed radius, at any depth.
    pub fn within(&self, kernel: Kernel, radius: f64, t: f64) -> anyhow::Result<PredictedError> {
        let (here, here_error) = (self.exact)(t)?;
        let [edge, blur] = self.setup.body.parts(kernel, radius, t, &self.exact)?;
        Ok(PredictedError {
            exact: (here, here_error),
            terms: stated(edge.0 / here, blur.0 / here, 0.0, 0.0),
            error: (edge.1 + blur.1 + here_error) / here,
        })
    }

    /// What clusters add to a nearest estimate of these terms, at a place of so many photons per volume.
    pub fn clusters(&self, k: usize, photons_per_volume: f64, edge: f64, blur: f64) -> f64 {
        if self.setup.albedo == 0.0 {
            return 0.0;
        }
        // Where the medium ends inside the ball, neighbours are missing like the ball's own part, and the estimate
        // that they raise is itself lower.
        let inside = 1.0 + edge;
        let raised = nearest_clustering(self.setup.albedo, self.setup.g, photons_per_volume * inside, k);
        raised * inside * (1.0 + edge + blur)
    }

    /// The error of a gather of the k nearest photons, at one of the depths.
    pub fn nearest(&self, gather: &NearestGather, t: f64) -> anyhow::Result<PredictedError> {
        let &NearestGather { kernel, k, cap, density, is_biased } = gather;
        let (here, here_error) = (self.exact)(t)?;
        let neighbors = u32::try_from(k)?;
        let ball = |r: f64| density * 4.0 / 3.0 * PI * r * r * r;
        let (counted, summed) = (self.profile(t, Kernel::Uniform)?, self.profile(t, kernel)?);
        let number = |r: f64| ball(r) * counted.at(r);
        let right = nearest_expectation(neighbors, cap, number, |r| summed.at(r))?;
        let inside = |kernel, r| self.setup.body.mass(kernel, r, t).map_or(f64::NAN, |mass| here * mass);
        let number_uniform = |r: f64| ball(r) * inside(Kernel::Uniform, r);
        let uniform = nearest_expectation(neighbors, cap, number_uniform, |r| inside(kernel, r))?;
        let (edge, blur) = (uniform.value / here - 1.0, (right.value - uniform.value) / here);
        let mut error = (right.error + uniform.error + here_error) / here + INTERPOLATION;
        let mut rule = 0.0;
        if is_biased {
            let biased = nearest_expectation_biased(neighbors, cap, number, |r| summed.at(r))?;
            rule = (biased.value - right.value) / here;
            error += biased.error / here;
        }
        let clusters = self.clusters(k, density * here, edge, blur);
        Ok(PredictedError { exact: (here, here_error), terms: stated(edge, blur, rule, clusters), error })
    }
}

/// The terms of a gather in the order of [`GATHER_TERMS`].
fn stated(edge: f64, blur: f64, rule: f64, clusters: f64) -> Vec<(Term, f64)> {
    GATHER_TERMS.into_iter().zip([edge, blur, rule, clusters]).collect()
}
