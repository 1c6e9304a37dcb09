//! Reed's slab.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use anyhow::Context;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::{Ground, Layer, Phase, StratifiedSlab};

pub(super) const SET: Set = Set {
    name: "reed",
    title: "Reed's slab",
    source: "W. H. Reed, Nucl. Sci. Eng. 46 (1971); cell averages by a Monte Carlo code with 3e10 histories",
    about: "Fluence, on average over cells of 0.1, in five materials from the mirror at x = 0 to the vacuum at x = 8: a source of 50 in a black \
            medium of extinction 50, a black medium of extinction 5, a void, a source of 1 in a scattering medium (extinction 1, albedo 0.9), the \
            same without source. A photon map counts in balls of 0.3, 36 cells away from interfaces; what the balls make of the exact field is predicted \
            (1.5 times it where the extinction is 5) and divided out.",
    trust: "Six digits and noise, which is not stated: in the scattering media neighbouring cells differ by 1e-4 at random and all of them \
            are uncertain by 6e-5 together, since one history in a hundred starts there; 2e-5 is taken in the black source and 1.2e-4 elsewhere.",
    explained: &[],
    open: false,
    plot: Plot::Curves { x: ("x", ""), y: ("Fluence", ""), is_log: false },
    seconds: [2.0, 40.0],
    run,
};

/// Extinction, albedo and source of the medium at x; nothing is in the void.
fn medium(x: f64) -> Option<[f64; 3]> {
    match x {
        x if x < 2.0 => Some([50.0, 0.0, 50.0]),
        x if x < 3.0 => Some([5.0, 0.0, 0.0]),
        x if x < 5.0 => None,
        x if x < 6.0 => Some([1.0, 0.9, 1.0]),
        _ => Some([1.0, 0.9, 0.0]),
    }
}

fn run(bench: &Bench) -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "reed_openmc.csv",
        include_str!("../tables/reed_openmc.csv"),
        &["x_cell_middle", "cell_width", "scalar_flux"],
    )?;
    // From the vacuum down to the mirror.
    let mut entries: Vec<Entry> = table.entries().collect();
    entries.reverse();
    let referee = timed("exact", || {
        let mut layers = Vec::new();
        for e in &entries {
            if let Some([extinction, albedo, source]) = medium(e.number("x_cell_middle")?) {
                let tau = extinction * e.number("cell_width")?;
                let layer = Layer::new(tau, albedo, &Phase::isotropic())?;
                layers.push(layer.emitting(source / extinction)?);
            }
        }
        let slab = StratifiedSlab::new(&layers, Ground::mirror(), None)?;
        let mut layer = 0;
        let mut rows = Vec::new();
        for e in &entries {
            let x = e.number("x_cell_middle")?;
            let ours = if medium(x).is_some() {
                layer += 1;
                slab.mean_fluence(layer - 1)?
            } else {
                // Nothing happens in the void: it has the fluence of its faces, at depth 3.
                slab.fluence(3.0)?
            };
            rows.push(row(e, exact(ours))?);
        }
        Ok(rows)
    })?;
    let light = timed("light tracing", || {
        let found = bench.light(&bench.scene("reed", &scene())?, bench.pick(100_000, 40_000_000))?;
        let answer = |e: &Entry| {
            let bin = (e.number("x_cell_middle")? / e.number("cell_width")?) as usize;
            let m = found.iter().find(|m| m.bin.is_some_and(|b| b.index[2] == bin));
            row(e, measured(m.context("Reed's slab has 80 cells")?))
        };
        entries.iter().map(answer).collect()
    })?;
    let map = timed("photon map", || by_map(bench, &entries))?;
    Ok(vec![referee, light, map])
}

/// Radius of the balls in which photons are counted, and the spans of cells whose balls stay in one medium.
const RADIUS: f64 = 0.3;
const WITHIN: [(u32, u32); 4] = [(3, 17), (23, 27), (53, 57), (63, 77)];

