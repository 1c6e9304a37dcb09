//! How far turbid stands from what nothing could save: of a flight and a path the parts that every walk has, of a gather the sum alone, of
//! two threads what two computations do that know nothing of each other.
//!
//! `cargo bench -p turbid-benches --bench limits -- walk` runs the parts whose name contains a word.

use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use glam::{DVec2, DVec3};
use paired::{compare, compare_seconds, strewn};
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::path;
use turbid::math::{Ray, ln_1p, warp};
use turbid::phase::Isotropic;
use turbid::photons::{Histories, Photon, PhotonMap, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Scene, SceneFile};
use turbid::sensor::{Method, Streams};
use turbid::transport::NoProgress;

/// Rounds, and pairs of a comparison.
const ROUNDS: usize = 15;
const HISTORIES: u64 = 1 << 17;
const PATHS: u64 = 1 << 15;
const RAYS: u64 = 1 << 17;
/// Photons of the map, and in a gather.
const PHOTONS: u64 = 1_000_000;
const IN_RANGE: f64 = 75.0;
const GATHERS: u64 = 256;

fn main() -> Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |what: &str| wanted.is_empty() || wanted.iter().any(|word| what.contains(word));
    let mut out = std::io::stdout();
    let scene = fogbox()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    if is_wanted("walk") {
        pool.install(|| walks(&scene, &mut out))?;
    }
    if is_wanted("gather") {
        gather(&mut out)?;
    }
    if is_wanted("threads") {
        threads(&scene, &mut out)?;
    }
    Ok(())
}

fn fogbox() -> Result<Scene> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/fogbox-iso.toml"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let file: SceneFile = toml::from_str(&text)?;
    Ok(file.scene(&PathBuf::from("."))?)
}

/// Median nanoseconds of one of `count` pieces of work, and the quartiles over rounds.
fn nanoseconds(count: u64, mut work: impl FnMut() -> Result<()>) -> Result<[f64; 3]> {
    work()?;
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let start = ThreadTime::now();
        work()?;
        times.push(start.elapsed().as_secs_f64() * 1e9 / count as f64);
    }
    times.sort_unstable_by(f64::total_cmp);
    Ok([ROUNDS / 2, ROUNDS / 4, 3 * ROUNDS / 4].map(|place| times[place]))
}

/// Median and quartiles.
fn row(out: &mut impl Write, name: &str, [median, low, high]: [f64; 3]) -> Result<()> {
    Ok(writeln!(out, "{name:48} {median:8.1} ({low:.1} to {high:.1})")?)
}

/// A photon's flights and a path in the box of fog, and what each of them has to do.
fn walks(scene: &Scene, out: &mut impl Write) -> Result<()> {
    let rays: Vec<Ray> = (0..RAYS)
        .map(|number| {
            let mut stream = Stream::new(4, Purpose::Synthetic, 0, number);
            let place = (DVec3::from(stream.triple()) - 0.5) * 1.9;
            Ray::new(place, warp::square_to_sphere(stream.pair()))
        })
        .collect();
    let mut stream = Stream::new(5, Purpose::Synthetic, 0, 0);
    let hit = nanoseconds(RAYS, || {
        rays.iter().for_each(|ray| _ = black_box(scene.hit(ray, None)));
        Ok(())
    })?;
    // To places in the room, as from there to a lamp.
    let shadow = nanoseconds(RAYS, || {
        rays.iter().for_each(|ray| _ = black_box(scene.sees(ray, None, 0.5)));
        Ok(())
    })?;
    let distance = nanoseconds(RAYS, || {
        (0..RAYS).for_each(|_| _ = black_box(-ln_1p(-stream.unit())));
        Ok(())
    })?;
    let direction = nanoseconds(RAYS, || {
        (0..RAYS).for_each(|_| _ = black_box(warp::square_to_sphere(stream.pair())));
        Ok(())
    })?;
    let survival = nanoseconds(RAYS, || {
        (0..RAYS).for_each(|_| _ = black_box(stream.unit() < 0.8));
        Ok(())
    })?;
    let histories = Histories { count: HISTORIES, seed: 1, replicate: 0, max_order: None };
    let shot = |is_kept: bool| shoot(scene, histories, &[], |_| is_kept, &NoProgress);
    let report = shot(false)?.report;
    let flights = report.collisions + report.hits + report.ends.escaped;
    let [kept, flown] =
        [true, false].map(|is_kept| nanoseconds(flights, || Ok(_ = black_box(shot(is_kept)?))));
    let flown = flown?;
    let parts = [hit, distance, direction, survival].iter().map(|part| part[0]).sum::<f64>();
    writeln!(out, "a flight of a photon in the box of fog, ns: median, quartiles")?;
    row(out, "all of it, photons stored", kept?)?;
    row(out, "all of it, none stored", flown)?;
    row(out, "the nearest of 18 rectangles", hit)?;
    row(out, "a distance: a number and a logarithm", distance)?;
    row(out, "a direction: two numbers, sine, cosine, root", direction)?;
    row(out, "whether it survives: a number", survival)?;
    row(out, "the rest, none stored", flown.map(|all| all - parts))?;

    let camera = scene.camera().context("no camera")?.with_size(128, 128)?;
    let (mut segments, mut shadows) = (0, 0);
    let path = nanoseconds(PATHS, || {
        (segments, shadows) = (0, 0);
        for number in 0..PATHS {
            let mut stream = Stream::new(1, Purpose::Paths, 0, number);
            let ray = camera.ray(DVec2::from(stream.pair()) * 128.0);
            let (layers, rays) = path::layers(scene, ray, None, 0, &mut stream);
            black_box(layers);
            (segments, shadows) = (segments + rays.segments, shadows + rays.shadow);
        }
        Ok(())
    })?;
    let [segments, shadows] = [segments, shadows].map(|count| count as f64 / PATHS as f64);
    let parts = segments * (hit[0] + distance[0] + direction[0] + survival[0]) + shadows * shadow[0];
    writeln!(out, "a path there, of {segments:.1} segments and {shadows:.1} shadow rays, ns")?;
    row(out, "all of it", path)?;
    row(out, "its nearest hits", hit.map(|one| segments * one))?;
    row(out, "its shadow rays", shadow.map(|one| shadows * one))?;
    row(
        out,
        "distances, directions, survival",
        [0, 1, 2].map(|i| segments * (distance[i] + direction[i] + survival[i])),
    )?;
    row(out, "the rest", path.map(|all| all - parts))
}

