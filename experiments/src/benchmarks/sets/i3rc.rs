//! The step cloud of I3RC, the intercomparison of three-dimensional radiation codes.

use crate::benchmarks::comparison::Row;
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use std::f64::consts::PI;
use turbid::sensor::Measurement;

pub(super) const SET: Set = Set {
    name: "i3rc",
    title: "The step cloud of I3RC",
    source: "R. F. Cahalan and others, The I3RC: bringing together the most advanced radiative transfer tools for cloudy atmospheres, Bull. Am. \
             Meteorol. Soc. 86 (2005), case 1",
    about: "A cloud of 16 columns of optical depth 2 beside 16 of 18, each 1/64 km wide, 0.25 km thick, repeated without end; albedo 1, \
            Henyey-Greenstein g = 0.85, black ground. Experiment 1: sun in the zenith, 2: at 60 degrees from the side of the thin columns. Reflectance, \
            transmittance and pi I/(F mu0) of radiances upwards (Iu), downwards (Id) and 60 degrees from the zenith, back towards the sun (I602), by column. Photon maps are not asked: \
            beside the steps balls blur a field of which no exact value is known, and a blur cannot be predicted.",
    trust: "The mean of the codes that agreed: they differ by 0.2 to 1 per cent, without stated errors. 0.5 per cent is taken for fluxes, 1 \
            per cent for radiances.",
    explained: &[("light tracing", BESIDE), ("paths beside the steps", BESIDE)],
    open: false,
    plot: Plot::Curves { x: ("Column", ""), y: ("Over the incident flux", ""), is_log: false },
    seconds: [5.0, 200.0],
    run: |bench| {
        let table = Published::read(
            "i3rc_case1.csv",
            include_str!("../tables/i3rc_case1.csv"),
            &["experiment", "quantity", "column", "value"],
        )?;
        let entries: Vec<Entry> = table.entries().collect();
        let light = timed("light tracing", || rows(bench, &entries, "light"))?;
        let paths = timed("paths", || rows(bench, &entries, "paths"))?;
        let beside = timed("paths beside the steps", || beside(bench, &entries))?;
        Ok(vec![light, paths, beside])
    },
};

const BESIDE: &str = "It is the radiance straight up from the thin columns beside the steps, of which the published ones are 4 to 6 per cent above ours, by \
                      light tracing as by many more paths there. Fluxes and the other columns agree. How the published mean comes about there is not known \
                      here; of several codes it is known that they cut the peak of the phase function off for radiances.";

/// Cosine of the sun's zenith angle, by experiment.
const EXPERIMENTS: [(&str, f64); 2] = [("1", 1.0), ("2", 0.5)];

/// Columns.
const COLUMNS: usize = 32;

/// A quantity, and the cosine of its light with the way down.
const QUANTITIES: [(&str, f64); 5] = [("R", -1.0), ("T", 1.0), ("Iu", -1.0), ("Id", 1.0), ("I602", -0.5)];

/// Columns whose radiances straight up are measured once more, by 75 times as many paths: the thin ones beside the steps,
/// and one between.
const ONCE_MORE: [usize; 3] = [0, 8, 15];

fn beside(bench: &Bench, entries: &[Entry]) -> anyhow::Result<Vec<Row>> {
    let (experiment, mu0) = EXPERIMENTS[1];
    let width = 0.5 / COLUMNS as f64;
    let mut text = cloud(mu0);
    for column in ONCE_MORE {
        let corner = column as f64 * width;
        text += &format!(
            "\n[[sensors]]\nname = \"{column}\"\nmeasure = {{ mean-radiance = {{ corner = [{corner:?}, 0.0, 0.0], u = [{width:?}, 0.0, 0.0], v = [0.0, 1.0, 0.0], bins = \
             [1, 1], dir = [0.0, 0.0, 1.0] }} }}\nmin_order = 1\n"
        );
    }
    let found = bench.paths(&bench.scene("i3rc-beside", &text)?, bench.pick(20_000, 1_500_000))?;
    let mut rows = Vec::new();
    for (column, m) in ONCE_MORE.into_iter().zip(&found) {
        for e in entries {
            if (e.text("experiment")?, e.text("quantity")?, e.number("column")?)
                == (experiment, "Iu", column as f64)
            {
                rows.push(row(e, m)?);
            }
        }
    }
    Ok(rows)
}

