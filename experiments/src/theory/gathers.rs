//! The mean error of a gather in a body of fog, in parts: exact kernel means of the exact field, the k-nearest law for
//! independent photons, and the clusters of one history.

use super::{Exact, Fog, Table, nearest_clustering};
use crate::harness::Predicted;
use anyhow::Context;
use std::f64::consts::PI;
use std::sync::OnceLock;
use turbid::estimators::Kernel;
use turbid_analytic::nearest::{nearest_expectation, nearest_expectation_biased};

/// The predicted error of a case in parts, each as a fraction of the exact fluence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Exact fluence.
    pub exact: f64,
    /// Bound on its error.
    pub exact_error: f64,
    /// The medium ends inside the ball: what is missing of a uniform field.
    pub edge: f64,
    /// The field bends inside the ball: all else that independent photons do to the right rule.
    pub blur: f64,
    /// The wrong rule counts the k-th photon.
    pub rule: f64,
    /// Photons of one history cluster, which draws the k-th photon nearer.
    pub clusters: f64,
    /// Bound on the numerical error of the sum.
    pub error: f64,
}

/// The parts by name, in the order of figures.
pub const PART_NAMES: [&str; 4] = ["edge", "blur", "rule", "clusters"];

impl Parts {
    /// The parts in the order of [`PART_NAMES`].
    pub fn list(&self) -> [f64; 4] {
        [self.edge, self.blur, self.rule, self.clusters]
    }

    /// Predicted relative error.
    pub fn total(&self) -> f64 {
        self.list().iter().sum()
    }

    /// Index of the largest part.
    pub fn dominant(&self) -> usize {
        let sizes = self.list().map(f64::abs);
        (0..sizes.len()).fold(0, |best, i| if sizes[i] > sizes[best] { i } else { best })
    }
}

impl Predicted for Parts {
    fn exact(&self) -> f64 {
        self.exact
    }

    fn total(&self) -> f64 {
        self.total()
    }

    fn bound(&self) -> f64 {
        self.error
    }
}

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

/// A body of fog with all that predictions ask of it.
pub struct Gathers {
    fog: Fog,
    albedo: f64,
    g: f64,
    exact: Exact,
    /// Largest radius asked of the tables \[mfp\].
    reach: f64,
    /// Kernel means by depth and kernel, tabulated when first asked for.
    profiles: Vec<(f64, Kernel, OnceLock<Table>)>,
}

/// What interpolation of the kernel means adds to the error of a nearest expectation, tested in `table`.
const INTERPOLATION: f64 = 1e-8;

impl Gathers {
    /// The theory of gathers up to radius `reach` in fog of this fluence. Nearest gathers may be asked at the
    /// given depths; histories of albedo 0 make no clusters.
    pub fn new(fog: Fog, albedo: f64, g: f64, exact: Exact, depths: &[f64], reach: f64) -> Self {
        let places = depths.iter().flat_map(|&depth| Kernel::ALL.map(|kernel| (depth, kernel)));
        let profiles = places.map(|(depth, kernel)| (depth, kernel, OnceLock::new())).collect();
        Gathers { fog, albedo, g, exact, reach, profiles }
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
        let profile = self.fog.kernel_means(kernel, depth, self.reach, &self.exact)?;
        Ok(slot.get_or_init(|| profile))
    }

    /// The parts of a gather of fixed radius, at any depth.
    pub fn within(&self, kernel: Kernel, radius: f64, t: f64) -> anyhow::Result<Parts> {
        let (here, here_error) = (self.exact)(t)?;
        let [edge, blur] = self.fog.parts(kernel, radius, t, &self.exact)?;
        Ok(Parts {
            exact: here,
            exact_error: here_error,
            edge: edge.0 / here,
            blur: blur.0 / here,
            rule: 0.0,
            clusters: 0.0,
            error: (edge.1 + blur.1 + here_error) / here,
        })
    }

    /// What clusters add to a nearest estimate of these parts, at a place of so many photons per volume.
    pub fn clusters(&self, k: usize, photons_per_volume: f64, edge: f64, blur: f64) -> f64 {
        if self.albedo == 0.0 {
            return 0.0;
        }
        // Where the medium ends inside the ball, neighbours are missing like the ball's own part, and the estimate
        // that they raise is itself lower.
        let inside = 1.0 + edge;
        let raised = nearest_clustering(self.albedo, self.g, photons_per_volume * inside, k);
        raised * inside * (1.0 + edge + blur)
    }

    /// The parts of a gather of the k nearest photons, at one of the depths.
    pub fn nearest(&self, gather: &NearestGather, t: f64) -> anyhow::Result<Parts> {
        let &NearestGather { kernel, k, cap, density, is_biased } = gather;
        let (here, here_error) = (self.exact)(t)?;
        let neighbors = u32::try_from(k)?;
        let ball = |r: f64| density * 4.0 / 3.0 * PI * r * r * r;
        let (counted, summed) = (self.profile(t, Kernel::Uniform)?, self.profile(t, kernel)?);
        let number = |r: f64| ball(r) * counted.at(r);
        let right = nearest_expectation(neighbors, cap, number, |r| summed.at(r))?;
        let inside = |kernel, r| self.fog.mass(kernel, r, t).map_or(f64::NAN, |mass| here * mass);
        let number_uniform = |r: f64| ball(r) * inside(Kernel::Uniform, r);
        let uniform = nearest_expectation(neighbors, cap, number_uniform, |r| inside(kernel, r))?;
        let mut parts = Parts {
            exact: here,
            exact_error: here_error,
            edge: uniform.value / here - 1.0,
            blur: (right.value - uniform.value) / here,
            rule: 0.0,
            clusters: 0.0,
            error: (right.error + uniform.error + here_error) / here + INTERPOLATION,
        };
        if is_biased {
            let biased = nearest_expectation_biased(neighbors, cap, number, |r| summed.at(r))?;
            parts.rule = (biased.value - right.value) / here;
            parts.error += biased.error / here;
        }
        parts.clusters = self.clusters(k, density * here, parts.edge, parts.blur);
        Ok(parts)
    }
}
