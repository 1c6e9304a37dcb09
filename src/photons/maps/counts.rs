//! How many histories each map needs, and from where their photons leave.

use super::classes::{Class, Classes, Emitters};
use super::settings::{Amount, Emitted, MapSettings, MediumSamples, PILOT};
use crate::error::{Error, Result};
use crate::photons::importance::Importance;
use crate::photons::pass::is_diffuse;
use crate::photons::{BUILD_SECONDS, Pass, PeakBytes, Run, beams, check_end, planes};
use crate::rng::Purpose;
use crate::scene::Scene;
use crate::transport::{BLOCK, NoProgress};

/// Photons sent out for each that is to be stored, at most. Where fewer than 25 of a pilot's photons are stored, the part
/// of them that is stored is not known to a fifth: below that part, one in 400, more histories than these are not run
/// unless a number to emit is asked for.
pub const MOST_A_STORED: u64 = PILOT / 25;

/// What a pilot says of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Forecast {
    /// Histories for each map.
    pub emitted: Emitted,
    /// Photons that the global, the volume and the caustic map will hold, about, beams and planes among them.
    pub stored: [f64; 3],
    /// Most memory that each beam or plane of the volume map takes on its way there \[bytes\]; none for photons.
    pub bytes_each: Option<f64>,
    /// Time of emission, at the pilot's rate, and of building the trees, about \[s\].
    pub seconds: f64,
}

impl Forecast {
    /// Most memory that filling the maps takes, about, of one run or of several one after the other \[bytes\].
    pub fn bytes(&self, runs: u64) -> f64 {
        let peak = PeakBytes::of_maps(runs);
        let [global, volume, caustic] = self.stored;
        let of_media = self.bytes_each.map_or_else(|| peak.of(volume), |bytes| bytes * volume);
        peak.of(global) + peak.of(caustic) + of_media
    }

    /// The part of the photons that takes a part of that memory: no map takes more than its own.
    pub fn part_in(&self, part: f64, runs: u64) -> f64 {
        let peak = PeakBytes::of_maps(runs);
        let [global, volume, caustic] = self.stored;
        let volume = if self.bytes_each.is_some() { 0.0 } else { volume };
        [global, volume, caustic].into_iter().map(|photons| peak.part_in(part, photons)).fold(part, f64::min)
    }
}

/// Histories that each map needs, by a pilot where a number of stored photons is asked for.
///
/// # Errors
/// [`Error::OutOfRange`] for a number of 0; those of the pilot.
///
/// # Limits
/// none of the pilot's photons stored: as many histories as photons were asked for, and a map that may stay empty; few of
/// them: [`MOST_A_STORED`]
pub fn counts(scene: &Scene, settings: &MapSettings) -> Result<Emitted> {
    counts_by_importance(scene, settings, None)
}

/// The same with photons by importance.
///
/// # Errors
/// those of [`counts`]
pub fn counts_by_importance(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
) -> Result<Emitted> {
    Ok(piloted(scene, settings, importance, false)?.emitted)
}

/// What filling the maps will take, by a pilot of every pass.
///
/// # Errors
/// those of [`counts`]
pub fn forecast(scene: &Scene, settings: &MapSettings, importance: Option<&Importance>) -> Result<Forecast> {
    piloted(scene, settings, importance, true)
}

