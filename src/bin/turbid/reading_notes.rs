//! What readings of sensors lack, and what their errors do not tell.

use super::notes::{PEAKED, peak};
use turbid::estimators::Estimator;
use turbid::estimators::boundary::Treatment;
use turbid::geometry::Shape;
use turbid::math::FOUR_PI;
use turbid::phase::PhaseFunction;
use turbid::photons::Ledger;
use turbid::scene::{Binned, Quantity, Scene};
use turbid::sensor::{Measurement, NoError, PhotonReadings, TELLS_TAIL};

fn reads_radiance(scene: &Scene) -> bool {
    scene.sensors().iter().any(|sensor| match &sensor.quantity {
        Quantity::Radiance(_) => true,
        Quantity::Binned(binned) => matches!(binned, Binned::Radiance { .. }),
        _ => false,
    })
}

/// Paths times what their medium scatters to the side, over the mean, below which a run may draw no path that turns towards a light. In a
/// cube of extinction 1.5 and side 2, with a sphere of radius 0.125 as its lamp at (-0.625, -0.625, 0.5), seen from (0.25, 0.125, 3) along
/// almost -z, means without a heavy tail were too small by factors of 5 and 20 at 7 (g = 0.999 and 0.9999) and 70
/// (0.9999), in one of three runs or more; at 70 (0.99) and from 370 (0.95) on none was.
const TURNING: f64 = 300.0;

/// What the errors of radiances do not tell where paths rarely turn.
pub fn note_of_rare_turns(scene: &Scene, paths: u64) -> Option<String> {
    let sides = scene.media().iter().filter(|medium| medium.is_colliding() && peak(medium) >= PEAKED);
    let sides = sides.map(|medium| FOUR_PI * medium.phase().eval(1.0, 1.0)).filter(|side| *side > 0.0);
    let least = sides.fold(f64::INFINITY, f64::min);
    (reads_radiance(scene) && paths as f64 * least < TURNING).then(|| {
        format!(
            "a medium scatters to the side {least:.1e} times the mean: radiances may hang on turns that none of {paths} paths took, and be too \
             small by any factor, whatever their errors say; --samples {:.0e} or more tells",
            TURNING / least
        )
    })
}

/// What the errors of radiances do not tell where phase functions are peaked and maps are few.
pub fn note_of_peaks(scene: &Scene, maps: u64) -> Option<String> {
    let highest = scene.media().iter().map(peak).fold(0.0, f64::max);
    (reads_radiance(scene) && highest >= PEAKED && (2..TELLS_TAIL).contains(&maps)).then(|| {
        format!(
            "a photon in the peak of a phase function brings {highest:.0} times the mean one: radiances may hang on few photons, and be wrong \
             by more than the errors of {maps} maps say; --maps {TELLS_TAIL} or more tells"
        )
    })
}

/// What estimates from maps lack.
pub fn notes_of_gathers(scene: &Scene, readings: &PhotonReadings, estimator: &Estimator) -> Vec<String> {
    let PhotonReadings { beyond, underfull, gathers, .. } = readings;
    let mut notes = Vec::new();
    let thinnest = scene.colliding_shapes().map(Shape::shortest_extent).fold(f64::INFINITY, f64::min);
    let radius = estimator.gather.cap();
    if estimator.treatment == Treatment::Reflection && estimator.gather.k().is_none() && radius > thinnest {
        notes.push(format!(
            "--boundary reflection takes images of photons, and no images of images: within {radius} L of a place in a medium {thinnest} L \
             across estimates may be far too small; --boundary clipped, or a smaller --radius"
        ));
    }
    if *beyond > 0 {
        notes.push(format!(
            "{beyond} of {gathers} balls reach beyond their medium, where no photons are: those estimates are biased low"
        ));
    }
    if *underfull > 0 {
        notes.push(format!(
            "{underfull} of {gathers} estimates found fewer than k photons within the cap of {radius} L, and used those"
        ));
    }
    notes
}

/// Where the power went.
pub fn ledger_note(ledger: &Ledger) -> String {
    let [absorbed, escaped, truncated] =
        [ledger.absorbed, ledger.escaped, ledger.truncated].map(|power| power / ledger.emitted);
    format!(
        "energy ledger: of the emitted power {absorbed:.6} was absorbed, {escaped:.6} escaped, {truncated:.6} was \
         followed no further; together {:.12}",
        absorbed + escaped + truncated
    )
}

/// Names the measurements without a standard error, a line for each reason; that there is one map, the table says.
pub fn without_error(measurements: &[Measurement]) -> Vec<String> {
    let why = |why: NoError| {
        let without = measurements.iter().filter(|r| r.no_error == Some(why));
        let mut names: Vec<String> = Vec::new();
        let mut bins = 0;
        for r in without {
            let name = format!("{} {}", r.sensor, r.quantity);
            bins += usize::from(r.bin.is_some());
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let bins = if bins > 0 { format!(" ({bins} bins)") } else { String::new() };
        (!names.is_empty()).then(|| {
            format!("no standard error, {}: {}: {}{bins}", why.word(), why.reason(), names.join(", "))
        })
    };
    [NoError::Nothing, NoError::TooFew, NoError::HeavyTail].into_iter().filter_map(why).collect()
}
