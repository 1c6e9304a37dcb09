//! How time grows with what is asked for: photons, gathers, beams, optical thickness, triangles, pixels, threads; and how long a
//! process takes to start.
//!
//! `cargo bench -p turbid-benches --bench growth -- photons` runs the rows whose name contains a word; `1e8` among the words takes the
//! photons to 10^8, for which the machine wants 16 GB.
//!
//! Each row is measured at all its sizes in turn, round after round; the exponent is the slope of the logarithm of the time, fitted round
//! by round, with the 95 % interval of its mean over rounds, and beside it that between the last two sizes.

use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use glam::{DVec3, Vec3};
use paired::{compare_seconds, strewn};
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::geometry::Mesh;
use turbid::integrators::mapper::{Mapper, Settings};
use turbid::math::{Interval, Ray, ln, sin, warp};
use turbid::phase::Isotropic;
use turbid::photons::beams::{Beam, BeamKind, BeamTree};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill};
use turbid::photons::{Flags, PhotonMap, PhotonTree, Photons};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Scene, SceneFile};
use turbid::sensor::{Method, Streams};
use turbid::stats::{Moments, fit_line, mean_interval};
use turbid::transport::NoProgress;

/// Rounds of each row, and pairs of a comparison.
const ROUNDS: usize = 5;
const PAIRS: usize = 9;
const QUERIES: u64 = 20_000;
const STREAMS: Streams = Streams { seed: 1, replicate: 0 };

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_large = words.iter().any(|word| word == "1e8");
    let wanted: Vec<String> = words.into_iter().filter(|word| word != "1e8").collect();
    let mut bench = Bench { wanted, out: std::io::stdout() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| bench.on_one_thread(is_large))?;
    bench.threads()?;
    bench.starts()
}

struct Bench {
    wanted: Vec<String>,
    out: std::io::Stdout,
}

impl Bench {
    fn wants(&self, name: &str) -> bool {
        self.wanted.is_empty() || self.wanted.iter().any(|word| name.contains(word))
    }

    /// A row: the seconds of one unit of work at each size.
    fn row(
        &mut self,
        name: &str,
        sizes: &[f64],
        mut seconds: impl FnMut(usize) -> Result<f64>,
    ) -> Result<()> {
        if !self.wants(name) {
            return Ok(());
        }
        let (mut slopes, mut last, mut times) =
            (Moments::new(), Moments::new(), vec![Vec::new(); sizes.len()]);
        for _ in 0..ROUNDS {
            let round: Vec<f64> = (0..sizes.len()).map(&mut seconds).collect::<Result<_>>()?;
            let point = |(x, t): (&f64, &f64)| (ln(*x), ln(*t), 1.0);
            let points: Vec<_> = sizes.iter().zip(&round).map(point).collect();
            slopes.push(fit_line(&points).context("one size")?.slope);
            last.push(fit_line(&points[points.len() - 2..]).context("one size")?.slope);
            times.iter_mut().zip(round).for_each(|(times, time)| times.push(time));
        }
        writeln!(self.out, "{name}")?;
        for (size, times) in sizes.iter().zip(&mut times) {
            times.sort_unstable_by(f64::total_cmp);
            writeln!(self.out, "{size:12.3e} {:>14}", told(times[ROUNDS / 2]))?;
        }
        let said = |slopes: &Moments| {
            let ends = mean_interval(slopes, 0.95);
            format!("{:.3} ({:.3} to {:.3})", slopes.mean(), ends.low, ends.high)
        };
        writeln!(self.out, "    exponent {}, of the last two {}", said(&slopes), said(&last))?;
        Ok(())
    }

