//! What theory says of every setting, before anything is measured: its error, split, and the settings that would
//! reach a target beyond those that are measured.

use super::cases::{FIELDS, Field, LAYERS, PROBES, Setting, Treatment};
use super::theory::{Expected, Rms, Theory};
use crate::harness::{Settings, Unit, percent};
use crate::prediction::{Prediction, Predictions};
use turbid::transport::in_parallel;

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
pub fn optimum_case(field: &Field, treatment: Treatment, target: f64) -> String {
    format!("{} {} to reach {}%", field.name, treatment.name(), percent(target))
}

/// Operations per emitted photon before the first query: its rays (every collision is one, and the escape of those
/// that are not absorbed), and a record in the tree a collision.
pub fn prepare(collisions: f64, albedo: f64) -> f64 {
    collisions + 1.0 - (1.0 - albedo) * collisions + collisions
}

/// The fixed radius and the number of photons that reach a target with the fewest operations for 4096 queries.
fn optimum(theory: &Theory, field: &Field, treatment: Treatment, target: f64) -> anyhow::Result<Optimum> {
    let per_photon = prepare(theory.collisions()?, field.setup.albedo);
    let mut best = Optimum { radius: f64::NAN, density: f64::NAN, cost: f64::INFINITY };
    for i in 0..TRIED {
        let step = i as f64 / (TRIED - 1) as f64;
        let radius = TRIED_FROM * libm::pow(TRIED_TO / TRIED_FROM, step);
        let layers = field.depths().into_iter().map(|t| theory.within(radius, REFERENCE, treatment, t));
        let layers = layers.collect::<anyhow::Result<Vec<Expected>>>()?;
        let rms = Rms::of(&layers);
        let room = target * target - rms.bias * rms.bias;
        if room <= 0.0 {
            continue;
        }
        let photons = REFERENCE * rms.noise * rms.noise / room;
        let cost = photons * per_photon + PROBES as f64 * found(theory, field, radius, photons)?;
        if cost < best.cost {
            best = Optimum { radius, density: photons / field.setup.power(), cost };
        }
    }
    Ok(best)
}

/// Photons in a ball of fixed radius, on average over the layers.
fn found(theory: &Theory, field: &Field, radius: f64, photons: f64) -> anyhow::Result<f64> {
    let mut sum = 0.0;
    for t in field.depths() {
        let (here, _) = theory.exact(t)?;
        let part = 1.0 + theory.within(radius, photons, Treatment::Plain, t)?.bias();
        let ball = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
        sum += photons / field.setup.power() * ball * here * part;
    }
    Ok(sum / LAYERS as f64)
}

