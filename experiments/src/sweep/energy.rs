//! Whether photons carry the power of the lights, and where it ends.

use super::measure::{BATCHES, Clock, Effort, Failure, PILOT, cost};
use turbid::Spectrum;
use turbid::error::Error;
use turbid::photons::Emitter;
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::stats::Moments;
use turbid::transport::{Roulette, Step, Visitor, Walker, walk};

/// Where emitted power went, by channel, over the power that lights should have.
#[derive(Debug, Clone, Default)]
pub struct Energy {
    /// Emitted over the power of the lights, less 1.
    pub emitted: [Moments; 3],
    /// Absorbed and escaped over the power of the lights, less the same of what was emitted.
    pub balance: [Moments; 3],
    /// Standard error of the power by channel, over it.
    pub power_error: Spectrum,
    /// Rays and look-ups of a history, on average.
    pub steps: f64,
}

/// Tallies one history.
struct Tally {
    ended: Spectrum,
    steps: f64,
}

impl Visitor for Tally {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, _walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Absorbed(weight, _) | Step::Escaped(weight) | Step::Truncated(weight) => {
                self.ended += weight
            }
            Step::Ahead(_) => self.steps += 1.0,
            Step::Uncollided(..) | Step::Collision(..) | Step::Surface(..) => {}
        }
    }
}

/// The energy of photon histories, by channel.
///
/// # Errors
/// [`Failure`]
pub fn energy(scene: &Scene, seed: u64, effort: &Effort) -> Result<Energy, Failure> {
    scene.check_emission()?;
    let (clock, emitter, power) = (Clock::of(effort), Emitter::by_power(scene), scene.power());
    let mut energy = Energy { power_error: scene.power_error(), ..Energy::default() };
    let one = |replicate: u64, history: u64| {
        let mut stream = Stream::new(seed, Purpose::Photons, replicate, history);
        let mut tally = Tally { ended: Spectrum::ZERO, steps: 0.0 };
        let Some(first) = emitter.emit(scene, &mut stream) else { return (Spectrum::ZERO, tally) };
        let weight = first.weight;
        walk(scene, first, Roulette::Analog, None, &mut stream, &mut tally);
        tally.steps += cost(&stream.work);
        (weight, tally)
    };
    const TRIALS: u64 = 256;
    for history in 0..TRIALS {
        clock.check()?;
        energy.steps += one(PILOT, history).1.steps / TRIALS as f64;
    }
    // A twentieth of what pictures take: nothing here is rare.
    let histories = (0.1 * effort.steps / (BATCHES as f64 * energy.steps.max(0.1))).clamp(16.0, 1e5) as u64;
    for replicate in 0..BATCHES as u64 {
        let (mut emitted, mut ended) = (Spectrum::ZERO, Spectrum::ZERO);
        for history in 0..histories {
            if history % 64 == 0 {
                clock.check()?;
            }
            let (weight, tally) = one(replicate, history);
            if !(weight.is_finite() && tally.ended.is_finite()) {
                return Err(Error::NonFinite { count: 1, place: "photon histories" }.into());
            }
            emitted += weight;
            ended += tally.ended;
        }
        let share = |x: f64, c: usize| if power[c] > 0.0 { x / (power[c] * histories as f64) } else { x };
        for c in 0..3 {
            let expected = if power[c] > 0.0 { 1.0 } else { 0.0 };
            energy.emitted[c].push(share(emitted[c], c) - expected);
            energy.balance[c].push(share(ended[c] - emitted[c], c));
        }
    }
    Ok(energy)
}
