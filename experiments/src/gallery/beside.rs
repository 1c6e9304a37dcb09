//! What stands beside the photon mapper's picture: the best picture without photon maps in the same time, the reference, and the comparison with it.
//!
//! The reference and what is shown are of full size. For the comparison the photon mapper makes the picture again with 64
//! sets of maps on half the width and height, a sample a pixel: means over blocks need no small pixels, and their error
//! comes from the maps. The reference's passes are averaged over two by two pixels to fit.

use super::cache::Cache;
use super::compare::{FEWEST, Replicate, compare, errors, rms_of_one, spread};
use super::keep::CachedRender;
use super::light::ByLight;
use super::lines::Stored;
use super::look::look;
use super::predict::{Radii, Spreads, predicted, radius};
use super::recipe::readout;
use super::shown::Compared;
use super::studio::Studio;
use crate::harness::say;
use turbid::Spectrum;
use turbid::integrators::Layer;
use turbid::photons::Emitter;
use turbid::stats::Interval;

/// Predicted relative error above which a pixel is masked.
const LIMIT: f64 = 0.02;
/// Standard error of a block's mean that the reference is given samples for: a third of what would be masked.
const WANTED: f64 = LIMIT / 3.0;
/// The most photons that are emitted for a replicate from which blur is predicted, and how many times the original's at most.
const FINE: (u64, u64) = (8_000_000, 8);
/// Samples a pixel of such a replicate.
const FINE_SAMPLES: u64 = 8;
/// Replicates of either side that are compared.
const COMPARED: u64 = FEWEST as u64;
/// Passes of a sample a pixel by which the reference's samples are chosen.
const PILOT: u64 = 8;
/// Numbers of the first repetition of the reference's passes, and of the pilot's: no random numbers are used twice.
pub(super) const FIRST: (u64, u64) = (1000, 2000);

/// What stands beside the photon mapper's picture.
pub struct RivalPictures {
    /// The picture without photon maps in the same time that has the smaller error, and how it was made.
    pub equal: (ByLight, CachedRender),
    /// The picture with its medium read along whole rays in the same time.
    pub lines: Vec<(Stored, CachedRender)>,
    /// The reference, its samples per pixel and its CPU seconds.
    pub reference: Replicate,
    /// Samples a pixel of the reference, and its CPU seconds.
    pub cost: (u64, f64),
    /// Which pixels of the half-size grid were masked.
    pub masked: Vec<bool>,
    /// The comparison.
    pub compared: Compared,
    /// CPU seconds of all this.
    pub seconds: f64,
}