/// A published value beside a measured one.
fn row(e: &Entry, m: &Measurement) -> anyhow::Result<Row> {
    let quantity = e.text("quantity")?;
    let (value, rounding) = e.rounded("value")?;
    let (spread, unit) = if is_flux(quantity) { (0.005, 1.0) } else { (0.01, PI) };
    let (mean, error) = measured(m);
    let ours = (unit * mean, error.map(|error| unit * error));
    let case = format!("experiment {}, {quantity}", e.text("experiment")?);
    Ok(Row::new(&case, quantity, e.number("column")?, (value, libm::hypot(rounding, spread * value)), ours))
}

fn is_flux(quantity: &str) -> bool {
    ["R", "T"].contains(&quantity)
}

fn rows(bench: &Bench, entries: &[Entry], by: &str) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (experiment, mu0) in EXPERIMENTS {
        let scene = bench.scene(&format!("i3rc-{experiment}"), &scene(mu0))?;
        let found = match by {
            "light" => bench.light(&scene, bench.pick(100_000, 10_000_000))?,
            _ => bench.paths(&scene, bench.pick(1_000, 20_000))?,
        };
        for e in entries {
            let (quantity, column) = (e.text("quantity")?, e.number("column")?);
            if e.text("experiment")? != experiment {
                continue;
            }
            let is_ours = |m: &&Measurement| {
                m.sensor == quantity && m.bin.is_some_and(|bin| bin.index[0] as f64 == column)
            };
            if let Some(m) = found.iter().find(is_ours) {
                rows.push(row(e, m)?);
            }
        }
    }
    Ok(rows)
}

/// The cloud under a sun whose flux through its top is 1.
fn cloud(mu0: f64) -> String {
    let sine = libm::sqrt(1.0 - mu0 * mu0);
    format!(
        "cell = [0.5, 1.0]\n\n[[regions]]\nshape = {{ slab = {{ top = 0.0, thickness = 0.25 }} }}\nsigma_t = 1.0\nalbedo = 1.0\ng = 0.85\n\
         density = {{ columns = {{ optical_depth = [2.0, 18.0], base = 0.0, top = 0.25, width = [0.25], ground = 0.25 }} }}\n\n[[lights]]\nbeam = {{ dir = \
         [{sine:?}, 0.0, {mu0:?}], irradiance = {:?}, section = \"unbounded\" }}\n",
        1.0 / mu0
    )
}

/// The same with all sensors.
fn scene(mu0: f64) -> String {
    let mut text = cloud(mu0);
    for (name, down) in QUANTITIES {
        let z = if down > 0.0 { 0.25 } else { 0.0 };
        let bins = format!(
            "corner = [0.0, 0.0, {z:?}], u = [0.5, 0.0, 0.0], v = [0.0, 1.0, 0.0], bins = [{COLUMNS}, 1]"
        );
        let (measure, order) = if is_flux(name) {
            (
                format!(
                    "flux = {{ {bins}, crossing = \"{}\" }}",
                    if down > 0.0 { "along" } else { "against" }
                ),
                0,
            )
        } else {
            // Against the light: that of I602 goes up and back towards the sun.
            let x = libm::sqrt(1.0 - down * down);
            (format!("mean-radiance = {{ {bins}, dir = [{x:?}, 0.0, {:?}] }}", -down), 1)
        };
        text +=
            &format!("\n[[sensors]]\nname = \"{name}\"\nmeasure = {{ {measure} }}\nmin_order = {order}\n");
    }
    text
}