/// `has_all` whether there is a pilot where its numbers decide nothing, too.
fn piloted(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
    has_all: bool,
) -> Result<Forecast> {
    scene.check_emission()?;
    settings.media.check(scene)?;
    check_end(scene)?;
    let emitters = Emitters::of(scene, importance);
    let needs = Needs::of(scene, &emitters);
    let asked = [
        ("global", needs.global, settings.global),
        ("volume", needs.volume, settings.volume),
        ("caustic", needs.caustic, settings.caustic),
    ];
    for (name, is_needed, amount) in asked {
        if is_needed && matches!(amount, Amount::Emitted(0) | Amount::Stored(0)) {
            return Err(Error::out_of_range(
                format!("the number of photons of the {name} map"),
                0.0,
                "at least 1",
            ));
        }
    }
    let is_stored = |map: usize| matches!(asked[map].2, Amount::Stored(_));
    // Where nothing depends on the pilot it is as long as one of the blocks at most, and short beside the run.
    let length = |maps: &[usize]| {
        let most = |map: &usize| match asked[*map].2 {
            Amount::Emitted(number) => number.div_ceil(16).min(BLOCK),
            Amount::Stored(_) => PILOT,
        };
        let needed: Vec<usize> = maps.iter().copied().filter(|map| asked[*map].1).collect();
        let has_pilot = has_all || needed.iter().any(|map| is_stored(*map));
        if has_pilot { needed.iter().map(most).max().unwrap_or(0) } else { 0 }
    };
    let pilot = |class: Class, histories: u64| {
        let run = class.run(scene, &emitters, importance, settings, histories);
        let store = Classes { class, global: histories, volume: histories, media: settings.media };
        Run { purpose: Purpose::Pilot, is_pilot: true, ..run }.pass(&store, &NoProgress)
    };
    // Where there are more threads than blocks of the pilot, some of them wait.
    let a_history = |pass: &Pass, length: u64| {
        let threads = rayon::current_num_threads() as f64;
        let busy = threads.min(length.div_ceil(BLOCK) as f64) / threads;
        pass.report.time.as_secs_f64() * busy / length as f64
    };
    // Photons stored by the pilots, and seconds that a history takes.
    let (mut rates, mut seconds, mut bytes_each) = ([0.0; 3], [0.0; 2], None);
    let lengths = [length(&[0, 1]), length(&[2])];
    if lengths[0] > 0 {
        let pass = pilot(Class::Main(settings.indirect), lengths[0])?;
        let (of_beams, of_planes) = (pass.met_beams as f64, pass.met_planes as f64);
        rates[0] = pass.met[0] as f64;
        rates[1] = pass.met[1] as f64;
        if settings.media != MediumSamples::Points {
            rates[1] = of_beams + of_planes;
            let bytes = beams::PEAK_BYTES * of_beams + planes::PEAK_BYTES * of_planes;
            bytes_each = Some(if rates[1] > 0.0 { bytes / rates[1] } else { planes::PEAK_BYTES });
        }
        seconds[0] = a_history(&pass, lengths[0]);
    }
    if lengths[1] > 0 {
        let pass = pilot(Class::Caustic, lengths[1])?;
        rates[2] = pass.met[0] as f64;
        seconds[1] = a_history(&pass, lengths[1]);
    }
    let number = |map: usize| -> u64 {
        let (_, is_needed, amount) = asked[map];
        match amount {
            _ if !is_needed => 0,
            Amount::Emitted(number) => number,
            Amount::Stored(number) if rates[map] == 0.0 => number,
            Amount::Stored(number) => {
                let needed = (number as f64 * lengths[map / 2] as f64 / rates[map]).ceil() as u64;
                needed.min(number.saturating_mul(MOST_A_STORED))
            }
        }
    };
    let emitted = Emitted { global: number(0), volume: number(1), caustic: number(2) };
    let numbers = [emitted.global, emitted.volume, emitted.caustic];
    let stored = [0, 1, 2].map(|map| {
        let length = lengths[map / 2];
        if length == 0 { 0.0 } else { rates[map] / length as f64 * numbers[map] as f64 }
    });
    let main = emitted.global.max(emitted.volume) as f64;
    let threads = rayon::current_num_threads() as f64;
    let built = BUILD_SECONDS * stored.iter().sum::<f64>() / threads;
    let seconds = seconds[0] * main + seconds[1] * emitted.caustic as f64 + built;
    Ok(Forecast { emitted, stored, bytes_each, seconds })
}

/// Which maps a scene needs.
struct Needs {
    global: bool,
    caustic: bool,
    volume: bool,
}

impl Needs {
    fn of(scene: &Scene, emitters: &Emitters) -> Self {
        let plan = scene.plan();
        let is_diffuse = plan.has_surfaces && scene.objects().iter().any(|o| is_diffuse(&o.surface));
        Needs {
            global: is_diffuse || plan.is_full,
            caustic: (is_diffuse || plan.is_full) && emitters.caustic.is_some(),
            volume: plan.has_media,
        }
    }
}
