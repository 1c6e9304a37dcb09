//! What each method makes of a scene: batches of small pictures, each summed by layer, channel and quarter.
//!
//! How much is done is decided by counts of a pilot, rays and look-ups, so that results are a function of the seed; the clock
//! only stops what takes far longer than its counts say.

use crate::gallery::light::is_specular_ahead;
use cpu_time::ProcessTime;
use turbid::error::Error;
use turbid::integrators::{Layer, Layers, bidirectional, light_tracing, path};
use turbid::math::Ray;
use turbid::photons::Emitter;
use turbid::rng::{Purpose, Stream, Work};
use turbid::scene::{Camera, Scene};
use turbid::stats::{HEAVY_TAIL, Moments, Tail};
use turbid::transport::Progress;

/// Layers, channels and quarters.
pub const CELLS: usize = Layer::ALL.len() * 3 * 4;

/// Which numbers a cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// Class of light.
    pub layer: Layer,
    /// 0 red, 1 green, 2 blue.
    pub channel: usize,
    /// Quarter of the picture, row by row.
    pub quarter: usize,
}

impl Cell {
    /// The cell of a number.
    pub fn of(index: usize) -> Self {
        Cell { layer: Layer::ALL[index / 12], channel: index / 4 % 3, quarter: index % 4 }
    }

    /// In words.
    pub fn name(&self) -> String {
        let quarter = ["top left", "top right", "bottom left", "bottom right"][self.quarter];
        format!("{} {quarter}", self.whole_name())
    }

    /// The same of the whole picture.
    pub fn whole_name(&self) -> String {
        format!("{}.{}", self.layer.name(), ["r", "g", "b"][self.channel])
    }
}

/// Mean radiance over the pixels of each quarter, by layer and channel [W/(L^2 sr)].
pub type Batch = [f64; CELLS];

/// What a method made.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// Independent repetitions.
    pub batches: Vec<Batch>,
    /// The largest contributions of single paths or histories to each cell; none of photon maps.
    pub tails: Vec<Tail>,
    /// Over how many such contributions each quarter is a mean.
    pub samples: [f64; 4],
}

/// A mean over repetitions.
#[derive(Debug, Clone)]
pub struct Mean {
    /// Over the repetitions.
    pub moments: Moments,
    /// Whether its error is not known, by the repetitions or by the tail of what they are made of: what is rare and large may
    /// not have been drawn, and repetitions without it have small errors.
    pub is_heavy: bool,
    /// What one contribution would add to it that is as large as the largest of this layer and channel, in whichever quarter;
    /// 0 where none is known.
    pub largest: f64,
}

/// Whether nothing can be said of a mean whose contributions are not known: the variance of variance, above what normal numbers
/// have by their count, is larger than allowed for [`BATCHES`].
pub fn is_heavy(m: &Moments) -> bool {
    let normal = |n: f64| 2.0 / n;
    let excess = m.vov() - normal(m.n() as f64);
    excess.is_nan() || excess > HEAVY_TAIL - normal(BATCHES as f64)
}

/// Shape of a tail up to which means are compared. From 1/2 on the variance is infinite, and the error of a mean is of the
/// order of its largest contributions: comparisons count a multiple of the largest as unknown, so that what they then say is
/// right up to here (a test says so). That means are useful up to 0.7 is a finding of Vehtari et al. 2024.
const MOST_SHAPE: f64 = 0.7;

/// Whether nothing can be said of a mean: by the tail of its contributions, or where too few are known, by its repetitions.
fn is_unknown(moments: &Moments, tail: Option<&Tail>) -> bool {
    tail.and_then(Tail::shape).map_or_else(|| is_heavy(moments), |shape| shape > MOST_SHAPE)
}

impl Measured {
    /// So many repetitions to come, of paths or histories.
    pub(super) fn with_tails() -> Self {
        Measured { batches: Vec::new(), tails: vec![Tail::default(); CELLS], samples: [0.0; 4] }
    }

    /// The mean of a cell.
    pub fn mean(&self, cell: usize) -> Mean {
        let moments: Moments = self.batches.iter().map(|batch| batch[cell]).collect();
        let is_heavy = is_unknown(&moments, self.tails.get(cell));
        Mean { moments, is_heavy, largest: self.largest(cell) }
    }

