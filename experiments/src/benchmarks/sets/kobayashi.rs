//! The void problems of Kobayashi, Sugimura and Nagaya.

use super::{Plot, Set};
use crate::benchmarks::comparison::{Comparison, Row};
use crate::benchmarks::published::Published;
use crate::benchmarks::scene::{Bench, measured, timed};

const SOURCE: &str = "K. Kobayashi, N. Sugimura and Y. Nagaya, 3-D radiation transport benchmark problems and results for simple geometries with \
                      void regions, OECD/NEA 2000";

const PLOT: Plot = Plot::Curves { x: ("Largest coordinate", "cm"), y: ("Flux", "1/(cm² s)"), is_log: true };

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
            Flux along the duct (2A) and across its mouth (2B).",
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
            (3A), its second (3B) and where its last one leaves (3C).",
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
        self.at.into_iter().fold(0.0, f64::max)
    }
}

const CASES: [(&str, f64); 2] = [("i", 0.0), ("ii", 0.5)];

fn points(table: &Published) -> anyhow::Result<Vec<Point>> {
    let point = |e: crate::benchmarks::published::Entry| {
        let case = if e.text("case")?.split(' ').next() == Some("ii") { "ii" } else { "i" };
        let (flux, rounding) = e.rounded("flux")?;
        let error = libm::hypot(rounding, flux * e.number("rel_std_error")?);
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
    let Some((name, text)) = bench.theirs(set.name)? else { return run(bench, set, bodies, own) };
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

fn run(bench: &Bench, set: &Set, bodies: &[Body], points: &[Point]) -> anyhow::Result<Vec<Comparison>> {
    let row = |p: &Point, ours| {
        let case = format!("{}, {}", p.case, p.line);
        match p.flux {
            Some(flux) => Row::new(&case, "flux", p.abscissa(), flux, ours),
            None => Row::alone(&case, "flux", p.abscissa(), ours),
        }
    };
    let mut comparisons = Vec::new();
    for (case, albedo) in CASES {
        let asked: Vec<&Point> = points.iter().filter(|p| p.case == case).collect();
        if asked.is_empty() {
            continue;
        }
        comparisons.push(timed(&format!("paths, case {case}"), || {
            let sensors: String = asked.iter().map(|p| sensor(p.at)).collect();
            let scene = bench.scene(&format!("{}-{case}", set.name), &(scene(bodies, albedo) + &sensors))?;
            let found = bench.paths(&scene, bench.pick(10_000, 1_000_000))?;
            Ok(asked.iter().zip(&found).map(|(p, m)| row(p, measured(m))).collect())
        })?);
    }
    Ok(comparisons)
}