    fn on_one_thread(&mut self, is_large: bool) -> Result<()> {
        let fog = fogbox()?;
        let counts = [1e5, 1e6, 1e7, 1e8];
        let counts = if is_large { &counts[..] } else { &counts[..3] };
        self.row("photons stored in the box of fog: their pass and their tree", &counts[..3], |size| {
            timed(|| Ok(_ = black_box(fill(&fog, &amounts(1, counts[size] as u64), &NoProgress)?)))
        })?;
        self.row("photons in a tree: its build", counts, |size| {
            let photons = evenly(counts[size] as u64);
            timed(|| Ok(_ = black_box(PhotonTree::new(photons)?)))
        })?;
        let name = "photons in a map: a gather of the 100 nearest";
        if self.wants(name) {
            let maps: Vec<PhotonMap> = counts.iter().map(|n| map(*n as u64)).collect::<Result<_>>()?;
            self.row(name, counts, |size| gathers(&maps[size], 100))?;
        }
        let nearest = [10.0, 100.0, 1000.0, 10_000.0];
        let name = "photons of a gather, in a map of 10^6";
        if self.wants(name) {
            let map = map(1_000_000)?;
            self.row(name, &nearest, |size| gathers(&map, nearest[size] as usize))?;
        }
        let beams = [1e4, 1e5, 1e6];
        let name = "beams in a tree: a ray that 24 of them pass within the radius";
        if self.wants(name) {
            let trees: Vec<BeamTree> = beams.iter().map(|n| beam_tree(*n as u64)).collect::<Result<_>>()?;
            self.row(name, &beams, |size| Ok(crossed(&trees[size], 60.0 / beams[size])?.0))?;
            for (count, tree) in beams.iter().zip(&trees) {
                let (seconds, found, asked) = crossed(tree, 60.0 / count)?;
                writeln!(
                    self.out,
                    "    {count:.0e} beams: {found:.0} of {asked:.0} pieces asked a ray; {:.0} million tests a second",
                    asked / seconds * 1e-6
                )?;
            }
        }
        let depths = [1.0, 10.0, 100.0, 1000.0];
        for albedo in [1.0, 0.9] {
            let scenes: Vec<Scene> = depths.iter().map(|tau| cube(*tau, albedo)).collect::<Result<_>>()?;
            let name = format!("optical thickness of a cube of albedo {albedo}: a path");
            self.row(&name, &depths, |size| Ok(picture(&scenes[size], 24, 8)? / (24.0 * 24.0 * 8.0)))?;
        }
        let triangles = [32.0, 316.0, 2236.0].map(|n| (n, 2.0 * n * n));
        let sizes = triangles.map(|(_, count)| count);
        self.row("triangles: the build of their tree", &sizes, |size| {
            let (corners, indices) = sheet(triangles[size].0 as u32);
            timed(|| Ok(_ = black_box(Mesh::new(&corners, &indices, None)?)))
        })?;
        let name = "triangles: the nearest hit of a ray";
        if self.wants(name) {
            let meshes: Vec<Mesh> = triangles.iter().map(|(n, _)| mesh(*n as u32)).collect::<Result<_>>()?;
            let rays: Vec<Ray> = (0..QUERIES).map(ray).collect();
            self.row(name, &sizes, |size| {
                let seconds = timed(|| {
                    rays.iter().for_each(|ray| _ = black_box(meshes[size].hit(ray, None)));
                    Ok(())
                })?;
                Ok(seconds / QUERIES as f64)
            })?;
        }
        let widths = [32.0, 64.0, 128.0, 256.0];
        let pixels = widths.map(|width| width * width);
        self.row("pixels: a picture by paths, one sample each", &pixels, |size| {
            picture(&fog, widths[size] as u32, 1)
        })
    }

    /// Time of one thread over that of two, by the clock on the wall.
    fn threads(&mut self) -> Result<()> {
        let fog = fogbox()?;
        let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let (one, two) = (pool(1)?, pool(2)?);
        let works: [(&str, &(dyn Fn() -> Result<()> + Sync)); 3] = [
            ("threads: paths", &|| picture(&fog, 128, 8).map(|_| ())),
            ("threads: photons shot and their trees", &|| {
                Ok(_ = black_box(fill(&fog, &amounts(300_000, 300_000), &NoProgress)?))
            }),
            ("threads: a picture from maps", &|| from_maps(&fog)),
        ];
        for (name, work) in works {
            if !self.wants(name) {
                continue;
            }
            let wall = |pool: &rayon::ThreadPool| {
                let start = Instant::now();
                pool.install(|| work().map(|()| start.elapsed().as_secs_f64()))
            };
            // What fails once fails here.
            wall(&one)?;
            let seconds = |pool| wall(pool).unwrap_or(f64::NAN);
            let ratio = compare_seconds(PAIRS, || seconds(&one), || seconds(&two));
            let [low, high] = ratio.interval;
            writeln!(
                self.out,
                "{name}: one takes {:.2} ({low:.2} to {high:.2}) times as long as two",
                ratio.ratio
            )?;
        }
        Ok(())
    }

