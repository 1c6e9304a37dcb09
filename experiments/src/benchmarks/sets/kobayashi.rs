//! The void problems of Kobayashi, Sugimura and Nagaya.

use crate::benchmarks::comparison::{AGAINST, Comparison, Row};
use crate::benchmarks::published::Published;
use crate::benchmarks::scene::{Bench, exact, measured, timed};
use crate::benchmarks::set::{Plot, Set};
use anyhow::Context;
use rayon::prelude::*;
use turbid::sensor::Measurement;
use turbid_analytic::NestedCuboids;
use turbid_analytic::quadrature::GaussLegendre;

const SOURCE: &str = "K. Kobayashi, N. Sugimura and Y. Nagaya, 3-D radiation transport benchmark problems and results for simple geometries with \
                      void regions, OECD/NEA 2000";

const PLOT: Plot =
    Plot::Curves { x: ("Coordinate along the line", "cm"), y: ("Flux", "1/(cm² s)"), is_log: true };

pub(super) const ONE: Set = Set {
    name: "kobayashi-1",
    title: "Kobayashi's problem 1: a shield around a void",
    source: SOURCE,
    about: "Flux at 30 points about a cube of 10 cm that sends out 1 per cm³ and second, in a void of 1e-4 per cm to 50 cm, in a shield of 0.1 \
            per cm to 100 cm, mirrored at the planes x = y = z = 0; absorbing (i), and half of it scattering isotropically (ii).",
    trust: "Case i: six digits of an analytic integral, taken as rounded. Case ii: a Monte Carlo code (GMVP) with the standard error that it states.",
    explained: &[],
    open: false,
    plot: PLOT,
    seconds: [10.0, 180.0],
    run: |bench| {
        let table = Published::read(
            "kobayashi.csv",
            include_str!("../tables/kobayashi.csv"),
            &["case", "set", "x_cm", "y_cm", "z_cm", "flux", "rel_std_error"],
        )?;
        run(bench, &ONE, &ONE_BODIES, &points(&table)?)
    },
};

pub(super) const TWO: Set = Set {
    name: "kobayashi-2",
    title: "Kobayashi's problem 2: a straight duct",
    source: SOURCE,
    about: "The same source at the end of a straight empty duct of 10 by 10 cm (20 by 20 with its mirror images) through a shield of 60 by 100 by 60 cm. \
            Flux along the duct (2A) and across its mouth (2B). A photon map counts collisions, of which the void has few: 400 of them (5 per cent) in a \
            ball of 2 cm at (5, 95, 5), where the uncollided flux is 0.032, take 400 x 8000/(0.032 x 1e-4 x 33.5), or 3e10 photons; paths take a million.",
    trust: "No numbers are here: `--theirs kobayashi-2=FILE` takes a CSV with the columns case (i or ii), set, x_cm, y_cm, z_cm, flux, \
            rel_std_error.",
    explained: &[],
    open: true,
    plot: PLOT,
    seconds: [10.0, 180.0],
    run: |bench| open(bench, &TWO, &TWO_BODIES, &two_points()),
};

pub(super) const THREE: Set = Set {
    name: "kobayashi-3",
    title: "Kobayashi's problem 3: a dog-leg duct",
    source: SOURCE,
    about: "The same source at the end of a duct of 10 by 10 cm with three right angles, through the shield of problem 2. Flux along its first leg \
            (3A), its second (3B) and where its last one leaves (3C). By the same count a photon map takes 3e13 photons for 5 per cent at (35, 95, 35), where \
            the uncollided flux is 3.4e-5; what a map finds here it finds beside the source.",
    trust: "No numbers are here: `--theirs kobayashi-3=FILE` takes a CSV with the columns of problem 2.",
    explained: &[],
    open: true,
    plot: PLOT,
    seconds: [10.0, 180.0],
    run: |bench| open(bench, &THREE, &THREE_BODIES, &three_points()),
};

/// A cuboid of the octant that is mirrored at the three planes, with its extinction \[1/cm\].
type Body = ([f64; 3], [f64; 3], f64);

const SHIELD: f64 = 0.1;
const VOID: f64 = 1e-4;
const CUBE: Body = ([0.0; 3], [10.0; 3], SHIELD);

const ONE_BODIES: [Body; 3] = [([0.0; 3], [100.0; 3], SHIELD), ([0.0; 3], [50.0; 3], VOID), CUBE];

const TWO_BODIES: [Body; 3] =
    [([0.0; 3], [60.0, 100.0, 60.0], SHIELD), ([0.0, 10.0, 0.0], [10.0, 100.0, 10.0], VOID), CUBE];