/// Makes and compares all that stands beside `ours`.
///
/// # Arguments   `large` cached renders in the size that is shown; `small` in half of it
///
/// # Errors
/// those of rendering and of files
pub fn beside(large: &Cache, small: &Cache, ours: &CachedRender) -> anyhow::Result<RivalPictures> {
    let picture = large.studio.picture;
    let raced = rivals(large.studio)
        .into_iter()
        .enumerate()
        .map(|(n, method)| Ok((method, large.rival(&format!("equal-{n}"), method, ours.facts.seconds)?)))
        .collect::<anyhow::Result<Vec<(ByLight, CachedRender)>>>()?;
    let lines = Stored::of(picture)
        .map(|of| Ok((of.1, large.lines(of, &ours.facts)?)))
        .collect::<anyhow::Result<Vec<(Stored, CachedRender)>>>()?;
    // Before anything that is compared is made.
    let (prediction, mut seconds) = predict(small, ours)?;
    let masked: Vec<bool> = prediction.iter().map(|&e| e > LIMIT).collect();
    let share = masked.iter().filter(|&&is_masked| is_masked).count() as f64 / masked.len() as f64;
    say(&format!("{}: blur and edges may matter in {:.1} % of the pixels", picture.name, 100.0 * share));
    let shown: Vec<&CachedRender> = [ours]
        .into_iter()
        .chain(raced.iter().map(|(_, render)| render))
        .chain(lines.iter().map(|(_, render)| render))
        .collect();
    let most = shown.iter().map(|render| render.facts.samples).max().unwrap_or(0);
    let samples = enough(chosen(large, &masked)?, most, picture.reference);
    say(&format!("{}: {COMPARED} passes of {samples} samples per pixel for the reference", picture.name));
    let reference = reference(large, samples, &shown)?;
    let again = (0..COMPARED)
        .map(|n| {
            let kept = small.photons(&format!("maps-{n:03}"), 1, 1 + n)?;
            seconds += kept.facts.seconds;
            Ok(kept.scattered())
        })
        .collect::<anyhow::Result<Vec<Replicate>>>()?;
    let comparison = compare(small.studio.grid(), &again, &reference.passes, &prediction, LIMIT);
    let found = errors(small.studio.grid(), &again, &reference.passes);
    seconds += reference.seconds + shown[1..].iter().map(|render| render.facts.seconds).sum::<f64>();
    let rms = reference.rms[0];
    let (of_rivals, of_lines) = reference.rms[1..].split_at(raced.len());
    let along: Vec<(&str, Interval)> =
        lines.iter().zip(of_lines).map(|((stored, _), rms)| (stored.name(), *rms)).collect();
    let mut raced: Vec<_> = raced.into_iter().zip(of_rivals).collect();
    raced.sort_by(|(_, a), (_, b)| (a.low + a.high).total_cmp(&(b.low + b.high)));
    let errors: Vec<(&str, Interval)> =
        raced.iter().map(|((method, _), rms)| (method.name(), **rms)).collect();
    let compared = Compared::new(&comparison, &found, again.len(), rms, &errors, &along);
    let (equal, _) = raced.swap_remove(0);
    Ok(RivalPictures {
        equal,
        lines,
        reference: reference.shown,
        cost: (samples * COMPARED, reference.seconds),
        masked,
        compared,
        seconds,
    })
}

/// The methods without photon maps that race against a picture by photons: paths, what the reference is made with, light
/// tracing of caustics where there may be some, and of all that scatters where the scene permits it; and guided paths where there may be
/// caustics: elsewhere in these scenes photons know no better directions, and they would be paths.
pub(super) fn rivals(studio: &Studio) -> Vec<ByLight> {
    let mut methods: Vec<ByLight> = Vec::new();
    let has_caustics = Emitter::towards_specular(&studio.scene).is_some();
    let one_of = |method| if has_caustics { method } else { ByLight::NOTHING };
    let (caustics, guided) = (one_of(ByLight::CAUSTICS), one_of(ByLight::GUIDED));
    for method in [ByLight::NOTHING, studio.picture.by_light, caustics, ByLight::ALL, guided] {
        let is_new = methods.iter().all(|other| (other.layers, other.guide) != (method.layers, method.guide));
        if is_new && method.check(&studio.scene, &studio.camera).is_ok() {
            methods.push(method);
        }
    }
    methods
}

/// Samples a pixel of a pass of the reference: those wanted, within the budget of the recipe, but in all passes together more than
/// any picture beside it has.
fn enough(wanted: u64, shown: u64, budget: u64) -> u64 {
    wanted.min(budget).max(shown / COMPARED + 1)
}

/// Samples a pixel of a pass of the reference that the comparison needs: nine in ten of the blocks that are not masked are to have the
/// standard error that is wanted.
fn chosen(large: &Cache, masked: &[bool]) -> anyhow::Result<u64> {
    let (grid, by_light) = (large.studio.grid(), large.studio.picture.by_light);
    let passes = (0..PILOT)
        .map(|n| {
            Ok(grid.reduced(&large.reference(&format!("pilot-{n}"), by_light, 1, FIRST.1 + n)?.scattered()))
        })
        .collect::<anyhow::Result<Vec<Replicate>>>()?;
    let one = spread(grid.halved(), &passes, masked);
    let samples = (one / WANTED) * (one / WANTED) / COMPARED as f64;
    Ok(samples.ceil() as u64)
}

