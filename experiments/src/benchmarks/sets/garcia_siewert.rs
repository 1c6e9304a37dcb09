//! Garcia and Siewert: Mie and haze slabs, and the slab whose albedo falls with depth.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, timed};
use crate::benchmarks::set::{Plot, Set};
use crate::benchmarks::slab_map::{Views, azimuths, means, sensor};
use anyhow::Context;
use std::f64::consts::PI;
use turbid::sensor::Measurement;
use turbid_analytic::{Ground, Incidence, Layer, Phase, StratifiedSlab};

const RADIANCE: Plot =
    Plot::Curves { x: ("Cosine, positive downwards", ""), y: ("Radiance", "1/sr"), is_log: true };

pub(super) const MIE: Set = Set {
    name: "mie",
    title: "Mie scattering of eight terms",
    source: "R. D. M. Garcia and C. E. Siewert, Benchmark results in radiative transfer, Transp. Theory Stat. Phys. 14 (1985)",
    about: "Mean over azimuth of the diffuse radiance in a slab of optical thickness 1 and albedo 0.95, under a beam of irradiance pi on a \
            plane across it, from the cosine 0.5; the phase function has Legendre terms to l = 8. Paths and photon maps answer at three depths and eight cosines. \
            Photons are counted in balls of 0.25 mean free paths; what these make of the exact field, and lose beyond the faces, is predicted and divided out.",
    trust: "Six digits as printed, taken as rounded; another code met them to 3e-5.",
    explained: &[],
    open: false,
    plot: RADIANCE,
    seconds: [8.0, 90.0],
    run: |bench| {
        azimuthal(bench, &MIE, "Mie L=8", Case { albedo: 0.95, mu0: 0.5, beta: MIE_BETA, azimuths: 18 })
    },
};

pub(super) const HAZE: Set = Set {
    name: "haze-l",
    title: "Haze L",
    source: "R. D. M. Garcia and C. E. Siewert, Benchmark results in radiative transfer, Transp. Theory Stat. Phys. 14 (1985)",
    about: "Diffuse radiance in a slab of haze L (82 Legendre terms), optical thickness 1, albedo 0.9, under a beam of irradiance pi straight \
            down. Paths and photon maps answer as in the Mie slab.",
    trust: "Six digits as printed, taken as rounded; another code met them to 3e-5, except near the aureole.",
    explained: &[],
    open: false,
    plot: RADIANCE,
    seconds: [10.0, 90.0],
    run: |bench| {
        azimuthal(bench, &HAZE, "haze L", Case { albedo: 0.9, mu0: 1.0, beta: HAZE_BETA, azimuths: 1 })
    },
};

pub(super) const LAYERS: Set = Set {
    name: "garcia-siewert-1982",
    title: "Isotropic scattering, lit from all sides",
    source: "R. D. M. Garcia and C. E. Siewert, Radiative transfer in inhomogeneous atmospheres, JQSRT 27 (1982)",
    about: "Radiance that leaves a conservative slab of optical thickness 5 (albedo e^(-t/s) of infinite s), on the lit face and on the \
            other, light included that was not scattered; radiance 1 comes from all directions.",
    trust: "Six digits as printed, taken as rounded.",
    explained: &[],
    open: false,
    plot: Plot::Curves { x: ("Cosine", ""), y: ("Radiance", "1/sr"), is_log: false },
    seconds: [1.0, 1.0],
    run: |_| conservative(),
};

const MIE_BETA: &str = include_str!("../tables/mie_L8_legendre.csv");
const HAZE_BETA: &str = include_str!("../tables/haze_L_legendre.csv");

struct Case {
    albedo: f64,
    mu0: f64,
    beta: &'static str,
    /// Azimuths whose mean is that over all: more than twice the degree of the phase function, since the radiance is a sum of
    /// as many cosines of the azimuth, or 1 where the light is symmetric.
    azimuths: usize,
}

/// Moments chi_l of a phase function sum (2l+1) chi_l P_l, published as beta_l = (2l+1) chi_l.
pub(super) fn moments(text: &str) -> anyhow::Result<Vec<f64>> {
    let table = Published::read("Legendre terms", text, &["l", "beta_l"])?;
    table.entries().map(|e| Ok(e.number("beta_l")? / (2.0 * e.number("l")? + 1.0))).collect()
}

