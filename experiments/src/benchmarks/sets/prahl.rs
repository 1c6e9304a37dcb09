//! Slabs of Prahl's adding and doubling.

use crate::benchmarks::comparison::Row;
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{exact, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use anyhow::bail;
use turbid_analytic::{Incidence, Phase, Slab, SlabMedium};

pub(super) const SET: Set = Set {
    name: "prahl",
    title: "Adding and doubling of tissue optics",
    source: "S. A. Prahl, The adding-doubling method, in Optical-Thermal Response of Laser-Irradiated Tissue, Plenum 1995",
    about: "Reflectance and transmittance of a slab of optical thickness 1, albedo 0.5 and g = 0.9 without plates, under a beam straight down (UR1, UT1) \
            and under diffuse light (URU, UTU).",
    trust: "1e-5, as stated, for four or more quadrature points and the peak of the phase function cut off (delta-M).",
    explained: &[("exact", CUT_OFF), ("light tracing", CUT_OFF)],
    open: false,
    plot: Plot::Rows,
    seconds: [1.0, 20.0],
    run: |bench| {
        let table = Published::read(
            "prahl_adding_doubling.csv",
            include_str!("../tables/prahl_adding_doubling.csv"),
            &["albedo", "tau", "g", "n_slab", "glass_slides", "quantity", "value"],
        )?;
        let theirs = |e: &Entry| Ok::<_, anyhow::Error>((e.number("value")?, 1e-5));
        let case = "tau 1, albedo 0.5, g 0.9";
        let referee = timed("exact", || {
            let answer = |(i, e): (usize, Entry)| {
                if (e.number("n_slab")?, e.text("glass_slides")?) != (1.0, "none") {
                    bail!("prahl_adding_doubling.csv: a slab between plates is not asked here");
                }
                let medium =
                    SlabMedium::new(e.number("albedo")?, &Phase::henyey_greenstein(e.number("g")?)?)?;
                let quantity = e.text("quantity")?;
                let light =
                    if quantity.ends_with('1') { Incidence::Beam { mu0: 1.0 } } else { Incidence::Diffuse };
                let slab = Slab::solve(e.number("tau")?, &medium, light)?;
                let ours = if quantity.starts_with("UR") { slab.reflectance() } else { slab.transmittance() };
                Ok(Row::new(case, quantity, i as f64, theirs(&e)?, exact(ours)))
            };
            table.entries().enumerate().map(answer).collect()
        })?;
        let light = timed("light tracing", || {
            let answer = |(i, e): (usize, Entry)| {
                let quantity = e.text("quantity")?;
                let scene = bench.scene(&format!("prahl-{quantity}"), &scene(quantity))?;
                let ours = measured(&bench.light(&scene, bench.pick(50_000, 5_000_000))?[0]);
                Ok(Row::new(case, quantity, i as f64, theirs(&e)?, ours))
            };
            table.entries().enumerate().map(answer).collect()
        })?;
        Ok(vec![referee, light])
    },
};

const CUT_OFF: &str = "The table is the answer of four quadrature points and a phase function whose peak is cut off (delta-M), which reproduce its UR1 to all \
                       digits; the slab of g = 0.9 itself transmits 0.590719 by two exact methods, and light tracing meets that. The stated 1e-5 is how well \
                       programs of that method agree.";

fn scene(quantity: &str) -> String {
    const SLAB: &str = "{ slab = { top = 0.0, thickness = 1.0 } }";
    let light = if quantity.ends_with('1') {
        "beam = { dir = [0.0, 0.0, 1.0], irradiance = 1.0, section = \"unbounded\" }".to_string()
    } else {
        format!("isotropic = {{ shape = {SLAB}, faces = \"top\", radiance = 1.0 }}")
    };
    let face = if quantity.starts_with("UR") { "top" } else { "bottom" };
    format!(
        "cell = 1.0\n\n[[regions]]\nshape = {SLAB}\nsigma_t = 1.0\nalbedo = 0.5\ng = 0.9\n\n[[lights]]\n{light}\n\n[[sensors]]\nname = \
         \"{quantity}\"\nmeasure = {{ outflow = {{ shape = {SLAB}, face = \"{face}\" }} }}\n"
    )
}