/// The passes of the reference.
struct Reference {
    /// Without light that is seen directly, on the half-size grid.
    passes: Vec<Replicate>,
    /// The picture with that light, in the size that is shown.
    shown: Replicate,
    /// Errors of the pictures beside it.
    rms: Vec<Interval>,
    seconds: f64,
}

fn reference(large: &Cache, samples: u64, pictures: &[&CachedRender]) -> anyhow::Result<Reference> {
    let (grid, by_light) = (large.studio.grid(), large.studio.picture.by_light);
    let (mut passes, mut seconds) = (Vec::new(), 0.0);
    let mut shown = vec![Spectrum::ZERO; grid.pixels()];
    for n in 0..COMPARED {
        let kept = large.reference(&format!("reference-{n:03}"), by_light, samples, FIRST.0 + n)?;
        seconds += kept.facts.seconds;
        shown.iter_mut().zip(&kept.total).for_each(|(sum, x)| *sum += *x * (1.0 / COMPARED as f64));
        passes.push(kept.scattered());
    }
    let rms = pictures.iter().map(|picture| rms_of_one(&picture.scattered(), &passes)).collect();
    let passes = passes.iter().map(|pass| grid.reduced(pass)).collect();
    Ok(Reference { passes, shown, rms, seconds })
}

/// The relative error that blur and edges may cause, by pixel, and the CPU seconds of knowing it.
fn predict(small: &Cache, ours: &CachedRender) -> anyhow::Result<(Vec<f64>, f64)> {
    let (studio, picture) = (small.studio, small.studio.picture);
    let emitted = ours.facts.emitted;
    let factor = (FINE.0 / emitted[0].max(emitted[1]).max(1)).clamp(2, FINE.1);
    let fine = |n: u64| small.photons_by_class(&format!("fine-{n}"), FINE_SAMPLES, 1 + COMPARED + n, factor);
    let (one, other) = (fine(0)?, fine(1)?);
    let power = studio.scene.power().sum();
    let [_, _, volume] = ours.facts.radii;
    let radii: Vec<Radii> = one
        .layers
        .iter()
        .zip(&other.layers)
        .map(|(a, b)| {
            let mean = |layer: Layer| (a[layer] + b[layer]) * 0.5;
            let reach = |map: usize, radiance: Spectrum| {
                let each = power / emitted[map].max(1) as f64;
                radius(picture.nearest[map], each, radiance.sum(), picture.reach)
            };
            let seen = if picture.gather == 0 { reach(0, mean(Layer::Indirect)) } else { 0.0 };
            let caustic = if emitted[1] > 0 { reach(1, mean(Layer::Caustic)) } else { 0.0 };
            Radii { global: seen, caustic, volume }
        })
        .collect();
    let views = look(&studio.scene, &studio.camera);
    let pixel = studio.camera.pixel_area().sqrt();
    let seconds = one.facts.seconds + other.facts.seconds;
    let spreads = Spreads::of(&readout(picture, 1)?);
    Ok((predicted(studio.grid(), &views, [&one.layers, &other.layers], &radii, spreads, pixel), seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 64 passes of 5 are 320 samples: enough for 319, not for 320.
    #[test]
    fn the_reference_has_more_samples_than_what_stands_beside_it() {
        assert_eq!(
            [enough(2, 319, 5), enough(4, 100, 5), enough(9, 100, 5), enough(2, 320, 5)],
            [5, 4, 5, 6]
        );
    }

    /// Light is traced where no specular surface is seen through a medium, and no method races twice.
    #[test]
    fn every_method_that_the_scene_permits_races() {
        let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        for picture in super::super::pictures::ALL {
            let studio = Studio::open(picture, &scenes, 0.1, 1, "").unwrap();
            let names: Vec<&str> = rivals(&studio).iter().map(ByLight::name).collect();
            assert!(names.len() > 1 && names[0] == "paths", "{}: {names:?}", picture.name);
            let own = names.iter().filter(|name| **name == picture.by_light.name()).count();
            assert_eq!(own, 1, "{}: {names:?}", picture.name);
        }
    }
}
