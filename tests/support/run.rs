//! Runs: moments by histories of paths and photons.

use turbid::Spectrum;
use turbid::photons::{Emitter, Histories, Pass, Photon, Run, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, Scene, Sensor, Start, Target};
use turbid::stats::Moments;
use turbid::transport::{NoProgress, Roulette, Step, Visitor, Walker, run_blocks, walk};

/// Moments by channel of any function of a stream, over `n` histories.
pub fn histories(n: u64, seed: u64, f: impl Fn(&mut Stream) -> Spectrum + Sync) -> [Moments; 3] {
    let block = |range: std::ops::Range<u64>| {
        let mut moments = [Moments::new(); 3];
        for history in range {
            let value = f(&mut Stream::new(seed, Purpose::Synthetic, 0, history));
            for (channel, m) in moments.iter_mut().enumerate() {
                m.push(value[channel]);
            }
        }
        moments
    };
    run_blocks(n, &NoProgress, block, merge).unwrap().unwrap()
}

fn merge(mut a: [Moments; 3], b: [Moments; 3]) -> [Moments; 3] {
    a.iter_mut().zip(&b).for_each(|(a, b)| a.merge(b));
    a
}

/// Moments of a number a history.
pub fn numbers(n: u64, seed: u64, f: impl Fn(&mut Stream) -> f64 + Sync) -> Moments {
    histories(n, seed, |stream| Spectrum::grey(f(stream)))[0]
}

/// Paths: moments by channel of one quantity, restricted to orders.
pub fn paths(scene: &Scene, quantity: Quantity, orders: Orders, n: u64, seed: u64) -> [Moments; 3] {
    histories(n, seed, |stream| turbid::sensor::sample(scene, &quantity, orders, stream))
}

pub fn sensor(quantity: Quantity, orders: Orders) -> Sensor {
    Sensor { name: "test".into(), label: "test".into(), quantity, orders }
}

/// Photons: one pass that keeps what `keep` accepts and tallies the quantities.
pub fn pass(
    scene: &Scene,
    sensors: &[(Quantity, Orders)],
    n: u64,
    seed: u64,
    keep: impl Fn(&Photon) -> bool + Sync,
) -> Pass {
    let sensors: Vec<Sensor> = sensors.iter().map(|(q, o)| sensor(q.clone(), *o)).collect();
    let histories = Histories { count: n, seed, replicate: 0, max_order: None };
    shoot(scene, histories, &sensors, keep, &NoProgress).unwrap()
}

/// Photons: tallies of outflows and absorptances.
pub fn tallies(scene: &Scene, sensors: &[(Quantity, Orders)], n: u64, seed: u64) -> Vec<[Moments; 3]> {
    pass(scene, sensors, n, seed, |_| false).tallies
}

/// Photons: one pass that stores nothing and scores the sensors of the scene that have bins.
pub fn scoring_pass(scene: &Scene, n: u64, seed: u64) -> Pass {
    let histories = Histories { count: n, seed, replicate: 0, max_order: None };
    let emitter = Emitter::by_power(scene);
    let run = Run { scored: scene.sensors(), ..Run::new(scene, &emitter, histories) };
    run.pass(&|_: &Photon| false, &NoProgress).unwrap()
}

/// The same: moments by sensor, bin and channel.
pub fn scores(scene: &Scene, n: u64, seed: u64) -> Vec<Vec<[Moments; 3]>> {
    let pass = scoring_pass(scene, n, seed);
    let mut all = pass.scores.moments(scene, n);
    let binned = scene.sensors().iter().filter_map(Sensor::binned);
    binned.map(|binned| all.by_ref().take(binned.bins()).collect()).collect()
}

/// Paths: moments by channel of one bin of a sensor.
pub fn bin_paths(scene: &Scene, sensor: &Sensor, bin: usize, n: u64, seed: u64) -> [Moments; 3] {
    let binned = sensor.binned().unwrap();
    histories(n, seed, |stream| turbid::sensor::sample_bin(scene, (binned, bin), sensor.orders, stream).0)
}

/// Photon histories watched step by step: moments of numbers that a watcher made of each. One light; its power is 1
/// to the watcher.
pub fn watched<const N: usize, W: Watcher<N>>(
    scene: &Scene,
    n: u64,
    seed: u64,
    watcher: impl Fn() -> W + Sync,
) -> [Moments; N] {
    assert_eq!(scene.lights().len(), 1);
    let block = |range: std::ops::Range<u64>| {
        let mut moments = [Moments::new(); N];
        for history in range {
            let mut stream = Stream::new(seed, Purpose::Photons, 0, history);
            let ray = scene.lights()[0].emit(scene.periodic_cell(), &mut stream).ray;
            let origin_surface =
                scene.lights()[0].body().map(|_| Start { target: Target::Light(0), primitive: 0 });
            let start = Walker { origin_surface, ..Walker::new(ray, Spectrum::ONE) };
            let mut watching = Watching::<W, N>(watcher());
            walk(scene, start, Roulette::Analog, None, &mut stream, &mut watching);
            for (m, number) in moments.iter_mut().zip(watching.0.numbers()) {
                m.push(number);
            }
        }
        moments
    };
    let merge = |mut a: [Moments; N], b: [Moments; N]| {
        a.iter_mut().zip(&b).for_each(|(a, b)| a.merge(b));
        a
    };
    run_blocks(n, &NoProgress, block, merge).unwrap().unwrap()
}

/// Makes numbers of one photon history.
pub trait Watcher<const N: usize> {
    /// One step of the walk.
    fn see(&mut self, walker: &Walker, step: Step);
    /// The numbers, when the history is over.
    fn numbers(&self) -> [f64; N];
}

/// A watcher as a visitor of photons.
struct Watching<W, const N: usize>(W);

impl<const N: usize, W: Watcher<N>> Visitor for Watching<W, N> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        self.0.see(walker, step);
    }
}
