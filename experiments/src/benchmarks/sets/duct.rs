//! The square duct of Crosbie and Schrenker.

use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, timed};
use crate::benchmarks::set::{Plot, Set};
use std::f64::consts::PI;
use turbid_analytic::{Cuboid, CuboidSource};

pub(super) const SET: Set = Set {
    name: "duct",
    title: "A square duct lit from one side",
    source: "A. L. Crosbie and R. G. Schrenker, Radiative transfer in a two-dimensional rectangular medium exposed to diffuse radiation, JQSRT 31 \
             (1984)",
    about: "Source function on the centre line of an endless square duct, one mean free path wide, whose medium scatters isotropically and absorbs \
            nothing; radiance 1 comes in through one of its sides. It is the fluence over 4 pi.",
    trust: "Four decimals as printed, taken as rounded.",
    explained: &[(
        "exact",
        "Their last digit is off by one or two near the walls: 0.6293 on the lit one is 0.62951. In the middle symmetry demands 1/4, and both have it.",
    )],
    open: false,
    plot: Plot::Curves {
        x: ("Distance from the lit side", "mean free paths"),
        y: ("Source function", ""),
        is_log: false,
    },
    seconds: [5.0, 60.0],
    run,
};

/// Half the length that stands for an endless one: light that scattered there comes back less than e^-2 a mean free path.
const HALF: f64 = 15.0;

fn run(bench: &Bench) -> anyhow::Result<Vec<Comparison>> {
    let table = Published::read(
        "crosbie_schrenker.csv",
        include_str!("../tables/crosbie_schrenker.csv"),
        &["tau_from_lit_wall", "source_function"],
    )?;
    let entries: Vec<Entry> = table.entries().collect();
    let row = |e: &Entry, ours| -> anyhow::Result<Row> {
        Ok(Row::new(
            "centre line",
            "source function",
            e.number("tau_from_lit_wall")?,
            e.rounded("source_function")?,
            ours,
        ))
    };
    let paths = timed("paths", || {
        let mut text = format!(
            "[[regions]]\nshape = {{ cuboid = {{ min = [0.0, -{HALF:?}, 0.0], max = [1.0, {HALF:?}, 1.0] }} }}\nsigma_t = 1.0\nalbedo = 1.0\n\
             g = 0.0\n\n[[lights]]\narea = {{ shape = {{ rectangle = {{ corner = [-1e-9, -{HALF:?}, 0.0], u = [0.0, {:?}, 0.0], v = [0.0, 0.0, 1.0] }} }}, \
             radiance = 1.0 }}\n",
            2.0 * HALF
        );
        for e in &entries {
            let x = e.number("tau_from_lit_wall")?;
            text += &format!(
                "\n[[sensors]]\nname = \"{x}\"\nmeasure = {{ fluence = {{ at = [{x:?}, 0.0, 0.5] }} }}\n"
            );
        }
        let scene = bench.scene("duct", &text)?;
        let found = bench.paths(&scene, bench.pick(10_000, 1_000_000))?;
        let unit = 0.25 / PI;
        entries
            .iter()
            .zip(&found)
            .map(|(e, m)| row(e, (m.mean * unit, m.std_error.map(|s| s * unit))))
            .collect()
    })?;
    let exact = timed("exact", || {
        let duct = Cuboid::duct([1.0, 1.0], 1.0, CuboidSource::Face)?;
        let answer = |e: &Entry| {
            let (value, error) = exact(duct.source_function([e.number("tau_from_lit_wall")?, 0.5, 0.0])?);
            // Per irradiance, of which radiance 1 brings pi.
            row(e, (PI * value, error.map(|error| PI * error)))
        };
        entries.iter().map(answer).collect()
    })?;
    Ok(vec![exact, paths])
}