    /// The mean of the whole picture in the layer and channel of a cell.
    pub fn whole(&self, cell: usize) -> Mean {
        let first = cell / 4 * 4;
        let all = |batch: &Batch| batch[first..first + 4].iter().sum::<f64>() / 4.0;
        let moments: Moments = self.batches.iter().map(all).collect();
        let mut tail = Tail::default();
        self.tails.iter().skip(first).take(4).for_each(|part| tail.merge(part));
        let largest = (first..first + 4).map(|cell| self.largest(cell)).fold(0.0, f64::max) / 4.0;
        Mean { is_heavy: is_unknown(&moments, Some(&tail)), moments, largest }
    }

    fn largest(&self, cell: usize) -> f64 {
        let quarters = self.tails.iter().skip(cell / 4 * 4).take(4);
        let largest = quarters.map(Tail::largest).fold(0.0, f64::max);
        if largest > 0.0 { largest / self.samples[cell % 4] } else { 0.0 }
    }

    /// The same with left and right exchanged.
    pub fn flipped(&self) -> Self {
        let flip = |batch: &Batch| std::array::from_fn(|cell| batch[cell ^ 1]);
        let tails = (0..self.tails.len()).map(|cell| self.tails[cell ^ 1].clone()).collect();
        let samples = std::array::from_fn(|quarter| self.samples[quarter ^ 1]);
        Measured { batches: self.batches.iter().map(flip).collect(), tails, samples }
    }

    /// Adds a repetition: sums over so many samples of each quarter.
    pub(super) fn push(&mut self, mut sums: Batch, counts: [f64; 4]) {
        for (cell, sum) in sums.iter_mut().enumerate() {
            *sum /= counts[cell % 4];
        }
        self.batches.push(sums);
        self.samples.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }

    /// Adds what one path or history brought to cells.
    pub(super) fn keep(&mut self, one: impl Iterator<Item = (usize, f64)>) {
        if self.tails.is_empty() {
            return;
        }
        for (cell, value) in one.filter(|(_, value)| *value > 0.0) {
            self.tails[cell].push(value);
        }
    }
}

/// Why a method made nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// It says in one line that it cannot.
    Refused(String),
    /// It failed.
    Broken(String),
    /// It took longer than it may.
    Late,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Cancelled => Failure::Late,
            Error::NonFinite { .. } => Failure::Broken(error.to_string()),
            Error::OutOfRange { .. } | Error::Scene(_) | Error::Unreachable(_) => {
                Failure::Refused(error.to_string())
            }
        }
    }
}

/// How much a method may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Rays and look-ups of each method.
    pub steps: f64,
    /// CPU seconds after which a method is stopped; never if none.
    pub seconds: Option<f64>,
    /// Factor on what paths make: 1, but in a negative control.
    pub control: f64,
}

impl Default for Effort {
    /// As much as nobody stops, and nothing wrong with it.
    fn default() -> Self {
        Effort { steps: 0.0, seconds: None, control: 1.0 }
    }
}

/// Independent repetitions of paths and of light tracing.
pub const BATCHES: usize = 64;

/// A clock that stops a method.
pub(super) struct Clock {
    until: Option<f64>,
}

impl Clock {
    pub fn of(effort: &Effort) -> Self {
        let now = ProcessTime::now().as_duration().as_secs_f64();
        Clock { until: effort.seconds.map(|s| now + s) }
    }

    pub fn check(&self) -> Result<(), Failure> {
        if self.is_cancelled() { Err(Failure::Late) } else { Ok(()) }
    }
}

impl Progress for Clock {
    fn advance(&self, _steps: u64) {}

    fn is_cancelled(&self) -> bool {
        self.until.is_some_and(|until| ProcessTime::now().as_duration().as_secs_f64() > until)
    }
}

/// Steps that work on media stands for: looking up is cheaper than a ray.
pub(super) fn cost(work: &Work) -> f64 {
    0.3 * (work.densities + work.majorants) as f64 + work.transmittances as f64
}

/// Where pixels are.
pub(super) struct Quarters<'a> {
    camera: &'a Camera,
    /// Pixels of each quarter.
    counts: [f64; 4],
}

impl<'a> Quarters<'a> {
    pub fn new(camera: &'a Camera) -> Self {
        let mut quarters = Quarters { camera, counts: [0.0; 4] };
        for pixel in 0..quarters.pixels() {
            let quarter = quarters.of(pixel);
            quarters.counts[quarter] += 1.0;
        }
        quarters
    }

    fn pixels(&self) -> usize {
        self.camera.width() as usize * self.camera.height() as usize
    }