/// Means over cells of the estimates of photon maps, over what the ball makes of the exact field there.
fn by_map(bench: &Bench, entries: &[Entry]) -> anyhow::Result<Vec<Row>> {
    let mut text = column();
    for (from, to) in WITHIN {
        // A ball's radius from the mirrors at the sides.
        text += &format!(
            "[[sensors]]\nname = \"{from}\"\nmeasure = {{ mean-fluence = {{ min = [0.4, 0.4, {:?}], max = [0.6, 0.6, {:?}], cells = [1, 1, {}] }} }}\n\n",
            f64::from(from) / 10.0,
            f64::from(to) / 10.0,
            to - from
        );
    }
    let found = bench.maps(&bench.scene("reed-map", &text)?, bench.pick(5_000, 250_000), RADIUS)?;
    let layers = [[2.0, 0.9, 0.0], [1.0, 0.9, 1.0], [5.0, 0.0, 0.0], [100.0, 0.0, 1.0]]
        .map(|[tau, albedo, source]| Layer::new(tau, albedo, &Phase::isotropic())?.emitting(source));
    let layers = layers.into_iter().collect::<Result<Vec<_>, _>>()?;
    let slab = StratifiedSlab::new(&layers, Ground::mirror(), None)?;
    let field = |x: f64| -> anyhow::Result<f64> {
        let depth = match x {
            x if x < 2.0 => 8.0 + 50.0 * (2.0 - x),
            x if x < 3.0 => 3.0 + 5.0 * (3.0 - x),
            x => 8.0 - x,
        };
        Ok(slab.fluence(depth)?.value)
    };
    let across = GaussLegendre::new(12)?;
    // The ball's section at s radii from its middle has (3/4)(1 - s^2) of its volume.
    let blurred = |x: f64| {
        across.integrate(-1.0, 1.0, |s| 0.75 * (1.0 - s * s) * field(x + RADIUS * s).unwrap_or(f64::NAN))
    };
    let cell = GaussLegendre::new(3)?;
    let mut rows = Vec::new();
    for m in &found {
        let bin = m.bin.context("a cell")?.index[2] as u32 + m.sensor.parse::<u32>()?;
        let x = f64::from(bin) / 10.0;
        let mean = |f: &dyn Fn(f64) -> f64| cell.integrate(x, x + 0.1, f);
        let blur = mean(&blurred) / mean(&|x| field(x).unwrap_or(f64::NAN));
        let (value, error) = measured(m);
        let is_here =
            |e: &&Entry| e.number("x_cell_middle").is_ok_and(|middle| libm::fabs(middle - x - 0.05) < 1e-6);
        let e = entries.iter().find(is_here).context("Reed's slab has 80 cells")?;
        rows.push(row(e, (value / blur, error.map(|error| error / blur)))?);
    }
    Ok(rows)
}

/// A column of the slab between mirrors.
fn scene() -> String {
    column()
        + "[[sensors]]\nname = \"cell\"\nmeasure = { mean-fluence = { min = [0, 0, 0], max = [1, 1, 8], cells = [1, 1, 80] } }\n"
}

/// Its media, mirrors and sources.
fn column() -> String {
    const MEDIA: [[f64; 5]; 4] = [
        [0.0, 2.0, 50.0, 0.0, 50.0],
        [2.0, 3.0, 5.0, 0.0, 0.0],
        [5.0, 6.0, 1.0, 0.9, 1.0],
        [6.0, 8.0, 1.0, 0.9, 0.0],
    ];
    let mut text = String::new();
    for [from, to, extinction, albedo, _] in MEDIA {
        text += &format!(
            "[[regions]]\nshape = {{ cuboid = {{ min = [-0.5, -0.5, {from:?}], max = [1.5, 1.5, {to:?}] }} }}\nsigma_t = {extinction:?}\nalbedo = \
             {albedo:?}\ng = 0.0\n\n"
        );
    }
    let mirrors = [
        ("[0, 0, 0]", "[1, 0, 0]", "[0, 1, 0]"),
        ("[0, 0, 0]", "[0, 1, 0]", "[0, 0, 9]"),
        ("[1, 0, 0]", "[0, 1, 0]", "[0, 0, 9]"),
        ("[0, 0, 0]", "[1, 0, 0]", "[0, 0, 9]"),
        ("[0, 1, 0]", "[1, 0, 0]", "[0, 0, 9]"),
    ];
    for (corner, u, v) in mirrors {
        text += &format!(
            "[[objects]]\nshape = {{ rectangle = {{ corner = {corner}, u = {u}, v = {v} }} }}\nsurface = {{ mirror = {{ reflectance = 1.0 }} }}\n\n"
        );
    }
    for [from, to, _, _, source] in MEDIA.into_iter().filter(|medium| medium[4] > 0.0) {
        text += &format!(
            "[[lights]]\nvolume-source = {{ shape = {{ cuboid = {{ min = [0.0, 0.0, {from:?}], max = [1.0, 1.0, {to:?}] }} }}, density = {source:?} }}\n\n"
        );
    }
    text
}

fn row(e: &Entry, ours: (f64, Option<f64>)) -> anyhow::Result<Row> {
    let x = e.number("x_cell_middle")?;
    let (theirs, rounding) = e.rounded("scalar_flux")?;
    let noise = if x < 2.0 { 2e-5 } else { 1.2e-4 };
    Ok(Row::new("Reed", "fluence", x, (theirs, libm::hypot(rounding, noise * theirs)), ours))
}
