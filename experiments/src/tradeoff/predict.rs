//! What theory says of every setting, before anything is measured: its error, split, and the settings that would
//! reach a target beyond those that are measured.

use super::cases::{BODIES, Body, LAYERS, PROBES, Setting, Treatment};
use super::theory::{Expected, Rms, Theory};
use crate::harness::{self, Prediction, Settings, Unit};
use crate::theory::Fog;
use rayon::prelude::*;

/// Root mean square errors that somebody may want.
pub const TARGETS: [f64; 3] = [0.1, 0.03, 0.01];
/// Radii that the search for the cheapest fixed radius tries \[mfp\].
const TRIED: usize = 120;
const TRIED_FROM: f64 = 0.002;
const TRIED_TO: f64 = 1.0;
/// Photons of reference, from which others follow: variances go as one over their number.
const REFERENCE: f64 = 1e6;

/// Quantities of predictions, also those of the result rows.
pub const RMS: &str = "RMS error";
/// The part of it that more maps do not take away.
pub const BIAS: &str = "RMS bias";
/// The part that they do.
pub const NOISE: &str = "RMS noise";

/// The cheapest gather of fixed radius that theory knows for a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimum {
    /// Radius \[mfp\].
    pub radius: f64,
    /// Photons emitted per emitted power: in slabs per square mean free path.
    pub density: f64,
    /// Cost of 4096 queries of one cell \[operations\].
    pub cost: f64,
}

/// The name of the search for a target.
pub fn optimum_case(body: &Body, treatment: Treatment, target: f64) -> String {
    format!("{} {} to reach {}%", body.name, treatment.name(), 100.0 * target)
}

/// Operations per emitted photon before the first query: its rays (every collision is one, and the escape of those
/// that are not absorbed), and a record in the tree a collision.
pub fn prepare(collisions: f64, albedo: f64) -> f64 {
    collisions + 1.0 - (1.0 - albedo) * collisions + collisions
}

/// The fixed radius and the number of photons that reach a target with the fewest operations for 4096 queries.
fn optimum(theory: &Theory, body: &Body, treatment: Treatment, target: f64) -> anyhow::Result<Optimum> {
    let per_photon = prepare(theory.collisions()?, body.albedo);
    let mut best = Optimum { radius: f64::NAN, density: f64::NAN, cost: f64::INFINITY };
    for i in 0..TRIED {
        let step = i as f64 / (TRIED - 1) as f64;
        let radius = TRIED_FROM * libm::pow(TRIED_TO / TRIED_FROM, step);
        let layers = body.depths().into_iter().map(|t| theory.within(radius, REFERENCE, treatment, t));
        let layers = layers.collect::<anyhow::Result<Vec<Expected>>>()?;
        let rms = Rms::of(&layers);
        let room = target * target - rms.bias * rms.bias;
        if room <= 0.0 {
            continue;
        }
        let photons = REFERENCE * rms.noise * rms.noise / room;
        let cost = photons * per_photon + PROBES as f64 * found(theory, body, radius, photons)?;
        if cost < best.cost {
            best = Optimum { radius, density: photons / body.power(), cost };
        }
    }
    Ok(best)
}