const THREE_BODIES: [Body; 6] = [
    ([0.0; 3], [60.0, 100.0, 60.0], SHIELD),
    ([0.0, 10.0, 0.0], [10.0, 60.0, 10.0], VOID),
    ([10.0, 50.0, 0.0], [40.0, 60.0, 10.0], VOID),
    ([30.0, 50.0, 10.0], [40.0, 60.0, 40.0], VOID),
    ([30.0, 60.0, 30.0], [40.0, 100.0, 40.0], VOID),
    CUBE,
];

/// A point of a problem, with the published flux and its relative standard error where there are some.
struct Point {
    case: &'static str,
    line: String,
    at: [f64; 3],
    flux: Option<(f64, f64)>,
}

impl Point {
    fn abscissa(&self) -> f64 {
        // Lines A lead along y, all others along x.
        self.at[usize::from(self.line.ends_with('A'))]
    }
}

const CASES: [(&str, f64); 2] = [("i", 0.0), ("ii", 0.5)];

fn points(table: &Published) -> anyhow::Result<Vec<Point>> {
    let point = |e: crate::benchmarks::published::Entry| {
        let case = e.text("case")?.split(' ').next();
        let case = CASES.iter().find(|(known, _)| Some(*known) == case);
        let case = case.with_context(|| e.refused("case", "i or ii"))?.0;
        let (flux, rounding) = e.rounded("flux")?;
        let error = libm::hypot(rounding, flux * e.not_negative("rel_std_error")?);
        let at = [e.number("x_cm")?, e.number("y_cm")?, e.number("z_cm")?];
        Ok(Point { case, line: e.text("set")?.to_string(), at, flux: Some((flux, error)) })
    };
    table.entries().map(point).collect()
}

fn line(line: &str, at: impl Fn(f64) -> [f64; 3], last: u32) -> Vec<Point> {
    let point = |(case, i): (&'static str, u32)| Point {
        case,
        line: line.to_string(),
        at: at(5.0 + 10.0 * f64::from(i)),
        flux: None,
    };
    CASES.iter().flat_map(|&(case, _)| (0..last).map(move |i| (case, i))).map(point).collect()
}

fn two_points() -> Vec<Point> {
    [line("2A", |y| [5.0, y, 5.0], 10), line("2B", |x| [x, 95.0, 5.0], 6)].into_iter().flatten().collect()
}

fn three_points() -> Vec<Point> {
    let lines = [
        line("3A", |y| [5.0, y, 5.0], 10),
        line("3B", |x| [x, 55.0, 5.0], 6),
        line("3C", |x| [x, 95.0, 35.0], 6),
    ];
    lines.into_iter().flatten().collect()
}

/// Numbers of the user's, or none.
fn open(bench: &Bench, set: &Set, bodies: &[Body], own: &[Point]) -> anyhow::Result<Vec<Comparison>> {
    let Some((name, text)) = bench.theirs()? else { return run(bench, set, bodies, own) };
    let needed = ["case", "set", "x_cm", "y_cm", "z_cm", "flux", "rel_std_error"];
    run(bench, set, bodies, &points(&Published::read(&name, &text, &needed)?)?)
}

/// The image of a cuboid in the planes of symmetry: one body where it touches a plane, two where it does not.
fn mirrored(&(min, max, extinction): &Body) -> Vec<Body> {
    let mut images = vec![(min, max, extinction)];
    for axis in 0..3 {
        let mut more = Vec::new();
        for body in &mut images {
            if min[axis] == 0.0 {
                body.0[axis] = -max[axis];
            } else {
                let mut image = *body;
                (image.0[axis], image.1[axis]) = (-max[axis], -min[axis]);
                more.push(image);
            }
        }
        images.extend(more);
    }
    images
}

fn scene(bodies: &[Body], albedo: f64) -> String {
    let cuboid = |(min, max, _): &Body| format!("{{ cuboid = {{ min = {min:?}, max = {max:?} }} }}");
    let mut text = String::new();
    for body in bodies.iter().flat_map(mirrored) {
        let (shape, extinction) = (cuboid(&body), body.2);
        text += &format!(
            "[[regions]]\nshape = {shape}\nsigma_t = {extinction:?}\nalbedo = {albedo:?}\ng = 0.0\n\n"
        );
    }
    let source = cuboid(&mirrored(&CUBE)[0]);
    text + &format!("[[lights]]\nvolume-source = {{ shape = {source}, density = 1.0 }}\n")
}

fn sensor([x, y, z]: [f64; 3]) -> String {
    format!(
        "\n[[sensors]]\nname = \"{x} {y} {z}\"\nmeasure = {{ fluence = {{ at = [{x:?}, {y:?}, {z:?}] }} }}\n"
    )
}

/// Radius of the balls in which photons are counted \[cm\].
const RADIUS: f64 = 2.0;

