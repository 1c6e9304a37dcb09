//! What theory predicts of every case, in parts, before anything is measured.

use super::cases::{Case, Size};
use super::fields::{CELL, FIELDS, Field};
use crate::harness::{Prediction, Settings, Unit};
use crate::theory::{Exact, Table, nearest_clustering, referee_kernel};
use anyhow::Context;
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::OnceLock;
use turbid::estimators::Kernel;
use turbid_analytic::kernel as referee;
use turbid_analytic::nearest::{nearest_expectation, nearest_expectation_biased};
use turbid_analytic::slab_kernel::{edge_loss, slab_moment};

/// The predicted error of a case in parts, each as a fraction of the exact fluence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Exact fluence per unit irradiance.
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

/// A field with all that predictions ask of it.
pub struct Theory {
    field: &'static Field,
    exact: Exact,
    /// Kernel means by depth and kernel, tabulated when first asked for.
    profiles: Vec<(f64, Kernel, OnceLock<Table>)>,
}

/// What interpolation of the kernel means adds to the error of a nearest expectation, tested in `table`.
const INTERPOLATION: f64 = 1e-8;

impl Theory {
    /// The theory of a field.
    pub fn new(field: &'static Field) -> anyhow::Result<Self> {
        let places = field.depths.iter().flat_map(|&depth| Kernel::ALL.map(|kernel| (depth, kernel)));
        let profiles = places.map(|(depth, kernel)| (depth, kernel, OnceLock::new())).collect();
        Ok(Theory { field, exact: field.exact()?, profiles })
    }

    fn profile(&self, depth: f64, kernel: Kernel) -> anyhow::Result<&Table> {
        let found = self.profiles.iter().find(|(d, k, _)| *d == depth && *k == kernel);
        let (_, _, slot) = found.with_context(|| format!("depth {depth} is none of {}", self.field.name))?;
        if let Some(profile) = slot.get() {
            return Ok(profile);
        }
        // Two threads may tabulate the same means at once; they find the same numbers.
        let profile =
            Table::of_kernel_means(referee_kernel(kernel), depth, self.field.tau, 0.5 * CELL, &self.exact)?;
        Ok(slot.get_or_init(|| profile))
    }

    /// The parts of one case. Fixed radii may be asked at any depth, nearest gathers at the field's own.
    pub fn parts(&self, case: &Case) -> anyhow::Result<Parts> {
        let (tau, t) = (case.field.tau, case.depth);
        let kernel = referee_kernel(case.kernel);
        let (here, here_error) = (self.exact)(t)?;
        let field = |depth: f64| (self.exact)(depth).map_or(f64::NAN, |(value, _)| value);
        let mut parts = Parts {
            exact: here,
            exact_error: here_error,
            edge: 0.0,
            blur: 0.0,
            rule: 0.0,
            clusters: 0.0,
            error: 0.0,
        };
        match case.size {
            Size::Radius(r) => {
                let split = edge_loss(kernel, r, t, tau, field)?;
                parts.edge = split.edge.value / here;
                parts.blur = split.blur.value / here;
                parts.error = (split.edge.error + split.blur.error + here_error) / here;
            }
            Size::Nearest(k) | Size::NearestBiased(k) => {
                let (neighbors, cap) = (u32::try_from(k)?, case.cap());
                // Photons per volume where the fluence is 1.
                let density = case.photons as f64 / (CELL * CELL);
                let ball = |r: f64| density * 4.0 / 3.0 * PI * r * r * r;
                let (counted, summed) = (self.profile(t, Kernel::Uniform)?, self.profile(t, case.kernel)?);
                let number = |r: f64| ball(r) * counted.at(r);
                let right = nearest_expectation(neighbors, cap, number, |r| summed.at(r))?;
                let inside =
                    |kernel, r| slab_moment(kernel, 0, r, t, tau).map_or(f64::NAN, |v| here * v.value);
                let number_uniform = |r: f64| ball(r) * inside(referee::Kernel::Uniform, r);
                let uniform = nearest_expectation(neighbors, cap, number_uniform, |r| inside(kernel, r))?;
                parts.edge = uniform.value / here - 1.0;
                parts.blur = (right.value - uniform.value) / here;
                parts.error = (right.error + uniform.error + here_error) / here + INTERPOLATION;
                if case.is_biased() {
                    let biased = nearest_expectation_biased(neighbors, cap, number, |r| summed.at(r))?;
                    parts.rule = (biased.value - right.value) / here;
                    parts.error += biased.error / here;
                }
                if case.field.has_clusters() {
                    // Where the medium ends inside the ball, neighbours are missing like the ball's own part, and the
                    // estimate that they raise is itself lower.
                    let inside = 1.0 + parts.edge;
                    let raised =
                        nearest_clustering(case.field.albedo, case.field.g, density * here * inside, k);
                    parts.clusters = raised * inside * (1.0 + parts.edge + parts.blur);
                }
            }
        }
        Ok(parts)
    }
}