    /// Seconds of whole processes, by the clock on the wall, where they are built: `cargo build --release`.
    fn starts(&mut self) -> Result<()> {
        let folder = std::env::current_exe()?;
        let folder = folder.ancestors().nth(2).context("no folder of programs")?;
        let picture = std::env::temp_dir().join(format!("growth-{}.exr", std::process::id()));
        let to = picture.display().to_string();
        let tiny = ["--width", "8", "--height", "8", "--samples", "1", "--gather-rays", "0"];
        let few = ["--global", "emit:1000", "--volume", "emit:1000", "-o", &to];
        let slab = ["slab", "--tau", "1", "--albedo", "0.9", "--g", "0.75"];
        for (name, program, words) in [
            (
                "start: turbid render, 8 x 8 pixels",
                "turbid",
                [&["render", "fogbox"], &tiny[..], &few].concat(),
            ),
            ("start: exact slab", "exact", slab.to_vec()),
        ] {
            let path = folder.join(program);
            if !self.wants(name) {
                continue;
            }
            if !path.is_file() {
                writeln!(self.out, "{name}: it is not built; needed: cargo build --release --workspace")?;
                continue;
            }
            let mut times = Vec::new();
            for _ in 0..21 {
                let start = Instant::now();
                let mut command = Command::new(&path);
                let status = command.args(&words).stdout(Stdio::null()).stderr(Stdio::null()).status()?;
                anyhow::ensure!(status.success(), "{program} {words:?} failed");
                times.push(start.elapsed().as_secs_f64());
            }
            times.sort_unstable_by(f64::total_cmp);
            writeln!(self.out, "{name}: {}, the slowest of 21 {}", told(times[10]), told(times[20]))?;
        }
        for made in ["exr", "png"] {
            let _ = std::fs::remove_file(picture.with_extension(made));
        }
        Ok(())
    }
}

fn told(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.3} us", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

/// Seconds of this thread's processor that work takes.
fn timed(work: impl FnOnce() -> Result<()>) -> Result<f64> {
    let start = ThreadTime::now();
    work()?;
    Ok(start.elapsed().as_secs_f64())
}

fn fogbox() -> Result<Scene> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/fogbox-iso.toml"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    scene(&text)
}

fn scene(text: &str) -> Result<Scene> {
    let file: SceneFile = toml::from_str(text)?;
    Ok(file.scene(&PathBuf::from("."))?)
}

/// A cube of even matter beside a lamp, seen so that it fills the picture.
fn cube(depth: f64, albedo: f64) -> Result<Scene> {
    scene(&format!(
        "
        camera = {{ position = [0.0, 0.0, 3.0], look_at = [0.0, 0.0, 0.0], fov = 45.0, width = 24, height = 24 }}
        [[regions]]
        shape = {{ cuboid = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }} }}
        sigma_t = {}
        albedo = {albedo}
        g = 0.0
        [[lights]]
        point = {{ position = [2.0, 3.0, 4.0], power = 100.0 }}
        ",
        0.5 * depth
    ))
}

fn amounts(global: u64, volume: u64) -> MapSettings {
    MapSettings {
        global: Amount::Stored(global),
        caustic: Amount::Emitted(1),
        volume: Amount::Stored(volume),
        media: MediumSamples::Points,
        indirect: Indirect::Seen,
        seed: 1,
        replicate: 0,
    }
}

/// Seconds of a picture by paths.
fn picture(scene: &Scene, width: u32, samples: u64) -> Result<f64> {
    let camera = scene.camera().context("no camera")?.with_size(width, width)?;
    timed(|| Ok(_ = black_box(Method::Paths(scene).render(&camera, samples, STREAMS, &NoProgress)?)))
}