fn azimuthal(bench: &Bench, set: &Set, phase: &str, case: Case) -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "garcia_siewert_1985.csv",
        include_str!("../tables/garcia_siewert_1985.csv"),
        &["phase", "tau", "mu_downward_positive", "value"],
    )?;
    let mut entries = Vec::new();
    for e in table.entries() {
        // No light comes in through the faces: of that the table has zeros.
        if e.text("phase")? == phase && e.number("value")? != 0.0 {
            entries.push(e);
        }
    }
    let moments = moments(case.beta)?;
    let row = |e: &Entry, ours| -> anyhow::Result<Row> {
        let at = e.number("mu_downward_positive")?;
        Ok(Row::new(&format!("depth {}", e.number("tau")?), "radiance", at, e.rounded("value")?, ours))
    };
    let solve = || -> anyhow::Result<StratifiedSlab> {
        let layer = Layer::new(1.0, case.albedo, &Phase::legendre(moments.clone())?)?;
        Ok(StratifiedSlab::new(&[layer], Ground::black(), Some(Incidence::Beam { mu0: case.mu0 }))?)
    };
    let referee = timed("exact", || {
        let slab = solve()?;
        let mut rows = Vec::new();
        for group in entries.chunk_by(|a, b| a.text("tau").ok() == b.text("tau").ok()) {
            let t = group[0].number("tau")?;
            for e in group {
                // Per irradiance on the face, of a beam that has pi on a plane across it.
                let (value, error) = radiance(&slab, t, -e.number("mu_downward_positive")?)?;
                let unit = PI * case.mu0;
                rows.push(row(e, (value * unit, Some(error * unit)))?);
            }
        }
        Ok(rows)
    })?;
    let turns = azimuths(case.azimuths);
    let (mut asked, mut sensors) = (Vec::new(), String::new());
    for e in &entries {
        let (t, mu) = (e.number("tau")?, e.number("mu_downward_positive")?);
        if DEPTHS.contains(&t) && COSINES.contains(&libm::fabs(mu)) {
            asked.push((e, t, mu));
            sensors.extend(turns.iter().map(|(azimuth, _)| sensor(t, mu, *azimuth)));
        }
    }
    let name = format!("{}.txt", set.name);
    bench.file(&name, &phase_table(&Phase::legendre(moments.clone())?))?;
    let scene = bench.scene(set.name, &(scene(&case, &name) + &sensors))?;
    let paths = timed("paths", || {
        let found = bench.paths(&scene, bench.pick(2_000, 25_000) * if turns.len() == 1 { 10 } else { 1 })?;
        let answer = |((e, _, _), found): (&(&Entry, f64, f64), &[Measurement])| {
            let weighted = || found.iter().zip(&turns).map(|(m, (_, weight))| (m, weight));
            let mean = weighted().map(|(m, weight)| weight * m.mean).fold(0.0, |a, b| a + b);
            let square = weighted()
                .map(|(m, weight)| Some(weight * m.std_error?))
                .try_fold(0.0, |a, b| Some(a + b? * b?));
            row(e, (mean, square.map(libm::sqrt)))
        };
        asked.iter().zip(found.chunks(turns.len())).map(answer).collect()
    })?;
    let map = timed("photon map", || {
        let weights: Vec<f64> = turns.iter().map(|(_, weight)| *weight).collect();
        let photons = bench.pick(500, 2_000) * if turns.len() == 1 { 2 } else { 1 };
        let found = means(bench, &scene, photons, &vec![weights; asked.len()])?;
        let slab = solve()?;
        let cosines = COSINES.map(|mu| [mu, -mu]).concat();
        let views = Views::new(&slab, &cosines);
        let mut blurred = Vec::new();
        for t in DEPTHS {
            blurred.push((t, views.blurred(t)?, views.exact(t)?));
        }
        let mut rows = Vec::new();
        for (&(e, t, mu), (value, error)) in asked.iter().zip(found) {
            let (_, blurred, exact) = blurred.iter().find(|known| known.0 == t).context("a depth")?;
            let i = cosines.iter().position(|&cosine| cosine == mu).context("a cosine")?;
            let blur = blurred[i] / exact[i];
            rows.push(row(e, (value / blur, error.map(|error| error / blur)))?);
        }
        Ok(rows)
    })?;
    Ok(vec![referee, paths, map])
}