/// A gather at fixed radius, and the sum over the same photons that lie in a map of their own, where there is nothing to search.
fn gather(out: &mut impl Write) -> Result<()> {
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    let photons: Vec<Photon> = strewn(PHOTONS, &mut stream).collect();
    let radius = libm::cbrt(IN_RANGE / PHOTONS as f64 * 0.75 / std::f64::consts::PI);
    let places: Vec<DVec3> =
        (0..GATHERS).map(|_| DVec3::splat(0.1) + 0.8 * DVec3::from(stream.triple())).collect();
    let own = |place: &DVec3| {
        let is_near = |photon: &&Photon| photon.position.distance(*place) <= radius;
        PhotonMap::new(photons.iter().filter(is_near).copied().collect::<Vec<_>>(), PHOTONS)
    };
    let own: Vec<PhotonMap> = places.iter().map(own).collect::<turbid::error::Result<_>>()?;
    let held = own.iter().map(PhotonMap::stored).sum::<usize>() as f64 / GATHERS as f64;
    let whole = PhotonMap::new(photons, PHOTONS)?;
    let estimator = Estimator::new(Kernel::Uniform, Gather::radius(radius)?);
    let read = |map: &PhotonMap, place: DVec3| {
        let boundary = &Boundary::UNKNOWN;
        black_box(estimator.in_scattered(map, place, DVec3::Z, &Isotropic, Spectrum::ONE, boundary));
    };
    // As the steps of a march do: places of one after the other are neighbours, and their photons in the cache.
    const TIMES: u32 = 64;
    let near = |place: &DVec3, n: u32| *place + DVec3::splat(1e-3 * radius * f64::from(n));
    let ratio = compare(
        ROUNDS,
        || places.iter().for_each(|place| (0..TIMES).for_each(|n| read(&whole, near(place, n)))),
        || {
            let both = places.iter().zip(&own);
            both.for_each(|(place, map)| (0..TIMES).for_each(|n| read(map, near(place, n))));
        },
    );
    let [all, sum] = ratio.seconds.map(|s| s * 1e6 / (GATHERS as f64 * f64::from(TIMES)));
    let [low, high] = ratio.interval;
    writeln!(
        out,
        "a gather of {held:.0} photons at fixed radius in 10^6, us: {all:.3}; of them alone {sum:.3}; ratio {:.2} ({low:.2} to {high:.2})",
        ratio.ratio
    )?;
    Ok(())
}

/// The same picture by one thread, and twice at the same time by two that share nothing.
fn threads(scene: &Scene, out: &mut impl Write) -> Result<()> {
    let camera = scene.camera().context("no camera")?.with_size(128, 128)?;
    let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, other, two) = (pool(1)?, pool(1)?, pool(2)?);
    let picture = || {
        let streams = Streams { seed: 1, replicate: 0 };
        Method::Paths(scene).render(&camera, 8, streams, &NoProgress).map(|film| _ = black_box(film))
    };
    picture()?;
    let wall = |work: &dyn Fn()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    // What fails once has failed above.
    let alone = || wall(&|| _ = one.install(picture));
    let both = || {
        wall(&|| {
            std::thread::scope(|scope| {
                scope.spawn(|| _ = one.install(picture));
                scope.spawn(|| _ = other.install(picture));
            })
        })
    };
    let shared = || wall(&|| _ = two.install(picture));
    for (name, ratio, times) in [
        ("two that share nothing", compare_seconds(ROUNDS, alone, both), 2.0),
        ("two threads of one picture", compare_seconds(ROUNDS, alone, shared), 1.0),
    ] {
        let [low, high] = ratio.interval.map(|end| times * end);
        let more = times * ratio.ratio;
        writeln!(out, "{name}: {more:.2} ({low:.2} to {high:.2}) times the work of one in the same time")?;
    }
    Ok(())
}