    fn of(&self, pixel: usize) -> usize {
        let (width, height) = (self.camera.width() as usize, self.camera.height() as usize);
        usize::from(2 * (pixel % width) >= width) + 2 * usize::from(2 * (pixel / width) >= height)
    }

    fn add(&self, sums: &mut Batch, pixel: usize, layers: &Layers, factor: f64) {
        let quarter = self.of(pixel);
        for (cell, value) in cells_of(quarter, layers) {
            sums[cell] += value * factor;
        }
    }
}

/// The cells of a quarter that are not black.
fn cells_of(quarter: usize, layers: &Layers) -> impl Iterator<Item = (usize, f64)> {
    let lit = layers.iter().enumerate().filter(|(_, (_, value))| !value.is_black());
    lit.flat_map(move |(index, (_, value))| {
        (0..3).map(move |channel| (index * 12 + channel * 4 + quarter, value[channel]))
    })
}

/// A whole picture, and of it what is seen straight.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// All of it.
    pub all: Measured,
    /// Without directions in which a specular body is seen.
    pub straight: Measured,
    /// Whether the two differ.
    pub has_specular: bool,
}

impl Seen {
    /// The same with left and right exchanged.
    pub fn flipped(&self) -> Self {
        let (all, straight) = (self.all.flipped(), self.straight.flipped());
        Seen { all, straight, has_specular: self.has_specular }
    }
}

impl From<Measured> for Seen {
    /// What light tracing made, which finds nothing by specular bodies.
    fn from(all: Measured) -> Self {
        Seen { all, ..Seen::default() }
    }
}

/// Steps that a sample itself stands for: its place, its random numbers and its sums.
const SAMPLE: f64 = 1.0;

/// One sample of a pixel, and what it took.
pub(super) type Sample<'a> = dyn Fn(Ray, &mut Stream) -> (Layers, f64) + 'a;

/// How many samples a batch takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spread {
    /// Of each pixel that has any.
    pub samples: u64,
    /// One pixel in so many has some, other ones in each batch: all have had as many after as many batches.
    pub stride: u64,
}

/// The most that a batch may leave out: a quarter has pixels of every batch, and 16 batches have all of them.
pub(super) const MOST_STRIDE: u64 = 8;

impl Spread {
    /// About so many samples per pixel.
    pub fn of(samples: f64) -> Self {
        let samples = samples.clamp(1.0 / MOST_STRIDE as f64, 4096.0);
        let stride = (1.0 / samples).floor().max(1.0) as u64;
        // Powers of two divide the numbers of batches.
        Spread { samples: samples.max(1.0) as u64, stride: 1 << stride.ilog2() }
    }

    fn has(&self, x: u32, y: u32, replicate: u64) -> bool {
        (u64::from(x) + 5 * u64::from(y) + replicate).is_multiple_of(self.stride)
    }
}

/// One batch of samples; returns the steps they took.
pub(super) fn batch(
    (scene, quarters): (&Scene, &Quarters),
    (seed, replicate): (u64, u64),
    spread: Spread,
    clock: &Clock,
    sample: &Sample,
    seen: &mut Seen,
) -> Result<f64, Failure> {
    let (mut all, mut straight, mut steps) = ([0.0; CELLS], [0.0; CELLS], 0.0);
    let (camera, mut counts) = (quarters.camera, [0.0; 4]);
    for pixel in 0..quarters.pixels() {
        let (x, y) = (pixel as u32 % camera.width(), pixel as u32 / camera.width());
        if !spread.has(x, y, replicate) {
            continue;
        }
        clock.check()?;
        counts[quarters.of(pixel)] += spread.samples as f64;
        for i in 0..spread.samples {
            let mut stream = Stream::new(seed, Purpose::Paths, replicate, (pixel as u64) << 32 | i);
            let ray = camera.sample(x, y, stream.pair());
            let (layers, took) = sample(ray, &mut stream);
            if !layers.is_finite() {
                return Err(Error::NonFinite { count: 1, place: "samples of a picture" }.into());
            }
            steps += SAMPLE + took;
            let quarter = quarters.of(pixel);
            quarters.add(&mut all, pixel, &layers, 1.0);
            seen.all.keep(cells_of(quarter, &layers));
            if is_specular_ahead(scene, &ray) {
                seen.has_specular = true;
            } else {
                quarters.add(&mut straight, pixel, &layers, 1.0);
                seen.straight.keep(cells_of(quarter, &layers));
            }
        }
    }
    for (measured, sums) in [(&mut seen.all, all), (&mut seen.straight, straight)] {
        measured.push(sums, counts);
    }
    Ok(steps)
}

