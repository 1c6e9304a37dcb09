//! Maps that are seen directly, from numbers of photons sent out.

use turbid::photons::importance::Importance;
use turbid::photons::maps::{
    Amount, Emitted, Indirect, MapSettings, Maps, MediumSamples, fill_counted_by_importance,
};
use turbid::scene::Scene;
use turbid::transport::NoProgress;

/// Maps of so many photons, led by importance if there is one.
///
/// # Errors
/// those of filling
pub fn filled(
    scene: &Scene,
    emitted: Emitted,
    importance: Option<&Importance>,
    seed: u64,
    replicate: u64,
) -> anyhow::Result<Maps> {
    // Only a count that is still to be found would be read here.
    let [global, caustic, volume] = [emitted.global, emitted.caustic, emitted.volume].map(Amount::Emitted);
    let settings = MapSettings {
        global,
        caustic,
        volume,
        media: MediumSamples::Points,
        indirect: Indirect::Seen,
        seed,
        replicate,
    };
    Ok(fill_counted_by_importance(scene, &settings, emitted, importance, &NoProgress)?)
}