/// Photons in a ball of fixed radius, on average over the layers.
fn found(theory: &Theory, body: &Body, radius: f64, photons: f64) -> anyhow::Result<f64> {
    let mut sum = 0.0;
    for t in body.depths() {
        let (here, _) = theory.exact(t)?;
        let part = 1.0 + theory.within(radius, photons, Treatment::Plain, t)?.bias();
        let ball = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
        sum += photons / body.power() * ball * here * part;
    }
    Ok(sum / LAYERS as f64)
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let every = Setting::every(settings);
    let theories: Vec<Theory> =
        BODIES.iter().map(|body| Theory::new(body, every.iter())).collect::<anyhow::Result<_>>()?;
    let theory = |body: &Body| {
        let index = BODIES.iter().position(|s| s == body).unwrap_or(0);
        &theories[index]
    };
    let asked: Vec<(Setting, Treatment)> =
        every.iter().flat_map(|&s| Treatment::ALL.map(|treatment| (s, treatment))).collect();
    let known: Vec<(Setting, Treatment, Vec<Expected>)> = asked
        .into_par_iter()
        .map(|(setting, treatment)| {
            let one = |t| theory(setting.body).expected(&setting, treatment, t);
            let layers: anyhow::Result<_> = setting.body.depths().into_iter().map(one).collect();
            Ok((setting, treatment, layers?))
        })
        .collect::<anyhow::Result<_>>()?;
    let mut all = Vec::new();
    let mut add = |case: &str, quantity: &str, unit, value: f64, error: f64, source: &str| {
        let (case, quantity, source) = (case.to_string(), quantity.to_string(), source.to_string());
        all.push(Prediction { case, quantity, unit, value, error, source });
    };
    for (setting, treatment, layers) in &known {
        let (case, rms) = (setting.case(*treatment), Rms::of(layers));
        let error = 100.0 * layers.iter().map(|e| e.error).fold(0.0, f64::max);
        add(&case, RMS, Unit::PERCENT, 100.0 * rms.total(), error, "bias and noise of every layer");
        add(&case, BIAS, Unit::PERCENT, 100.0 * rms.bias, error, "exact field, kernel mean, k-nearest law");
        add(&case, NOISE, Unit::PERCENT, 100.0 * rms.noise, error, "Poisson's law and clusters");
    }
    let searches: Vec<(&'static Body, Treatment, f64)> = BODIES
        .iter()
        .flat_map(|body| Treatment::ALL.map(|treatment| (body, treatment)))
        .flat_map(|(body, treatment)| TARGETS.map(|target| (body, treatment, target)))
        .collect();
    let found: Vec<Optimum> = searches
        .par_iter()
        .map(|&(body, treatment, target)| optimum(theory(body), body, treatment, target))
        .collect::<anyhow::Result<_>>()?;
    for ((body, treatment, target), best) in searches.into_iter().zip(found) {
        let case = optimum_case(body, treatment, target);
        let source = "cheapest fixed radius, by bias and noise of every layer";
        add(&case, "radius", Unit::MFP, best.radius, 0.0, source);
        add(&case, "photons per area", Unit::new("1/mfp^2"), best.density, 0.0, source);
        add(&case, "operations", Unit::ONE, best.cost, 0.0, source);
    }
    for body in &BODIES {
        let source = match body.fog {
            Fog::Slab { .. } => "exact solution of the slab",
            Fog::Sphere { .. } => "exact solution of the sphere",
        };
        let collisions = theory(body).collisions()?;
        add(body.name, "collisions per photon", Unit::ONE, collisions, 1e-6, "integral of the exact fluence");
        for t in body.depths() {
            let (value, error) = theory(body).exact(t)?;
            add(body.name, &format!("fluence t={t}"), Unit::FLUENCE, value, error, source);
        }
    }
    for (setting, treatment, layers) in &known {
        let case = setting.case(*treatment);
        for (t, e) in setting.body.depths().into_iter().zip(layers) {
            let parts = [e.edge, e.blur, e.clusters, e.noise, e.noise_independent];
            for (name, value) in PARTS.iter().zip(parts) {
                let (value, error) = (100.0 * value, 100.0 * e.error);
                add(&case, &format!("{name} t={t}"), Unit::PERCENT, value, error, "theory of one layer");
            }
        }
    }
    Ok(all)
}

/// The parts of a layer's prediction.
const PARTS: [&str; 5] = ["edge", "blur", "clusters", "noise", "noise of independent photons"];

/// The predictions, to be asked.
pub struct Known<'a>(harness::Known<'a>);

impl<'a> Known<'a> {
    /// From the list.
    pub fn new(predictions: &'a [Prediction]) -> Self {
        Known(harness::Known::new(predictions))
    }

    /// One value and its bound.
    pub fn get(&self, case: &str, quantity: &str) -> anyhow::Result<(f64, f64)> {
        self.0.get(case, quantity)
    }

    /// The layers of a setting.
    pub fn layers(&self, setting: &Setting, treatment: Treatment) -> anyhow::Result<Vec<Expected>> {
        let case = setting.case(treatment);
        let one = |t: f64| {
            let part = |i: usize| self.get(&case, &format!("{} t={t}", PARTS[i])).map(|v| v.0 / 100.0);
            Ok(Expected {
                edge: part(0)?,
                blur: part(1)?,
                clusters: part(2)?,
                noise: part(3)?,
                noise_independent: part(4)?,
                error: self.get(&case, &format!("{} t={t}", PARTS[0]))?.1 / 100.0,
            })
        };
        setting.body.depths().into_iter().map(one).collect()
    }

    /// What theory would do to reach a target.
    pub fn optimum(&self, body: &Body, treatment: Treatment, target: f64) -> anyhow::Result<Optimum> {
        let case = optimum_case(body, treatment, target);
        Ok(Optimum {
            radius: self.get(&case, "radius")?.0,
            density: self.get(&case, "photons per area")?.0,
            cost: self.get(&case, "operations")?.0,
        })
    }
}