fn from_maps(scene: &Scene) -> Result<()> {
    let camera = scene.camera().context("no camera")?.with_size(96, 96)?;
    let maps = fill(scene, &amounts(50_000, 50_000), &NoProgress)?;
    let settings = Settings::for_size(2.0, 100)?;
    let photons = Method::Photons(Mapper::new(scene, &maps, &settings));
    black_box(photons.render(&camera, 1, STREAMS, &NoProgress)?);
    Ok(())
}

fn evenly(count: u64) -> Photons {
    strewn(count, &mut Stream::new(1, Purpose::Synthetic, 0, 0)).collect()
}

fn map(count: u64) -> Result<PhotonMap> {
    Ok(PhotonMap::new(evenly(count), count)?)
}

/// Seconds of a gather of the k nearest, along lines through the map: places of one after the other are neighbours.
fn gathers(map: &PhotonMap, k: usize) -> Result<f64> {
    let estimator = Estimator::new(Kernel::Uniform, Gather::nearest(k, 10.0)?);
    // As many photons are looked at from k = 100 on.
    let lines = (QUERIES / (k as u64).max(100)).max(1);
    let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
    let ways: Vec<_> =
        (0..lines).map(|_| [DVec3::from(stream.triple()), DVec3::from(stream.triple())]).collect();
    let seconds = timed(|| {
        for [from, to] in &ways {
            for step in 0..100 {
                let place = from.lerp(*to, f64::from(step) / 100.0);
                let boundary = &Boundary::UNKNOWN;
                black_box(estimator.in_scattered(map, place, DVec3::Z, &Isotropic, Spectrum::ONE, boundary));
            }
        }
        Ok(())
    })?;
    Ok(seconds / (lines * 100) as f64)
}

/// Beams of random directions and lengths about 1 from anywhere in a unit cube.
fn beam_tree(count: u64) -> Result<BeamTree> {
    let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
    let beam = |_| Beam {
        start: DVec3::from(stream.triple()),
        dir: warp::square_to_sphere(stream.pair()),
        length: -turbid::math::ln_1p(-stream.unit()),
        power: Vec3::ONE,
        medium: 0,
        order: 1,
        flags: Flags::MEDIUM,
        kind: BeamKind::Sampled,
    };
    Ok(BeamTree::new(vec![(0..count).map(beam).collect()])?)
}

/// Seconds of a ray, beams found, and pieces of beams asked.
fn crossed(tree: &BeamTree, radius: f64) -> Result<(f64, f64, f64)> {
    let rays: Vec<Ray> = (0..QUERIES / 10).map(ray).collect();
    let span = Interval { start: 0.0, end: f64::INFINITY };
    let mut found = 0;
    let seconds = timed(|| {
        rays.iter().for_each(|ray| tree.near(ray, span, radius, |_, _| found += 1));
        Ok(())
    })?;
    let asked: usize = rays.iter().map(|ray| tree.asked_near(ray, span, radius)).sum();
    let count = rays.len() as f64;
    Ok((seconds / count, f64::from(found) / count, asked as f64 / count))
}

/// A ray between random points of a sphere about the unit cube, unlike the one before.
fn ray(number: u64) -> Ray {
    let mut stream = Stream::new(4, Purpose::Synthetic, 0, number);
    let [a, b] = [stream.pair(), stream.pair()].map(|u| DVec3::splat(0.5) + warp::square_to_sphere(u) * 0.8);
    Ray::new(a, (b - a).normalize())
}

type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// A sheet with hills across the unit cube, of 2 n^2 triangles.
fn sheet(n: u32) -> Surface {
    let place = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        DVec3::new(x, y, 0.5 + 0.1 * sin(20.0 * x) * sin(17.0 * y))
    };
    let corners = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j))).collect();
    let cell = |i: u32, j: u32| {
        let first = j * (n + 1) + i;
        let [a, b, c, d] = [first, first + 1, first + n + 1, first + n + 2];
        [[a, b, d], [a, d, c]]
    };
    (corners, (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect())
}

fn mesh(n: u32) -> Result<Mesh> {
    let (corners, triangles) = sheet(n);
    Ok(Mesh::new(&corners, &triangles, None)?)
}
