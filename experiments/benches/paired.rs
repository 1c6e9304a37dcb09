//! A comparison of two ways to do the same work: A and B in turn, and the ratio of their median times; and photons that several benchmarks ask.

use cpu_time::ThreadTime;
use glam::{DVec3, Vec3};
use turbid::math::warp;
use turbid::photons::{Flags, Photon};
use turbid::rng::{Purpose, Stream};

/// Photons strewn evenly in a unit cube.
pub fn strewn(count: u64, stream: &mut Stream) -> impl Iterator<Item = Photon> {
    (0..count).map(move |_| Photon {
        position: DVec3::from(stream.triple()),
        dir: warp::square_to_sphere(stream.pair()).as_vec3(),
        normal: Vec3::ZERO,
        power: Vec3::ONE,
        order: 1,
        flags: Flags::MEDIUM,
    })
}

/// How many times faster B is than A.
#[derive(Debug, Clone, Copy)]
pub struct Ratio {
    /// Median seconds of A over median seconds of B.
    pub ratio: f64,
    /// Ends of the 95 % interval, by resampling rounds.
    pub interval: [f64; 2],
    /// Median seconds of A and of B.
    pub seconds: [f64; 2],
}

/// Times `a` and `b` by this thread's processor clock, in turn, over `rounds` rounds after one that is not
/// counted.
pub fn compare(rounds: usize, mut a: impl FnMut(), mut b: impl FnMut()) -> Ratio {
    let time = |work: &mut dyn FnMut()| {
        let start = ThreadTime::now();
        work();
        start.elapsed().as_secs_f64()
    };
    compare_seconds(rounds, || time(&mut a), || time(&mut b))
}

/// The same for work that tells how many seconds it took, in another process for instance.
pub fn compare_seconds(rounds: usize, mut a: impl FnMut() -> f64, mut b: impl FnMut() -> f64) -> Ratio {
    a();
    b();
    let times: Vec<[f64; 2]> = (0..rounds).map(|_| [a(), b()]).collect();
    Ratio::of(&times)
}

impl Ratio {
    /// By the seconds of A and of B in each round.
    pub fn of(times: &[[f64; 2]]) -> Self {
        let rounds = times.len();
        let mut stream = Stream::new(1, Purpose::Resampling, 0, 0);
        let mut ratios: Vec<f64> = (0..2000)
            .map(|_| {
                let sample: Vec<[f64; 2]> = (0..rounds).map(|_| times[stream.index(rounds)]).collect();
                medians(&sample)[0] / medians(&sample)[1]
            })
            .collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let seconds = medians(times);
        Ratio { ratio: seconds[0] / seconds[1], interval: [ratios[49], ratios[1949]], seconds }
    }
}

fn medians(times: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|side| {
        let mut sorted: Vec<f64> = times.iter().map(|pair| pair[side]).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
    })
}
