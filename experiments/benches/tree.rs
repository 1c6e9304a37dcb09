//! The photon tree against kiddo 6, in one run on one thread: 10^6 photons, uniform and in a light shaft,
//! queries in the order of a ray march, power x phase function summed on both sides.
//!
//! `cargo bench -p turbid-benches --bench tree -- build` runs the rows whose name contains the word.
//!
//! kiddo is used at its best for this: an immutable tree of f32, its payload in the order of its leaves as
//! one record a photon, unsorted results, a visitor for the fixed radius and reused scratch memory.

use glam::{DVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use paired::{Ratio, compare};
use std::hint::black_box;
use std::io::Write;
use std::num::NonZero;
use turbid::Spectrum;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel, count_within};
use turbid::math::{Asymmetry, FOUR_PI, warp};
use turbid::phase::HenyeyGreenstein;
use turbid::photons::{Flags, Photon, PhotonMap, PhotonTree};
use turbid::rng::{Purpose, Stream};

const PHOTONS: u64 = 1_000_000;
const ROUNDS: usize = 15;
const K: usize = 100;
const IN_RANGE: f64 = 75.0;
const G: f64 = 0.75;

fn main() -> anyhow::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |what: &str| wanted.is_empty() || wanted.iter().any(|word| what.contains(word));
    let mut out = std::io::stdout().lock();
    writeln!(out, "{PHOTONS} photons, one thread, {ROUNDS} rounds; times faster than kiddo, 95 % interval")?;
    for (name, photons) in [("uniform", uniform()), ("light shaft", shaft())] {
        let queries = march();
        let peer = Peer::new(&photons);
        let ours = PhotonMap::new(photons.clone(), PHOTONS)?;
        let radius = radius_holding(&ours, &queries);
        let (r2, phase) = ((radius * radius) as f32, HenyeyGreenstein::new(Asymmetry::new("g", G)?));
        let (fixed, nearest) = (Gather::radius(radius)?, Gather::nearest(K, 10.0)?);
        let mut scratch = peer.tree.create_scratch::<SquaredEuclidean<f32>>();

        if is_wanted("fixed radius") {
            let ratio = compare(
                ROUNDS,
                || queries.iter().for_each(|q| _ = black_box(peer.within(q, r2, &mut scratch))),
                || queries.iter().for_each(|q| _ = black_box(scattered(&ours, q, &phase, fixed))),
            );
            row(&mut out, name, "fixed radius", ratio, queries.len())?;
        }
        if is_wanted("k = 100") {
            let ratio = compare(
                ROUNDS,
                || queries.iter().for_each(|q| _ = black_box(peer.nearest(q, &mut scratch))),
                || queries.iter().for_each(|q| _ = black_box(scattered(&ours, q, &phase, nearest))),
            );
            row(&mut out, name, "k = 100", ratio, queries.len())?;
        }
        if is_wanted("build") {
            // The tree takes the photons over, so that each round needs its own, made before the clock runs.
            let mut stock = vec![photons.clone(); ROUNDS + 1];
            let ratio = compare(
                ROUNDS,
                || _ = black_box(Peer::ordered(&photons)),
                || _ = black_box(PhotonTree::new(stock.pop().unwrap_or_default())),
            );
            row(&mut out, name, "build", ratio, 1)?;
        }
    }
    Ok(())
}

fn row(out: &mut impl Write, map: &str, what: &str, ratio: Ratio, count: usize) -> std::io::Result<()> {
    let [low, high] = ratio.interval;
    let [theirs, ours] = ratio.seconds.map(|s| s / count as f64 * 1e6);
    writeln!(
        out,
        "{map:12} {what:13} {:6.2} ({low:.2} to {high:.2})   kiddo {theirs:10.2} us   turbid {ours:10.2} us",
        ratio.ratio
    )
}

/// kiddo's tree, its items numbered by leaf, and the payload in that order.
struct Peer {
    tree: ImmutableKdTree<f32, 3>,
    payload: Vec<[Vec3; 2]>,
}

type Scratch = kiddo::QueryScratch<kiddo::Eytzinger, f32, 3>;

impl Peer {
    fn new(photons: &[Photon]) -> Self {
        let (tree, payload) = Self::ordered(photons);
        let mut entries: Vec<(u32, [f32; 3])> =
            photons.iter().map(|p| (0, p.position.as_vec3().to_array())).collect();
        for (place, (item, _)) in tree.iter().enumerate() {
            entries[item as usize].0 = place as u32;
        }
        let tree = ImmutableKdTree::new_from_entries(&entries).expect("finite points");
        Peer { tree, payload }
    }

    /// The tree, and the payload put in the order of its leaves: what is timed as its build.
    fn ordered(photons: &[Photon]) -> (ImmutableKdTree<f32, 3>, Vec<[Vec3; 2]>) {
        let points: Vec<[f32; 3]> = photons.iter().map(|p| p.position.as_vec3().to_array()).collect();
        let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(&points).expect("finite points");
        let payload =
            tree.iter().map(|(item, _)| &photons[item as usize]).map(|p| [p.dir, p.power]).collect();
        (tree, payload)
    }

