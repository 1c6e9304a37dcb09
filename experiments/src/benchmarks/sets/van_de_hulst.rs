//! van de Hulst's tables of homogeneous slabs.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use turbid_analytic::{Incidence, Phase, Slab, SlabMedium};

pub(super) const SET: Set = Set {
    name: "van-de-hulst",
    title: "Slabs of van de Hulst",
    source: "H. C. van de Hulst, Multiple Light Scattering, Academic Press 1980, tables 12 and 35 and pages 256 to 431",
    about: "Reflectance and total transmittance of homogeneous slabs under a beam, over its flux through the face; isotropic and \
            Henyey-Greenstein scattering.",
    trust: "Five decimals as printed, taken as rounded.",
    explained: &[],
    open: false,
    plot: Plot::Rows,
    seconds: [2.0, 60.0],
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
    Ok(vec![referee, light])
}

fn parameters(e: &Entry) -> anyhow::Result<[f64; 4]> {
    Ok([e.number("albedo")?, e.number("tau")?, e.number("g")?, e.number("mu0")?])
}

fn scene([albedo, tau, g, mu0]: [f64; 4], is_top: bool) -> String {
    let sine = libm::sqrt(1.0 - mu0 * mu0);
    let slab = format!("{{ slab = {{ top = 0.0, thickness = {tau:?} }} }}");
    let (name, face) = if is_top { ("reflectance", "top") } else { ("transmittance", "bottom") };
    format!(
        "cell = 1.0\n\n[[regions]]\nshape = {slab}\nsigma_t = 1.0\nalbedo = {albedo:?}\ng = {g:?}\n\n[[lights]]\n\
         beam = {{ dir = [{sine:?}, 0.0, {mu0:?}], irradiance = 1.0, section = \"unbounded\" }}\n\n[[sensors]]\n\
         name = \"{name}\"\nmeasure = {{ outflow = {{ shape = {slab}, face = \"{face}\" }} }}\n"
    )
}
