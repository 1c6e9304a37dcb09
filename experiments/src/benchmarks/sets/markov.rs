//! Binary Markov mixtures of Adams, Larsen and Pomraning.

use super::{Plot, Set};
use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, timed};
use rayon::prelude::*;
use turbid::rng::{Purpose, Stream};
use turbid::stats::Moments;
use turbid_analytic::{Ground, Incidence, Layer, Phase, StratifiedSlab};

pub(super) const SET: Set = Set {
    name: "markov",
    title: "Binary Markov mixtures",
    source: "M. L. Adams, E. W. Larsen and G. C. Pomraning, JQSRT 42 (1989), cases 2, 3, 5 and 7, recomputed by others with 1e8 realisations",
    about: "Reflectance and transmittance of a slab of two materials in layers of exponentially distributed thickness, in the mean over \
            realisations; isotropic scattering, isotropic light on one face.",
    trust: "Seven digits of the recomputation, whose standard error is taken as 1e-4 of the root of the value, that of 1e8 histories which each leave or \
            do not. The numbers of 1989, with four digits, are off by up to 1 per cent.",
    explained: &[],
    open: false,
    plot: Plot::Rows,
    seconds: [10.0, 180.0],
    run,
};

/// A material: extinction, albedo, mean chord.
type Material = [f64; 3];

fn run(bench: &Bench) -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "adams_larsen_pomraning.csv",
        include_str!("../tables/adams_larsen_pomraning.csv"),
        &[
            "bench",
            "sigma_t_1",
            "sigma_t_2",
            "albedo_1",
            "albedo_2",
            "mean_chord_1",
            "mean_chord_2",
            "thickness",
            "quantity",
            "published_ensemble",
            "recomputed_1e8_realizations",
        ],
    )?;
    let entries: Vec<Entry> = table.entries().collect();
    let realisations = bench.pick(25, 400);
    let exact = timed("exact, ensemble", || {
        let mut rows = Vec::new();
        for (index, pair) in entries.chunks(2).enumerate() {
            let e = &pair[0];
            let material = |i: usize| -> anyhow::Result<Material> {
                Ok([
                    e.fraction(&format!("sigma_t_{i}"))?,
                    e.number(&format!("albedo_{i}"))?,
                    e.fraction(&format!("mean_chord_{i}"))?,
                ])
            };
            let materials = [material(1)?, material(2)?];
            let thickness = e.number("thickness")?;
            let found = ensemble(&materials, thickness, realisations, bench.seed(), index as u64)?;
            for (e, moments) in pair.iter().zip(&found) {
                let theirs = e.number("recomputed_1e8_realizations")?;
                let case = format!("case {}, thickness {thickness}", e.text("bench")?);
                let ours = (moments.mean(), Some(moments.std_error()));
                let theirs = (theirs, 1e-4 * libm::sqrt(theirs));
                rows.push(Row::new(&case, e.text("quantity")?, rows.len() as f64, theirs, ours));
            }
        }
        Ok(rows)
    })?;
    Ok(vec![exact])
}

/// Reflectance and transmittance over realisations.
fn ensemble(
    materials: &[Material; 2],
    thickness: f64,
    count: u64,
    seed: u64,
    case: u64,
) -> anyhow::Result<[Moments; 2]> {
    let answer = |realisation: u64| -> anyhow::Result<[f64; 2]> {
        let mut stream = Stream::new(seed, Purpose::Synthetic, case, realisation);
        let layers = layers(materials, thickness, &mut stream)?;
        let slab = StratifiedSlab::new(&layers, Ground::black(), Some(Incidence::Diffuse))?;
        Ok([slab.reflectance().value, slab.transmittance()?.value])
    };
    let answers: Vec<[f64; 2]> = (0..count).into_par_iter().map(answer).collect::<anyhow::Result<_>>()?;
    let mut moments = [Moments::new(), Moments::new()];
    for answer in answers {
        moments.iter_mut().zip(answer).for_each(|(m, x)| m.push(x));
    }
    Ok(moments)
}

/// One realisation: the first material by its share of the volume, then by turns.
fn layers(materials: &[Material; 2], thickness: f64, stream: &mut Stream) -> anyhow::Result<Vec<Layer>> {
    let [first, second] = materials.map(|m| m[2]);
    let mut which = usize::from(stream.unit() >= first / (first + second));
    let (mut left, mut layers) = (thickness, Vec::new());
    while left > 0.0 {
        let [extinction, albedo, chord] = materials[which];
        let length = (-chord * libm::log1p(-stream.unit())).min(left);
        // Thinner ones than the referee takes do nothing.
        if extinction * length > 1e-12 {
            layers.push(Layer::new(extinction * length, albedo, &Phase::isotropic())?);
        }
        left -= length;
        which = 1 - which;
    }
    Ok(layers)
}