    fn within(&self, q: &DVec3, r2: f32, scratch: &mut Scratch) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let scatter = Scatter::new();
        self.tree
            .query(&q.as_vec3().to_array())
            .within::<SquaredEuclidean<f32>>(r2)
            .unsorted()
            .with_scratch(scratch)
            .visit(|found| sum += scatter.of(&self.payload[found.item as usize]));
        sum
    }

    fn nearest(&self, q: &DVec3, scratch: &mut Scratch) -> (Vec3, f32) {
        let (mut sum, mut farthest) = (Vec3::ZERO, 0.0f32);
        let scatter = Scatter::new();
        let found = self
            .tree
            .query(&q.as_vec3().to_array())
            .nearest_n::<SquaredEuclidean<f32>>(NonZero::new(K).expect("above zero"))
            .unsorted()
            .with_scratch(scratch)
            .execute();
        for one in found {
            farthest = farthest.max(one.distance);
            sum += scatter.of(&self.payload[one.item as usize]);
        }
        (sum, farthest)
    }
}

/// The same phase function in single precision, photon by photon, as one writes it for a list of photons.
struct Scatter {
    wo: Vec3,
    front: f32,
    square: f32,
    slope: f32,
}

impl Scatter {
    fn new() -> Self {
        let front = ((1.0 - G * G) / FOUR_PI) as f32;
        Scatter { wo: Vec3::Z, front, square: ((1.0 - G) * (1.0 - G)) as f32, slope: (2.0 * G) as f32 }
    }

    #[inline(always)]
    fn of(&self, [dir, power]: &[Vec3; 2]) -> Vec3 {
        let d = self.square + self.slope * (0.5 * (*dir - self.wo).length_squared());
        *power * (self.front / (d * d.sqrt()))
    }
}

fn scattered(map: &PhotonMap, q: &DVec3, phase: &HenyeyGreenstein, gather: Gather) -> Spectrum {
    let estimator = Estimator::new(Kernel::Uniform, gather);
    estimator.in_scattered(map, *q, DVec3::Z, phase, Spectrum::ONE, &Boundary::UNKNOWN).value
}

/// The radius that holds 75 photons on average, over the queries that meet light.
fn radius_holding(map: &PhotonMap, queries: &[DVec3]) -> f64 {
    let (mut low, mut high) = (1e-4, 1.0);
    for _ in 0..20 {
        let middle: f64 = 0.5 * (low + high);
        let counts = queries.iter().step_by(17).map(|q| count_within(map, *q, middle));
        let (sum, some) = counts.filter(|&n| n > 0).fold((0, 0), |(s, n), c| (s + c, n + 1));
        if sum as f64 > IN_RANGE * f64::from(some.max(1)) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

fn photon(position: DVec3, stream: &mut Stream) -> Photon {
    Photon {
        position,
        dir: warp::square_to_sphere(stream.pair()).as_vec3(),
        normal: Vec3::ZERO,
        power: Vec3::new(1.0, 0.9, 0.8),
        order: 1,
        flags: Flags::MEDIUM,
    }
}

fn uniform() -> Vec<Photon> {
    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
    (0..PHOTONS)
        .map(|_| photon(DVec3::new(stream.unit(), stream.unit(), stream.unit()), &mut stream))
        .collect()
}

/// Nine photons of ten in a slanted cylinder of a tenth of the box, thinning out along it; one of ten
/// anywhere.
fn shaft() -> Vec<Photon> {
    let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
    let axis = DVec3::new(0.3, 0.1, 1.0).normalize();
    let frame = turbid::math::Frame::new(axis);
    (0..PHOTONS)
        .map(|_| {
            let anywhere = DVec3::new(stream.unit(), stream.unit(), stream.unit());
            let disc = warp::square_to_disc(stream.pair()) * 0.05;
            let along = (-turbid::math::ln_1p(-stream.unit() * 0.87)) * 0.5;
            let inside = DVec3::new(0.35, 0.45, 0.0) + frame.to_world(DVec3::new(disc.x, disc.y, along));
            let position = if stream.unit() < 0.9 { inside } else { anywhere };
            photon(position, &mut stream)
        })
        .collect()
}

/// Points along the rays of neighbouring pixels, 64 to a ray, ray after ray.
fn march() -> Vec<DVec3> {
    let eye = DVec3::new(0.5, -1.5, 0.5);
    let mut points = Vec::new();
    for pixel in 0..16 * 16 {
        let (i, j) = (f64::from(pixel % 16), f64::from(pixel / 16));
        let target = DVec3::new(0.3 + 0.4 * i / 16.0, 0.5, 0.2 + 0.6 * j / 16.0);
        let dir = (target - eye) / 2.0;
        points.extend((0..64).map(|step| eye + dir * (1.55 + 0.9 * (f64::from(step) + 0.5) / 64.0)));
    }
    points
}
