//! The PNG files of a picture.

use super::beside::RivalPictures;
use super::compare::Replicate;
use super::develop::{Print, SOFT, develop, error_print, mask_print, tone};
use super::dots::dots;
use super::keep::{CachedRender, RenderRecord};
use super::pictures::Beside;
use super::shown::Plate;
use super::studio::Studio;
use crate::harness::duration;
use std::path::Path;
use turbid::Spectrum;
use turbid::output::{Tone, auto_exposure};

/// Ends of the scale of relative errors.
pub const SCALE: f64 = 0.2;
/// The brightest that a photon is drawn, in stops: single photons are seen as points of light.
const DOTS: f64 = -0.7;
/// The fewest photons of a map that is shown.
const FEWEST: usize = 1000;

/// Draws and writes them.
///
/// # Errors
/// those of files
pub fn plates(
    studio: &Studio,
    folder: &Path,
    ours: &CachedRender,
    others: Option<&RivalPictures>,
) -> anyhow::Result<Vec<Plate>> {
    let (picture, grid) = (studio.picture, studio.grid());
    let mut plates = Vec::new();
    let mut plate = |kind: &str, caption: String, print: &Print| -> anyhow::Result<()> {
        let file = format!("{}-{kind}.png", picture.name);
        print.write(&folder.join(&file))?;
        plates.push(Plate { file, caption, kind: kind.to_string() });
        Ok(())
    };
    let exposure = tone(picture.exposure);
    let exposed = |radiance: &[Spectrum]| develop(grid, radiance, exposure);
    let told = |method: &str, facts: &RenderRecord| {
        format!("{method}, {} samples per pixel, {} of CPU time", facts.samples, duration(facts.seconds))
    };
    plate("photons", told("Photon maps", &ours.facts), &exposed(&ours.total))?;
    if let Some(RivalPictures { equal, lines, reference, cost, masked, .. }) = others {
        for (stored, render) in lines {
            let facts = &render.facts;
            let caption = format!(
                "The light in the medium by {}: the mean over {} maps of {} each, {} of CPU time",
                stored.name(),
                facts.samples,
                facts.stored[2],
                duration(facts.seconds)
            );
            plate(stored.kind(), caption, &exposed(&render.total))?;
        }
        let (method, equal) = equal;
        let caption = told(&format!("The rival in the same time, {}", method.name()), &equal.facts);
        plate("rival", caption, &exposed(&equal.total))?;
        let by = picture.by_light.name();
        let caption =
            format!("The reference, by {by}: {} samples per pixel, {} of CPU time", cost.0, duration(cost.1));
        plate("reference", caption, &exposed(reference))?;
        let (half, ours, reference) = (grid.halved(), grid.reduced(&ours.total), grid.reduced(reference));
        let caption = format!(
            "Photon maps minus reference, over the reference, means of {0} by {0} pixels; what was masked is grey",
            2 * SOFT
        );
        plate("error", caption, &error_print(half, &ours, &reference, masked, SCALE))?;
        let caption = "Masked before the comparison, grey: blur or edges may cost more than 2 per cent there";
        plate("mask", caption.to_string(), &mask_print(half, &reference, masked, exposure))?;
    }
    match picture.beside {
        Beside::Single => {
            let single: Replicate = ours.layers.iter().map(|l| l.emission + l.direct + l.single).collect();
            plate("single", "Single scattering alone".to_string(), &exposed(&single))?;
        }
        Beside::Maps => {
            let maps = studio.maps(0, 1)?;
            let all = [("global", &maps.global), ("caustic", &maps.caustic), ("volume", &maps.volume)];
            for (name, map) in all {
                if let Some(map) = map.as_ref().filter(|map| map.stored() > FEWEST) {
                    let picture = dots(&studio.scene, &studio.camera, std::iter::once(map));
                    let stops = auto_exposure(picture.iter().copied()).min(DOTS);
                    let tone = Tone { exposure: stops, ..exposure };
                    let caption = format!("The {name} map: {} photons", map.stored());
                    plate(name, caption, &develop(grid, &picture, tone))?;
                }
            }
        }
    }
    Ok(plates)
}
