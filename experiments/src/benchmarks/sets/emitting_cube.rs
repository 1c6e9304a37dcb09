//! The emitting, absorbing unit cube of Burns and Christon.

use crate::benchmarks::comparison::Row;
use crate::benchmarks::published::{Entry, Published};
use crate::benchmarks::scene::{Bench, exact, timed};
use crate::benchmarks::set::{Plot, Set};
use std::f64::consts::FRAC_1_PI;
use turbid::sensor::Measurement;
use turbid_analytic::EmittingCube;

pub(super) const SET: Set = Set {
    name: "emitting-cube",
    title: "The emitting cube of Burns and Christon",
    source: "S. P. Burns and M. A. Christon, Spatial domain-based parallelism in large-scale, participating-media, radiative transport applications, Numer. \
             Heat Transfer B 31 (1997)",
    about: "Divergence of the flux, kappa (4 - fluence), along the middle of a unit cube that absorbs 0.9 (1-2|x-1/2|)(1-2|y-1/2|)(1-2|z-1/2|) + 0.1, \
            emits with sigma T^4 = 1 and has cold black walls.",
    trust: "No numbers are here: `--theirs emitting-cube=FILE` takes a CSV with the columns x, divergence, std_error, at y = z = 1/2.",
    explained: &[],
    open: true,
    plot: Plot::Curves { x: ("x", ""), y: ("Divergence of the flux", "σT⁴"), is_log: false },
    seconds: [1.0, 20.0],
    run: |bench| {
        let points = points(bench)?;
        let absorption = |x: f64| EmittingCube::BURNS_CHRISTON.absorption([x, 0.5, 0.5]);
        let row = |x: f64, theirs: Option<(f64, f64)>, ours| match theirs {
            Some(theirs) => Row::new("y = z = 1/2", "divergence", x, theirs, ours),
            None => Row::alone("y = z = 1/2", "divergence", x, ours),
        };
        let is_ours = points.iter().all(|p| p.1.is_none());
        let referee = timed("exact", || {
            let answer = |p: &Point| {
                Ok(row(p.0, p.1, exact(EmittingCube::BURNS_CHRISTON.divergence([p.0, 0.5, 0.5])?)))
            };
            points.iter().map(answer).collect()
        })?;
        let paths = timed(if is_ours { "paths against exact" } else { "paths" }, || {
            let scene = bench.scene("emitting-cube", &scene(&points))?;
            let found = bench.paths(&scene, bench.pick(10_000, 1_000_000))?;
            let answer = |((p, m), exact): ((&Point, &Measurement), &Row)| {
                let kappa = absorption(p.0);
                let theirs = p.1.or(Some((exact.ours, exact.our_error?)));
                Some(row(p.0, theirs, (kappa * (4.0 - m.mean), m.std_error.map(|error| kappa * error))))
            };
            Ok(points.iter().zip(&found).zip(&referee.rows).filter_map(answer).collect())
        })?;
        Ok(vec![referee, paths])
    },
};

/// An abscissa, and the value of another code with its error.
type Point = (f64, Option<(f64, f64)>);

/// Abscissae, with values of another code where the user has some.
fn points(bench: &Bench) -> anyhow::Result<Vec<Point>> {
    let Some((name, text)) = bench.theirs()? else {
        return Ok((0..=20).map(|i| (f64::from(i) / 20.0, None)).collect());
    };
    let table = Published::read(&name, &text, &["x", "divergence", "std_error"])?;
    let point = |e: Entry| {
        let (value, rounding) = e.rounded("divergence")?;
        Ok((e.number("x")?, Some((value, libm::hypot(rounding, e.not_negative("std_error")?)))))
    };
    table.entries().map(point).collect()
}

/// Products of tents are trilinear between the walls, where the density is 0.1, and the middle.
fn scene(points: &[Point]) -> String {
    let values: Vec<&str> = (0..27).map(|i| if i == 13 { "1.0" } else { "0.1" }).collect();
    let mut text = format!(
        "[[regions]]\nshape = {{ cuboid = {{ min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] }} }}\nsigma_t = 1.0\nalbedo = 0.0\ng = 0.0\nemission_by_density = \
         {FRAC_1_PI:?}\ndensity = {{ grid = {{ values = [{}], count = [3, 3, 3], min = [-0.25, -0.25, -0.25], max = [1.25, 1.25, 1.25] }} }}\n",
        values.join(", ")
    );
    for (x, _) in points {
        text += &format!(
            "\n[[sensors]]\nname = \"{x}\"\nmeasure = {{ fluence = {{ at = [{x:?}, 0.5, 0.5] }} }}\n"
        );
    }
    text
}