/// Replicates of pilots.
pub(super) const PILOT: u64 = 1 << 48;

/// Paths.
///
/// # Errors
/// [`Failure`]
pub fn paths(scene: &Scene, camera: &Camera, seed: u64, effort: &Effort) -> Result<Seen, Failure> {
    let (clock, quarters) = (Clock::of(effort), Quarters::new(camera));
    let within = scene.interior_at(camera.position());
    let sample = |ray: Ray, stream: &mut Stream| {
        let (layers, rays) = path::layers(scene, ray, None, within, stream);
        (layers * effort.control, rays.total() as f64 + cost(&stream.work))
    };
    let on = (scene, &quarters);
    in_batches(on, seed, effort.steps, &clock, &sample)
}

/// Bidirectional paths.
///
/// # Errors
/// [`Failure`]
pub fn connected(scene: &Scene, camera: &Camera, seed: u64, effort: &Effort) -> Result<Seen, Failure> {
    let (clock, quarters) = (Clock::of(effort), Quarters::new(camera));
    let within = scene.interior_at(camera.position());
    // Other streams than those of paths, whose light of order 1 would be the same.
    let seed = seed ^ (1 << 41);
    let sample = |ray: Ray, stream: &mut Stream| {
        let (layers, rays) = bidirectional::layers(scene, ray, None, within, stream);
        (layers, rays.total() as f64 + cost(&stream.work))
    };
    in_batches((scene, &quarters), seed, effort.steps, &clock, &sample)
}

/// As many samples as a pilot says take so many steps.
pub(super) fn in_batches(
    on: (&Scene, &Quarters),
    seed: u64,
    steps: f64,
    clock: &Clock,
    sample: &Sample,
) -> Result<Seen, Failure> {
    let each = batch(on, (seed, PILOT), Spread::of(1.0), clock, sample, &mut Seen::default())?;
    let spread = Spread::of(steps / (BATCHES as f64 * each.max(1.0)));
    let mut seen =
        Seen { all: Measured::with_tails(), straight: Measured::with_tails(), has_specular: false };
    for replicate in 0..BATCHES as u64 {
        batch(on, (seed, replicate), spread, clock, sample, &mut seen)?;
    }
    Ok(seen)
}

/// Light tracing; emission and what is seen by specular bodies are not in it.
///
/// # Errors
/// [`Failure`]
pub fn light(scene: &Scene, camera: &Camera, seed: u64, effort: &Effort) -> Result<Measured, Failure> {
    scene.check_emission()?;
    let (clock, quarters) = (Clock::of(effort), Quarters::new(camera));
    let emitter = Emitter::by_power(scene);
    let one = |replicate: u64, history: u64, sums: &mut Batch| {
        let mut stream = Stream::new(seed, Purpose::LightTracing, replicate, history);
        let mut is_finite = true;
        let rays = light_tracing(scene, camera, &emitter, &mut stream, |splat| {
            is_finite &= splat.value.is_finite();
            if is_specular_ahead(scene, &camera.ray(splat.at)) {
                return;
            }
            let mut layers = Layers::ZERO;
            layers[splat.layer] = splat.value;
            for (pixel, density) in camera.pixels(splat.at) {
                quarters.add(sums, pixel, &layers, density);
            }
        });
        is_finite.then_some(rays.total() as f64 + cost(&stream.work))
    };
    let broken = || Failure::from(Error::NonFinite { count: 1, place: "light tracing" });
    const TRIALS: u64 = 256;
    let mut steps = 0.0;
    for history in 0..TRIALS {
        clock.check()?;
        steps += one(PILOT, history, &mut [0.0; CELLS]).ok_or_else(broken)?;
    }
    let each = (steps / TRIALS as f64).max(0.1);
    let histories = (effort.steps / (BATCHES as f64 * each)).clamp(16.0, 1e6) as u64;
    let mut measured = Measured::with_tails();
    for replicate in 0..BATCHES as u64 {
        let mut sums = [0.0; CELLS];
        for history in 0..histories {
            if history % 64 == 0 {
                clock.check()?;
            }
            let mut brought = [0.0; CELLS];
            one(replicate, history, &mut brought).ok_or_else(broken)?;
            measured.keep(brought.iter().copied().enumerate());
            sums.iter_mut().zip(brought).for_each(|(sum, value)| *sum += value);
        }
        measured.push(sums, quarters.counts.map(|pixels| pixels * histories as f64));
    }
    Ok(measured)
}