/// All cases of a study with their parts, computed in parallel.
pub fn budget(settings: &Settings) -> anyhow::Result<Vec<(Case, Parts)>> {
    let mut all = Vec::new();
    for field in &FIELDS {
        let theory = Theory::new(field)?;
        let cases: Vec<Case> =
            field.photons(settings).into_iter().flat_map(|n| Case::all(field, n)).collect();
        let predicted: Vec<anyhow::Result<(Case, Parts)>> =
            cases.into_par_iter().map(|case| theory.parts(&case).map(|p| (case, p))).collect();
        for item in predicted {
            all.push(item?);
        }
    }
    Ok(all)
}

/// The parts of a case, as they were written down.
pub fn recall(predictions: &HashMap<(&str, &str), (f64, f64)>, case: &Case) -> anyhow::Result<Parts> {
    let name = case.name();
    let find = |quantity: &str| {
        let found = predictions.get(&(name.as_str(), quantity));
        found.copied().with_context(|| format!("no prediction of {quantity} of {name}"))
    };
    let part = |name: &str| find(&format!("error from {name}")).map(|(value, _)| value / 100.0);
    let (exact, exact_error) = find("exact fluence")?;
    let [edge, blur, rule, clusters] = PART_NAMES;
    Ok(Parts {
        exact,
        exact_error,
        edge: part(edge)?,
        blur: part(blur)?,
        rule: part(rule)?,
        clusters: part(clusters)?,
        error: find("error")?.1 / 100.0,
    })
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let mut predictions = Vec::new();
    for (case, parts) in budget(settings)? {
        let mut add = |quantity: &str, unit, value: f64, error: f64, source: &str| {
            let (case, quantity, source) = (case.name(), quantity.to_string(), source.to_string());
            predictions.push(Prediction { case, quantity, unit, value, error, source });
        };
        let fluence = parts.exact * (1.0 + parts.total());
        add("exact fluence", Unit::FLUENCE, parts.exact, parts.exact_error, "exact solution of the slab");
        add(
            "fluence",
            Unit::FLUENCE,
            fluence,
            parts.exact * parts.error,
            "exact field, kernel mean, k-nearest law",
        );
        add("error", Unit::PERCENT, 100.0 * parts.total(), 100.0 * parts.error, "sum of the parts");
        let sources = [
            "kernel mean of a uniform field in the medium, less 1",
            "kernel mean of the exact field, less the edge",
            "expectation with the k-th photon summed, less without",
            "photons of one history, first order in the radius",
        ];
        for ((name, value), source) in PART_NAMES.iter().zip(parts.list()).zip(sources) {
            add(&format!("error from {name}"), Unit::PERCENT, 100.0 * value, 100.0 * parts.error, source);
        }
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(field: &'static Field, depth: f64, radius: f64) -> f64 {
        let case = Case { field, photons: 1, depth, size: Size::Radius(radius), kernel: Kernel::Uniform };
        100.0 * Theory::new(field).unwrap().parts(&case).unwrap().total()
    }

    /// Errors in per cent of the plain estimate in the slab of albedo 0.9, computed elsewhere by another program and
    /// printed to 0.01.
    #[test]
    fn known_errors_at_and_near_the_lit_face() {
        let field = Field::named("albedo0.9").unwrap();
        for (radius, depth, error) in [(0.2, 0.0, -47.12), (0.2, 0.1, -15.89), (0.4, 0.4, -1.43)] {
            let found = total(field, depth, radius);
            assert!((found - error).abs() < 0.0051, "radius {radius} depth {depth}: {found}, not {error}");
        }
    }

    /// The ball mean of e^-t in closed form, 3 (x cosh x - sinh x) / x^3.
    #[test]
    fn whole_balls_of_uncollided_photons() {
        let field = Field::named("uncollided").unwrap();
        for x in [0.1, 0.4, 0.8] {
            let mean = 3.0 * (x * libm::cosh(x) - libm::sinh(x)) / (x * x * x);
            // Cancellation of the closed form at small x: a few 1e-16 over x^2.
            assert!((total(field, 1.0, x) - 100.0 * (mean - 1.0)).abs() < 1e-9, "radius {x}");
        }
    }

    /// In a field of small slope the biased rule reads k/(k-1) high, and the right one does not.
    #[test]
    fn the_biased_rule_reads_high() {
        let field = Field::named("uncollided").unwrap();
        let theory = Theory::new(field).unwrap();
        let case = |size| Case { field, photons: 1_000_000, depth: 1.0, size, kernel: Kernel::Uniform };
        let right = theory.parts(&case(Size::Nearest(10))).unwrap();
        let wrong = theory.parts(&case(Size::NearestBiased(10))).unwrap();
        assert!(right.total().abs() < 1e-3);
        // One part in 9 of the right value; the few under-full gathers, which are right, take 1e-3 of it.
        assert!((wrong.rule / (1.0 + right.total()) - 1.0 / 9.0).abs() < 2e-4, "{}", wrong.rule);
    }
}
