//! How many histories each map needs, and from where their photons leave.

use super::pass::{Class, Run};
use super::{Amount, Emitted, MapSettings, PILOT, is_matt};
use crate::error::{Error, Result};
use crate::photons::importance::Importance;
use crate::photons::{Emitter, check_end};
use crate::rng::Purpose;
use crate::scene::Scene;
use crate::transport::NoProgress;

/// Histories that each map needs, by a pilot where a number of stored photons is asked for.
///
/// # Errors
/// [`Error::OutOfRange`] for a number of 0; those of the pilot.
///
/// # Limits
/// none of the pilot's photons stored: as many histories as photons were asked for, and a map that may stay empty
pub fn counts(scene: &Scene, settings: &MapSettings) -> Result<Emitted> {
    counts_steered(scene, settings, None)
}

/// The same with photons steered by importance.
///
/// # Errors
/// those of [`counts`]
pub fn counts_steered(
    scene: &Scene,
    settings: &MapSettings,
    importance: Option<&Importance>,
) -> Result<Emitted> {
    scene.check_emission()?;
    check_end(scene)?;
    let emitters = Emitters::of(scene, importance);
    let needs = Needs::of(scene, &emitters);
    let asked = [
        ("global", needs.global, settings.global),
        ("volume", needs.volume, settings.volume),
        ("caustic", needs.caustic, settings.caustic),
    ];
    let is_stored = |amount| matches!(amount, Amount::Stored(_));
    let pilot = |class: Class| {
        let run = Run {
            scene,
            emitter: emitters.of_class(class),
            importance: importance.filter(|_| class != Class::Caustic),
            purpose: Purpose::Pilot,
            seed: settings.seed,
            replicate: settings.replicate,
            class,
            global: PILOT,
            volume: PILOT,
        };
        run.pass(PILOT, &NoProgress)
    };
    let is_piloted = |map: usize| asked[map].1 && is_stored(asked[map].2);
    let mut stored = [0; 3];
    if is_piloted(0) || is_piloted(1) {
        let pass = pilot(Class::Main(settings.indirect))?;
        (stored[0], stored[1]) = (pass.surface(), pass.medium());
    }
    if is_piloted(2) {
        stored[2] = pilot(Class::Caustic)?.surface();
    }
    let number = |map: usize| -> Result<u64> {
        let (name, is_needed, amount) = asked[map];
        match amount {
            _ if !is_needed => Ok(0),
            Amount::Emitted(0) | Amount::Stored(0) => Err(Error::out_of_range(
                format!("the number of photons of the {name} map"),
                0.0,
                "at least 1",
            )),
            Amount::Emitted(number) => Ok(number),
            Amount::Stored(number) if stored[map] == 0 => Ok(number),
            Amount::Stored(number) => Ok((number as f64 * PILOT as f64 / stored[map] as f64).ceil() as u64),
        }
    };
    Ok(Emitted { global: number(0)?, volume: number(1)?, caustic: number(2)? })
}

/// Which maps a scene needs.
struct Needs {
    global: bool,
    caustic: bool,
    volume: bool,
}

/// How photons of each pass leave the lights.
pub(super) struct Emitters {
    pub main: Emitter,
    /// Those that can meet a specular body; none if none can.
    pub caustic: Option<Emitter>,
}

impl Emitters {
    pub fn of(scene: &Scene, importance: Option<&Importance>) -> Self {
        let main = importance.map_or_else(|| Emitter::by_power(scene), |i| i.emitter().clone());
        Emitters { main, caustic: Emitter::towards_specular(scene) }
    }

    pub fn of_class(&self, class: Class) -> &Emitter {
        self.caustic.as_ref().filter(|_| class == Class::Caustic).unwrap_or(&self.main)
    }
}

impl Needs {
    fn of(scene: &Scene, emitters: &Emitters) -> Self {
        let plan = scene.plan();
        let is_matt = plan.has_surfaces && scene.objects().iter().any(|o| is_matt(&o.surface));
        Needs {
            global: is_matt || plan.is_full,
            caustic: (is_matt || plan.is_full) && emitters.caustic.is_some(),
            volume: plan.has_media,
        }
    }
}
