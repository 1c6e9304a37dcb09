//! van de Hulst's tables of homogeneous slabs.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use crate::benchmarks::slab_map::{Views, azimuths, means, sensor};
use std::f64::consts::PI;
use turbid_analytic::quadrature::GaussLegendre;
use turbid_analytic::{Ground, Incidence, Layer, Phase, Slab, SlabMedium, StratifiedSlab};

pub(super) const SET: Set = Set {
    name: "van-de-hulst",
    title: "Slabs of van de Hulst",
    source: "H. C. van de Hulst, Multiple Light Scattering, Academic Press 1980, tables 12 and 35 and pages 256 to 431",
    about: "Reflectance and total transmittance of homogeneous slabs under a beam, over its flux through the face; isotropic and \
            Henyey-Greenstein scattering. Of photon maps it is the flux of their radiances at six cosines; what balls of 0.25 mean free paths make of \
            the exact field, and lose beyond the faces, is predicted and divided out.",
    trust: "Five decimals as printed, taken as rounded.",
    explained: &[],
    open: false,
    plot: Plot::Rows,
    seconds: [12.0, 60.0],
    run,
};

fn run(bench: &Bench) -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "van_de_hulst_fluxes.csv",
        include_str!("../tables/van_de_hulst_fluxes.csv"),
        &["albedo", "tau", "g", "mu0", "quantity", "value"],
    )?;
    let entries: Vec<Entry> = table.entries().collect();
    let row = |i: usize, e: &Entry, ours| -> anyhow::Result<Row> {
        let [albedo, tau, g, mu0] = parameters(e)?;
        let case = format!("tau {tau}, albedo {albedo}, g {g}, mu0 {mu0}");
        Ok(Row::new(&case, e.text("quantity")?, i as f64, e.rounded("value")?, ours))
    };
    let referee = timed("exact", || {
        let answer = |(i, e): (usize, &Entry)| {
            let [albedo, tau, g, mu0] = parameters(e)?;
            let medium = SlabMedium::new(albedo, &Phase::henyey_greenstein(g)?)?;
            let slab = Slab::solve(tau, &medium, Incidence::Beam { mu0 })?;
            row(
                i,
                e,
                exact(if e.text("quantity")? == "R" { slab.reflectance() } else { slab.transmittance() }),
            )
        };
        entries.iter().enumerate().map(answer).collect()
    })?;
    let light = timed("light tracing", || {
        let answer = |(i, e): (usize, &Entry)| {
            let name = format!("van-de-hulst-{i}");
            let scene = bench.scene(&name, &scene(parameters(e)?, e.text("quantity")? == "R"))?;
            row(i, e, measured(&bench.light(&scene, bench.pick(20_000, 2_000_000))?[0]))
        };
        entries.iter().enumerate().map(answer).collect()
    })?;
    let map = timed("photon map", || {
        let answer = |(i, e): (usize, &Entry)| row(i, e, by_map(bench, &format!("van-de-hulst-map-{i}"), e)?);
        entries.iter().enumerate().map(answer).collect()
    })?;
    Ok(vec![referee, light, map])
}

/// Cosines of the light that leaves, of the rule of Gauss over all of them; azimuths where it is not symmetric: twice as many
/// change no mean of these slabs by 1e-4 of it (tested).
const COSINES: usize = 6;
const AZIMUTHS: usize = 12;

/// The flux of the radiances that photon maps find, over what their balls and the rule make of the exact field.
fn by_map(bench: &Bench, name: &str, e: &Entry) -> anyhow::Result<(f64, Option<f64>)> {
    let [albedo, tau, g, mu0] = parameters(e)?;
    let is_top = e.text("quantity")? == "R";
    let (t, sign) = if is_top { (0.0, -1.0) } else { (tau, 1.0) };
    let gauss = GaussLegendre::new(COSINES)?;
    let mut cosines = Vec::new();
    gauss.integrate(0.0, 1.0, |mu| {
        cosines.push(sign * mu);
        0.0
    });
    let flux = |of: &[f64]| {
        let mut of = of.iter();
        2.0 * PI * gauss.integrate(0.0, 1.0, |mu| mu * of.next().copied().unwrap_or(f64::NAN))
    };
    let turns = azimuths(if g == 0.0 || mu0 == 1.0 { 1 } else { AZIMUTHS });
    let mut sensors = String::new();
    let mut weights = Vec::new();
    for (i, &mu) in cosines.iter().enumerate() {
        let alone: Vec<f64> = (0..COSINES).map(|j| f64::from(u8::from(i == j))).collect();
        for &(azimuth, weight) in &turns {
            sensors += &sensor(t, mu, azimuth);
            // Per flux through the face.
            weights.push(weight * flux(&alone) / mu0);
        }
    }
    let scene = bench.scene(name, &(slab([albedo, tau, g, mu0]) + &sensors))?;
    let (value, error) = means(bench, &scene, bench.pick(500, 2_000), &[weights])?[0];
    let layer = Layer::new(tau, albedo, &Phase::henyey_greenstein(g)?)?;
    let exact = StratifiedSlab::new(&[layer], Ground::black(), Some(Incidence::Beam { mu0 }))?;
    let diffuse = if is_top { exact.reflectance() } else { exact.transmittance_diffuse() };
    let direct = if is_top { 0.0 } else { exact.transmittance_direct()?.value };
    let blur = flux(&Views::new(&exact, &cosines).blurred(t)?) / diffuse.value;
    Ok((direct + value / blur, error.map(|error| error / blur)))
}

fn parameters(e: &Entry) -> anyhow::Result<[f64; 4]> {
    Ok([e.number("albedo")?, e.number("tau")?, e.number("g")?, e.number("mu0")?])
}

/// The slab under the beam.
fn slab([albedo, tau, g, mu0]: [f64; 4]) -> String {
    let sine = libm::sqrt(1.0 - mu0 * mu0);
    format!(
        "cell = 1.0\n\n[[regions]]\nshape = {{ slab = {{ top = 0.0, thickness = {tau:?} }} }}\nsigma_t = 1.0\nalbedo = {albedo:?}\ng = {g:?}\n\n[[lights]]\n\
         beam = {{ dir = [{sine:?}, 0.0, {mu0:?}], irradiance = 1.0, section = \"unbounded\" }}\n"
    )
}

/// The same with the flux that leaves through a face.
fn scene(parameters: [f64; 4], is_top: bool) -> String {
    let (name, face) = if is_top { ("reflectance", "top") } else { ("transmittance", "bottom") };
    let tau = parameters[1];
    slab(parameters)
        + &format!(
            "\n[[sensors]]\nname = \"{name}\"\nmeasure = {{ outflow = {{ shape = {{ slab = {{ top = 0.0, thickness = {tau:?} }} }}, face = \"{face}\" }} }}\n"
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_azimuths_change_nothing() {
        let medium = SlabMedium::new(0.99, &Phase::henyey_greenstein(0.5).unwrap()).unwrap();
        let slab = Slab::solve(4.0, &medium, Incidence::Beam { mu0: 0.5 }).unwrap();
        for (t, mu) in [(0.0, 0.034), (0.0, 0.4), (0.0, 0.966), (4.0, -0.4), (4.0, -0.966)] {
            let mean = |count: usize| -> f64 {
                let of =
                    |(azimuth, weight): &(f64, f64)| weight * slab.radiance(t, mu, *azimuth).unwrap().value;
                azimuths(count).iter().map(of).sum()
            };
            let (few, more) = (mean(AZIMUTHS), mean(2 * AZIMUTHS));
            assert!((few - more).abs() < 1e-4 * more, "{t} {mu}: {few} {more}");
        }
    }
}
