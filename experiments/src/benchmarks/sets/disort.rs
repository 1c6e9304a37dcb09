//! The test problems of DISORT.

use super::garcia_siewert::moments;
use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, timed};
use crate::benchmarks::set::{Plot, Set};
use anyhow::ensure;
use std::f64::consts::PI;
use turbid_analytic::beer_lambert::uncollided_fluence;
use turbid_analytic::{Ground, Incidence, Layer, Phase, StratifiedSlab};

pub(super) const SET: Set = Set {
    name: "disort",
    title: "Test problems 3, 8 and 9 of DISORT",
    source: "K. Stamnes, S.-C. Tsay, W. Wiscombe and K. Jayaweera 1988, as DISORT answers its own tests: problem 3 after van de Hulst 1980, 8 \
             after Ozisik and Shouman 1980, 9 after Devaux, Grandjean, Ishiguro and Siewert 1979",
    about: "Fluxes, their divergence and radiances of one, two and six layers; a beam of irradiance pi, or radiance 1/pi from all sides.",
    trust: "Answers of DISORT at few streams, not the papers' tables: the error taken for a flux is the largest deviation of any flux of the \
            case from DISORT at 64 streams, for a radiance 1e-3 of it. An anchor, not the truth.",
    explained: &[(
        "exact",
        "The radiance straight back from problem 3a, 0.0395460, is that of few streams and a peaked phase function: the exact value is 0.0390943, \
         which is pi times what `exact slab --tau 1 --albedo 1 --g 0.75 --mu0 1 --depth 0 --mu 1` gives by another method. Without that row the rest agrees.",
    )],
    open: false,
    plot: Plot::Rows,
    seconds: [2.0, 2.0],
    run: |_: &Bench| answer(),
};

/// What is given in a cell after a key, such as tau=1|2.
fn listed(text: &str, key: &str) -> Option<Vec<f64>> {
    let part = text.split(';').find_map(|part| part.trim().strip_prefix(key)?.strip_prefix('='))?;
    part.split('|').map(|number| number.parse().ok()).collect()
}

fn answer() -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "disort_published_tests.csv",
        include_str!("../tables/disort_published_tests.csv"),
        &[
            "case",
            "phase",
            "layers",
            "source",
            "quantity",
            "tau",
            "mu",
            "value",
            "case_worst_flux_dev_from_64_streams",
        ],
    )?;
    let entries: Vec<Entry> = table.entries().collect();
    let referee = timed("exact", || {
        let mut rows = Vec::new();
        for group in entries.chunk_by(|a, b| a.text("case").ok() == b.text("case").ok()) {
            let slab = slab(&group[0])?;
            let irradiance = match slab.incidence() {
                Some(Incidence::Beam { mu0 }) => PI * mu0,
                _ => 1.0,
            };
            for e in group {
                if let Some(row) = compare(e, &slab, irradiance, rows.len())? {
                    rows.push(row);
                }
            }
        }
        Ok(rows)
    })?;
    Ok(vec![referee])
}

fn slab(e: &Entry) -> anyhow::Result<StratifiedSlab> {
    let phase = match e.text("phase")? {
        "isotropic" => Phase::isotropic(),
        "henyey-greenstein g=0.75" => Phase::henyey_greenstein(0.75)?,
        _ => Phase::legendre(moments(include_str!("../tables/mie_L8_legendre.csv"))?)?,
    };
    let layers = e.text("layers")?;
    let (tau, albedo) =
        (listed(layers, "tau").unwrap_or_default(), listed(layers, "albedo").unwrap_or_default());
    ensure!(!tau.is_empty() && tau.len() == albedo.len(), "disort_published_tests.csv: layers are {layers}");
    let layers = tau.iter().zip(&albedo).map(|(&tau, &albedo)| Layer::new(tau, albedo, &phase));
    let layers = layers.collect::<Result<Vec<_>, _>>()?;
    let incidence =
        if e.text("source")? == "beam" { Incidence::Beam { mu0: 1.0 } } else { Incidence::Diffuse };
    Ok(StratifiedSlab::new(&layers, Ground::black(), Some(incidence))?)
}

fn compare(e: &Entry, slab: &StratifiedSlab, irradiance: f64, index: usize) -> anyhow::Result<Option<Row>> {
    let t = e.number("tau")?.min(slab.tau());
    let streams = e.number("case_worst_flux_dev_from_64_streams")?;
    let (value, rounding) = e.rounded("value")?;
    let is_beam = matches!(slab.incidence(), Some(Incidence::Beam { .. }));
    let quantity = e.text("quantity")?;
    // What comes in is not an answer.
    if value == 0.0
        || (t == 0.0
            && (quantity == "flux_down_diffuse" || (quantity == "radiance" && e.number("mu")? < 0.0)))
    {
        return Ok(None);
    }
    let (ours, relative) = match quantity {
        "flux_up" => (slab.flux_up(t)?, streams),
        // Of light from all sides DISORT counts all of it as diffuse.
        "flux_down_diffuse" if !is_beam => (slab.flux_down(t)?, streams),
        "flux_down_diffuse" => {
            let down = slab.flux_down(t)?;
            (turbid_analytic::Value { value: down.value - libm::exp(-t), ..down }, streams)
        }
        "radiance" => {
            let mu = e.number("mu")?;
            let ours = slab.radiance(t, &[mu])?[0];
            let direct = match (is_beam, mu < 0.0) {
                (false, true) => libm::exp(t / mu) / PI,
                _ => 0.0,
            };
            (turbid_analytic::Value { value: ours.value + direct, ..ours }, 1e-3)
        }
        "flux_divergence_dF/dtau" => {
            let above = slab.depths().iter().rposition(|&depth| depth < t).unwrap_or(0);
            let fluence = slab.fluence(t)?;
            let absorbed = 1.0 - slab.layers()[above].albedo();
            let nodes = if is_beam {
                0.0
            } else {
                // What few streams make of the fluence of light that was not scattered.
                let four = turbid_analytic::quadrature::GaussLegendre::new(4)?;
                let coarse = four.integrate(0.0, 1.0, |mu| 2.0 * libm::exp(-t / mu));
                (coarse - uncollided_fluence(Incidence::Diffuse, t)?.value).abs() / fluence.value
            };
            let value = absorbed * fluence.value;
            (turbid_analytic::Value { value, error: absorbed * fluence.error, ..fluence }, streams + nodes)
        }
        _ => return Ok(None),
    };
    let theirs = (value, libm::hypot(relative * value, rounding));
    let (case, at) = (e.text("case")?, index as f64);
    let ours = (ours.value * irradiance, Some(ours.error * irradiance));
    Ok(Some(Row::new(case, quantity, at, theirs, ours)))
}