/// The mean of the uncollided field over a ball, over its value in the middle: two radii of Gauss times the 14 directions that are exact to the fifth
/// degree.
fn blurred(referee: &NestedCuboids, at: [f64; 3]) -> anyhow::Result<f64> {
    let gauss = GaussLegendre::new(2)?;
    let mut directions = Vec::new();
    for i in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut dir = [0.0; 3];
            dir[i] = sign;
            directions.push((dir, 1.0 / 15.0));
        }
    }
    let corner = libm::sqrt(1.0 / 3.0);
    for i in 0..8 {
        directions.push(([1, 2, 4].map(|bit| if i & bit == 0 { corner } else { -corner }), 3.0 / 40.0));
    }
    let mut mean = 0.0;
    for (dir, weight) in directions {
        let value = |share: f64| {
            let place: Vec<f64> = (0..3).map(|i| at[i] + RADIUS * share * dir[i]).collect();
            referee.fluence([place[0], place[1], place[2]]).map_or(f64::NAN, |v| v.value)
        };
        mean += weight * gauss.integrate(0.0, 1.0, |share| 3.0 * share * share * value(share));
    }
    Ok(mean / referee.fluence(at)?.value)
}

fn extents(&(min, max, _): &Body) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|i| [min[i], max[i]])
}

fn run(bench: &Bench, set: &Set, bodies: &[Body], points: &[Point]) -> anyhow::Result<Vec<Comparison>> {
    let cuboids: Vec<([[f64; 2]; 3], f64)> = bodies.iter().map(|body| (extents(body), body.2)).collect();
    let referee = NestedCuboids::new(&cuboids, extents(&CUBE), [true; 3])?;
    let row = |p: &Point, theirs: Option<(f64, f64)>, ours| {
        let case = format!("{}, {}", p.case, p.line);
        match theirs {
            Some(theirs) => Row::new(&case, "flux", p.abscissa(), theirs, ours),
            None => Row::alone(&case, "flux", p.abscissa(), ours),
        }
    };
    let mut comparisons = Vec::new();
    for (case, albedo) in CASES {
        let asked: Vec<&Point> = points.iter().filter(|p| p.case == case).collect();
        if asked.is_empty() {
            continue;
        }
        // Where nobody else has numbers, ours are held against each other: those of the referee, or else of paths.
        let mut others: Vec<Option<(f64, f64)>> = asked.iter().map(|p| p.flux).collect();
        let is_ours = others.iter().all(Option::is_none);
        let against = |what: &str| if is_ours { format!("{AGAINST}{what}") } else { String::new() };
        if case == "i" {
            let answers = timed("exact, case i", || {
                asked
                    .iter()
                    .zip(&others)
                    .map(|(p, &theirs)| Ok(row(p, theirs, exact(referee.fluence(p.at)?))))
                    .collect()
            })?;
            if is_ours {
                others = answers.rows.iter().map(|row| Some((row.ours, row.our_error?))).collect();
            }
            comparisons.push(answers);
        }
        let sensors: String = asked.iter().map(|p| sensor(p.at)).collect();
        let scene = bench.scene(&format!("{}-{case}", set.name), &(scene(bodies, albedo) + &sensors))?;
        let paths = timed(
            &format!("paths, case {case}{}", if case == "i" { against("exact") } else { String::new() }),
            || {
                // Deep in a shield few paths find the source by themselves where light is scattered.
                let found = match case {
                    "i" => bench.paths(&scene, bench.pick(10_000, 1_000_000))?,
                    _ => bench.windowed_paths(&scene, bench.pick(2_000, 500_000))?,
                };
                Ok(asked
                    .iter()
                    .zip(&found)
                    .zip(&others)
                    .map(|((p, m), &theirs)| row(p, theirs, measured(m)))
                    .collect())
            },
        )?;
        if is_ours && case == "ii" {
            others = paths.rows.iter().map(|row| Some((row.ours, row.our_error?))).collect();
        }
        comparisons.push(paths);
        let reference = against(if case == "i" { "exact" } else { "paths" });
        comparisons.push(timed(&format!("photon map, case {case}{reference}"), || {
            let found = bench.maps(&scene, bench.pick(5_000, 250_000), RADIUS)?;
            let answer = |((p, m), &theirs): ((&&Point, &Measurement), &Option<(f64, f64)>)| {
                let (mean, error) = measured(m);
                // What the ball makes of the field: known where nothing scatters, and taken for an error as large where light is scattered,
                // which is smoother there.
                // It takes long, and nobody asks where the map found too little.
                let blur = if error.is_some() { blurred(&referee, p.at)? } else { 1.0 };
                let ours = match case {
                    "i" => (mean / blur, error.map(|error| error / blur)),
                    _ => (mean, error.map(|error| libm::hypot(error, mean * (blur - 1.0)))),
                };
                Ok(row(p, theirs, ours))
            };
            asked.par_iter().zip(&found).zip(&others).map(answer).collect()
        })?);
    }
    Ok(comparisons)
}
