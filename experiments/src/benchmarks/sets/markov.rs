//! Binary Markov mixtures of Adams, Larsen and Pomraning.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, timed};
use crate::benchmarks::set::{Plot, Set};
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
            do not. The numbers of 1989, with four digits, differ from them by up to 2 per cent.",
    explained: &[("exact, ensemble", BEYOND), ("light tracing, ensemble", BEYOND)],
    open: false,
    plot: Plot::Rows,
    seconds: [10.0, 180.0],
    run,
};

const BEYOND: &str = "In case 3 both materials have the albedo 0.9, so that the reflectance depends on the optical thickness alone, and cannot exceed that of \
                      the half-space, 0.478024. The recomputed 0.4799376 at thickness 10 does, and so does 0.4785 of 1989: neither can be right. In case 7 at \
                      thickness 0.1 the recomputed reflectance and transmittance add up to 1.001. Our two ensembles, exact layers and photons in the same kind of \
                      realisations, agree with each other; the tables lie up to 3 per cent off them, most of all in reflectances, as the errors of \
                      a few ordinates might.";

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
    let realisations = bench.pick(25, 1_000);
    let exact = timed("exact, ensemble", || {
        let mut rows = Vec::new();
        for (index, pair) in entries.chunks(2).enumerate() {
            let materials = [material(&pair[0], 1)?, material(&pair[0], 2)?];
            let thickness = pair[0].number("thickness")?;
            let found = ensemble(&materials, thickness, realisations, bench.seed(), index as u64)?;
            rows.extend(compared(pair, &found, rows.len())?);
        }
        Ok(rows)
    })?;
    let light = timed("light tracing, ensemble", || {
        let mut rows = Vec::new();
        for pair in entries.chunks(2) {
            let materials = [material(&pair[0], 1)?, material(&pair[0], 2)?];
            let thickness = pair[0].number("thickness")?;
            let mut found = [Moments::new(), Moments::new()];
            bench.scene(&format!("markov-{}", rows.len() / 2), &scene(&materials, thickness, 0))?;
            let realisation = |seed: u64| {
                let measured =
                    bench.light_of(&bench.parsed(&scene(&materials, thickness, seed))?, 200, seed)?;
                Ok([measured[0].mean, measured[1].mean])
            };
            let answers: Vec<[f64; 2]> = (0..bench.pick(100, 10_000))
                .into_par_iter()
                .map(realisation)
                .collect::<anyhow::Result<_>>()?;
            for answer in answers {
                found.iter_mut().zip(answer).for_each(|(m, x)| m.push(x));
            }
            rows.extend(compared(pair, &found, rows.len())?);
        }
        Ok(rows)
    })?;
    Ok(vec![exact, light])
}

fn material(e: &Entry, i: usize) -> anyhow::Result<Material> {
    Ok([
        e.fraction(&format!("sigma_t_{i}"))?,
        e.number(&format!("albedo_{i}"))?,
        e.fraction(&format!("mean_chord_{i}"))?,
    ])
}

/// Reflectance and transmittance of one case.
fn compared(pair: &[Entry], found: &[Moments; 2], first: usize) -> anyhow::Result<Vec<Row>> {
    let row = |(i, (e, moments)): (usize, (&Entry, &Moments))| {
        let theirs = e.number("recomputed_1e8_realizations")?;
        let case = format!("case {}, thickness {}", e.text("bench")?, e.number("thickness")?);
        let ours = (moments.mean(), Some(moments.std_error()).filter(|_| !moments.is_heavy_tailed()));
        Ok(Row::new(
            &case,
            e.text("quantity")?,
            (first + i) as f64,
            (theirs, 1e-4 * libm::sqrt(theirs)),
            ours,
        ))
    };
    pair.iter().zip(found).enumerate().map(row).collect()
}

/// One realisation for the simulator.
fn scene([a, b]: &[Material; 2], thickness: f64, seed: u64) -> String {
    let slab = format!("{{ slab = {{ top = 0.0, thickness = {thickness:?} }} }}");
    let mut text = format!(
        "cell = 1.0\n\n[[regions]]\nshape = {slab}\nsigma_t = 1.0\nalbedo = 1.0\ng = 0.0\ndensity = {{ markov = {{ axis = \"z\", from = 0.0, to = \
         {thickness:?}, mean_chord = [{:?}, {:?}], density = [{:?}, {:?}], albedo = [{:?}, {:?}], seed = {seed} }} }}\n\n[[lights]]\nisotropic = {{ shape = \
         {slab}, faces = \"top\", radiance = 1.0 }}\n",
        a[2], b[2], a[0], b[0], a[1], b[1]
    );
    for (name, face) in [("R", "top"), ("T", "bottom")] {
        text += &format!(
            "\n[[sensors]]\nname = \"{name}\"\nmeasure = {{ outflow = {{ shape = {slab}, face = \"{face}\" }} }}\n"
        );
    }
    text
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
