//! The judge on right data: Student's t test of the mean of 64 numbers, where there is nothing to find.

use turbid::math::{ln, sin_cos};
use turbid::rng::{Purpose, Stream};
use turbid::stats::{Moments, student_critical};

/// Numbers behind one test: the fewest that verdicts allow.
pub const VALUES: u64 = crate::harness::MIN_MAPS;
/// Significances at which alarms are counted.
pub const LEVELS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// How the numbers are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Population {
    /// Normal.
    Normal,
    /// The sum of four exponential numbers: skewness 1.
    Skewed,
}

impl Population {
    /// All.
    pub const ALL: [Population; 2] = [Population::Normal, Population::Skewed];

    /// File-safe name.
    pub fn name(self) -> &'static str {
        match self {
            Population::Normal => "normal",
            Population::Skewed => "skewed",
        }
    }

    /// What it is, for readers.
    pub fn title(self) -> &'static str {
        match self {
            Population::Normal => "normal numbers",
            Population::Skewed => "numbers of skewness 1",
        }
    }

    /// Tests of one cell: skewed numbers alarm more often, and fewer of them tell.
    pub fn tests(self) -> u64 {
        match self {
            Population::Normal => 40_000,
            Population::Skewed => 5000,
        }
    }

    /// Two numbers, and the mean of their distribution.
    fn pair(self, stream: &mut Stream) -> ([f64; 2], f64) {
        let mut gamma = |k: u32| -ln((0..k).map(|_| stream.open_unit()).product());
        match self {
            Population::Normal => {
                // Box and Muller 1958.
                let radius = (2.0 * gamma(1)).sqrt();
                let (s, c) = sin_cos(std::f64::consts::TAU * stream.unit());
                ([radius * s, radius * c], 0.0)
            }
            Population::Skewed => ([gamma(4), gamma(4)], 4.0),
        }
    }
}

/// How many of so many tests alarm, by level.
pub fn alarms(population: Population, tests: u64, seed: u64, replicate: u64) -> [u64; LEVELS.len()] {
    let critical = LEVELS.map(|level| student_critical(level, VALUES - 1));
    let mut counts = [0; LEVELS.len()];
    for test in 0..tests {
        let mut stream = Stream::new(seed, Purpose::Synthetic, replicate, test);
        let (mut moments, mut truth) = (Moments::new(), 0.0);
        for _ in 0..VALUES / 2 {
            let (pair, mean) = population.pair(&mut stream);
            pair.into_iter().for_each(|x| moments.push(x));
            truth = mean;
        }
        let t = ((moments.mean() - truth) / moments.std_error()).abs();
        for (count, critical) in counts.iter_mut().zip(critical) {
            *count += u64::from(t > critical);
        }
    }
    counts
}