/// The predictions, as they are written down before the measurement.
pub fn predict(settings: &Settings) -> anyhow::Result<Vec<Prediction>> {
    let every = Setting::every(settings);
    let theories: Vec<Theory> =
        FIELDS.into_iter().map(|field| Theory::new(field, every.iter())).collect::<anyhow::Result<_>>()?;
    let theory = |field: &Field| {
        let index = FIELDS.into_iter().position(|s| s == field).unwrap_or(0);
        &theories[index]
    };
    let asked: Vec<(Setting, Treatment)> =
        every.iter().flat_map(|&s| Treatment::ALL.map(|treatment| (s, treatment))).collect();
    let expected = |i: usize| -> anyhow::Result<(Setting, Treatment, Vec<Expected>)> {
        let (setting, treatment) = asked[i];
        let one = |t| theory(setting.field).expected(&setting, treatment, t);
        let layers: anyhow::Result<_> = setting.field.depths().into_iter().map(one).collect();
        Ok((setting, treatment, layers?))
    };
    let known = in_parallel(asked.len(), expected).into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    let mut all = Vec::new();
    let mut add = |case: &str, quantity: &str, unit, value: (f64, f64), source: &str| {
        all.push(Prediction::new(case, quantity, unit, value, source));
    };
    for (setting, treatment, layers) in &known {
        let (case, rms) = (setting.case(*treatment), Rms::of(layers));
        let error = layers.iter().map(|e| e.error).fold(0.0, f64::max);
        add(&case, RMS, Unit::FRACTION, (rms.total(), error), "bias and noise of every layer");
        add(&case, BIAS, Unit::FRACTION, (rms.bias, error), "exact field, kernel mean, k-nearest law");
        add(&case, NOISE, Unit::FRACTION, (rms.noise, error), "Poisson's law and clusters");
    }
    let searches: Vec<(&'static Field, Treatment, f64)> = FIELDS
        .into_iter()
        .flat_map(|field| Treatment::ALL.map(|treatment| (field, treatment)))
        .flat_map(|(field, treatment)| TARGETS.map(|target| (field, treatment, target)))
        .collect();
    let best = |i: usize| {
        let (field, treatment, target) = searches[i];
        optimum(theory(field), field, treatment, target)
    };
    let found = in_parallel(searches.len(), best).into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    for ((field, treatment, target), best) in searches.into_iter().zip(found) {
        let case = optimum_case(field, treatment, target);
        let source = "cheapest fixed radius, by bias and noise of every layer";
        add(&case, "radius", Unit::MFP, (best.radius, 0.0), source);
        add(&case, "photons per area", Unit::new("1/mfp^2"), (best.density, 0.0), source);
        add(&case, "operations", Unit::ONE, (best.cost, 0.0), source);
    }
    for field in FIELDS {
        let source = field.setup.source();
        let collisions = theory(field).collisions()?;
        add(
            field.name,
            "collisions per photon",
            Unit::ONE,
            (collisions, 1e-6),
            "integral of the exact fluence",
        );
        for t in field.depths() {
            let exact = theory(field).exact(t)?;
            add(field.name, &format!("fluence t={t}"), Unit::FLUENCE, exact, source);
        }
    }
    for (setting, treatment, layers) in &known {
        let case = setting.case(*treatment);
        for (t, e) in setting.field.depths().into_iter().zip(layers) {
            for (name, part) in PARTS {
                let value = (part(e), e.error);
                add(&case, &format!("{name} t={t}"), Unit::FRACTION, value, "theory of one layer");
            }
        }
    }
    Ok(all)
}

/// What is written down of a layer, by name.
type Part = (&'static str, fn(&Expected) -> f64);
const EDGE: Part = ("edge", |e| e.edge);
const BLUR: Part = ("blur", |e| e.blur);
const CLUSTERS: Part = ("clusters", |e| e.clusters);
const SPREAD: Part = ("noise", |e| e.noise);
const INDEPENDENT: Part = ("noise of independent photons", |e| e.noise_independent);
const PARTS: [Part; 5] = [EDGE, BLUR, CLUSTERS, SPREAD, INDEPENDENT];

/// The layers of a setting, as they were written down.
pub fn layers(known: &Predictions, setting: &Setting, treatment: Treatment) -> anyhow::Result<Vec<Expected>> {
    let case = setting.case(treatment);
    let one = |t: f64| {
        let read = |(name, _): Part| known.get(&case, &format!("{name} t={t}"));
        let fraction = |part: Part| read(part).map(|(value, _)| value);
        Ok(Expected {
            edge: fraction(EDGE)?,
            blur: fraction(BLUR)?,
            clusters: fraction(CLUSTERS)?,
            noise: fraction(SPREAD)?,
            noise_independent: fraction(INDEPENDENT)?,
            error: read(EDGE)?.1,
        })
    };
    setting.field.depths().into_iter().map(one).collect()
}

/// What theory would do to reach a target, as it was written down.
pub fn known_optimum(
    known: &Predictions,
    field: &Field,
    treatment: Treatment,
    target: f64,
) -> anyhow::Result<Optimum> {
    let case = optimum_case(field, treatment, target);
    Ok(Optimum {
        radius: known.get(&case, "radius")?.0,
        density: known.get(&case, "photons per area")?.0,
        cost: known.get(&case, "operations")?.0,
    })
}