/// Nearest to the horizontal that layers answer.
const GRAZING: f64 = 1e-5;

/// The radiance and its error; in the horizontal the mean of both sides of it, or on a face the limit of that which leaves.
fn radiance(slab: &StratifiedSlab, t: f64, mu: f64) -> anyhow::Result<(f64, f64)> {
    if mu != 0.0 {
        let value = slab.radiance(t, &[mu])?[0];
        return Ok((value.value, value.error));
    }
    let sides = slab.radiance(t, &[GRAZING, -GRAZING])?;
    let (up, down) = (sides[0].value, sides[1].value);
    let error = sides[0].error.max(sides[1].error);
    if t > 0.0 && t < slab.tau() {
        return Ok((0.5 * (up + down), error + libm::fabs(up - down)));
    }
    // On a face it grows as mu ln mu, since the source function has the slope of a logarithm there.
    let side = |mu: f64| -> anyhow::Result<f64> {
        Ok(slab.radiance(t, &[if t == 0.0 { mu } else { -mu }])?[0].value)
    };
    let (near, far) = (side(GRAZING)?, side(4.0 * GRAZING)?);
    let slope = |mu: f64| mu * libm::log(mu);
    let b = (far - near) / (slope(4.0 * GRAZING) - slope(GRAZING));
    let value = near - b * slope(GRAZING);
    Ok((value, error + 0.2 * libm::fabs(value - near)))
}

/// Depths at which paths and photon maps answer.
const DEPTHS: [f64; 3] = [0.0, 0.5, 1.0];

/// Cosines at which they answer, downwards and upwards.
const COSINES: [f64; 4] = [0.2, 0.5, 0.8, 1.0];

/// A phase function at 4,000 angles, for the simulator: densest forwards.
fn phase_table(phase: &Phase) -> String {
    let angle = |i: u32| 180.0 * libm::pow(f64::from(i) / 4000.0, 1.5);
    (0..=4000)
        .map(|i| format!("{:?} {:?}\n", angle(i), phase.value(libm::cos(angle(i).to_radians()))))
        .collect()
}

fn scene(case: &Case, phase: &str) -> String {
    let (mu0, albedo) = (case.mu0, case.albedo);
    let sine = libm::sqrt(1.0 - mu0 * mu0);
    format!(
        "cell = 1.0\n\n[[regions]]\nshape = {{ slab = {{ top = 0.0, thickness = 1.0 }} }}\nsigma_t = 1.0\nalbedo = {albedo:?}\n\
         phase = {{ table = {{ file = \"{phase}\" }} }}\n\n[[lights]]\nbeam = {{ dir = [{sine:?}, 0.0, {mu0:?}], irradiance = {PI:?}, section = \
         \"unbounded\" }}\n"
    )
}

fn conservative() -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "garcia_siewert_1982_exponential.csv",
        include_str!("../tables/garcia_siewert_1982_exponential.csv"),
        &["face", "mu", "outgoing_radiance"],
    )?;
    let referee = timed("exact", || {
        let layer = Layer::new(5.0, 1.0, &Phase::isotropic())?;
        let slab = StratifiedSlab::new(&[layer], Ground::black(), Some(Incidence::Diffuse))?;
        let answer = |e: Entry| {
            let (face, mu) = (e.text("face")?, e.number("mu")?);
            let (t, sign, direct) =
                if face == "tau=0" { (0.0, 1.0, 0.0) } else { (5.0, -1.0, libm::exp(-5.0 / mu)) };
            let (value, error) = exact(slab.radiance(t, &[sign * mu])?[0]);
            let ours = (PI * value + direct, error.map(|error| PI * error));
            Ok(Row::new(face, "radiance", mu, e.rounded("outgoing_radiance")?, ours))
        };
        table.entries().map(answer).collect()
    })?;
    Ok(vec![referee])
}
