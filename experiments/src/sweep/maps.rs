//! What the photon mapper makes of a scene, with few photons and with many.

use super::measure::{
    Clock, Effort, Failure, MOST_STRIDE, PILOT, Quarters, Seen, Spread, batch, cost, in_batches,
};
use std::cell::Cell;
use turbid::estimators::Gather;
use turbid::integrators::mapper::{Gathers, Mapper, Report, Settings, scene_size};
use turbid::integrators::{Layer, Layers};
use turbid::math::{Positive, Ray};
use turbid::medium::Medium;
use turbid::photons::PhotonMap;
use turbid::photons::maps::{
    Amount, Emitted, Indirect, MapSettings, Maps, MediumSamples, counts, fill_counted,
};
use turbid::rng::Stream;
use turbid::scene::{Camera, Scene};

/// Maps of few photons.
pub const SMALL_MAPS: usize = 32;
/// Maps of eight times the photons: Student's t with 15 degrees of freedom.
pub const LARGE_MAPS: usize = 16;
/// Photons of the large maps over those of the small ones.
pub const FACTOR: u64 = 8;
/// Histories of a large map at most: as many photons as the command stores by default, about.
const MOST_HISTORIES: f64 = 100_000.0;
/// Replicates of maps, which must not share random numbers with paths.
const MAPS: u64 = 1 << 32;

/// The photon mapper.
#[derive(Debug, Clone, Default)]
pub struct ByMaps {
    /// Its rays alone: emission, direct light and single scattering, which read no map.
    pub rays: Seen,
    /// With few photons.
    pub small: Seen,
    /// With [`FACTOR`] times as many.
    pub large: Seen,
    /// Layers whose radius does not fall with the number of photons as it does where they are many: an estimate takes a good
    /// part of all of them, wherever they are, or is measured to keep its radius.
    pub scarce: Vec<Layer>,
}

/// Fewest photons of a small map, over those of an estimate.
const FEWEST_OVER_NEAREST: u64 = 4;

/// Gathering rays of a sample, and steps of a march in homogeneous media over the command's: any number has the same mean.
const RAYS: u32 = 4;
const LONGER: f64 = 4.0;
/// Photons of an estimate, the command's default.
const NEAREST: usize = 100;
/// Steps that a look-up in a map takes as long as.
const LOOK_UP: f64 = 15.0;

/// The photon mapper as the command runs it, with few photons and many.
///
/// Both take the `NEAREST` photons. The small maps may look for them farther, in the same ratio as a full estimate does,
/// so that radii shrink from one to the other where photons are scarce too; the large ones look as far as the command does.
///
/// # Arguments    `each` steps of one history
/// # Errors       [`Failure`]
pub fn maps(
    scene: &Scene,
    camera: &Camera,
    seed: u64,
    effort: &Effort,
    each: f64,
) -> Result<ByMaps, Failure> {
    let (clock, quarters) = (Clock::of(effort), Quarters::new(camera));
    let within = scene.interior_at(camera.position());
    let on = (scene, &quarters);
    let look_ups = Cell::new(Report::default());
    let looked = |mapper: &Mapper, ray: Ray, stream: &mut Stream| {
        let (layers, report): (Layers, Report) = mapper.radiance(ray, None, within, stream);
        let mut all = look_ups.take();
        all += report;
        look_ups.set(all);
        let looked = report.global.count + report.caustic.count + report.volume.count;
        (layers, report.rays.total() as f64 + cost(&stream.work) + LOOK_UP * looked as f64)
    };
    let mut made = ByMaps::default();
    let nothing = Maps::none(Indirect::Gathered);
    let plain = settings(scene, true)?;
    let mapper = Mapper::new(scene, &nothing, &plain);
    let sample = |ray: Ray, stream: &mut Stream| looked(&mapper, ray, stream);
    made.rays = in_batches(on, seed ^ MAPS, 0.25 * effort.steps, &clock, &sample)?;
    // A third each for photons and for reading the large maps, a sixth for reading the small ones.
    let third = effort.steps / 3.0;
    let histories = (third / (LARGE_MAPS as f64 * each.max(0.1))).clamp(1000.0, MOST_HISTORIES) as u64;
    let mut of_large = Report::default();
    for (is_large, number) in [(true, LARGE_MAPS), (false, SMALL_MAPS)] {
        let count = if is_large { histories } else { (histories / FACTOR).max(1) };
        let settings = settings(scene, is_large)?;
        let seen = if is_large { &mut made.large } else { &mut made.small };
        let first = if is_large { 2 * MAPS } else { MAPS };
        let amount = Amount::Emitted(count);
        let (indirect, mut spread) = (Indirect::Gathered, None);
        let of_maps = MapSettings {
            global: amount,
            caustic: amount,
            volume: amount,
            media: MediumSamples::Points,
            indirect,
            seed,
            replicate: first,
        };
        let emitted: Emitted = counts(scene, &of_maps)?;
        for replicate in first..first + number as u64 {
            let of_map = MapSettings { replicate, ..of_maps };
            let maps = fill_counted(scene, &of_map, emitted, &clock)?;
            if !is_large && replicate == first {
                made.scarce = scarce(&maps);
            }
            let mapper = Mapper::new(scene, &maps, &settings);
            let sample = |ray: Ray, stream: &mut Stream| looked(&mapper, ray, stream);
            let spread = match spread {
                Some(spread) => spread,
                None => {
                    let few = Spread { samples: 1, stride: MOST_STRIDE };
                    let each = batch(on, (seed, PILOT), few, &clock, &sample, &mut Seen::default())?;
                    let budget = if is_large { third } else { 0.5 * third };
                    let chosen = Spread::of(budget / (number as f64 * MOST_STRIDE as f64 * each.max(1.0)));
                    *spread.insert(chosen)
                }
            };
            batch(on, (seed, replicate), spread, &clock, &sample, seen)?;
        }
        if is_large {
            of_large = look_ups.take();
        }
    }
    made.scarce.extend(not_shrinking(&of_large, &look_ups.take()));
    Ok(made)
}

/// The layers of maps that have too few photons.
fn scarce(maps: &Maps) -> Vec<Layer> {
    let is_scarce = |map: &Option<PhotonMap>| {
        let stored = map.as_ref().map_or(0, PhotonMap::stored) as u64;
        map.is_some() && stored < FEWEST_OVER_NEAREST * NEAREST as u64
    };
    let layers =
        [(&maps.global, Layer::Indirect), (&maps.caustic, Layer::Caustic), (&maps.volume, Layer::Multiple)];
    layers.into_iter().filter(|(map, _)| is_scarce(map)).map(|(_, layer)| layer).collect()
}

/// Mean radii of large maps over those of small ones, relative to what the numbers of photons let expect, above which the law of
/// [`shrinking`](super::compare::shrinking) says nothing: bodies that end, or darkness about the light, keep the radius.
const KEPT: f64 = 1.5;

/// The layers of maps whose radius hardly falls with the number of their photons.
fn not_shrinking(large: &Report, small: &Report) -> Vec<Layer> {
    let factor = FACTOR as f64;
    let is_kept = |large: &Gathers, small: &Gathers, ratio: f64| {
        large.mean_radius() > KEPT * ratio * small.mean_radius()
    };
    let layers = [
        (&large.global, &small.global, 1.0 / libm::sqrt(factor), Layer::Indirect),
        (&large.caustic, &small.caustic, 1.0 / libm::sqrt(factor), Layer::Caustic),
        (&large.volume, &small.volume, 1.0 / libm::cbrt(factor), Layer::Multiple),
    ];
    layers.into_iter().filter(|(l, s, ratio, _)| is_kept(l, s, *ratio)).map(|(.., layer)| layer).collect()
}

/// How the command reads maps by default, with fewer gathering rays, and longer steps where they may be long.
fn settings(scene: &Scene, is_large: bool) -> Result<Settings, Failure> {
    let mut settings = Settings::for_scene(scene, NEAREST)?;
    settings.gather_rays = RAYS;
    if scene.media().iter().all(Medium::is_homogeneous) {
        settings.march.step = Positive::new("the step", settings.march.step.get() * LONGER)?;
    }
    if !is_large {
        let reach = 0.1 * scene_size(scene);
        let nearest = |factor: f64| Gather::nearest(NEAREST, reach * factor);
        let (on_surfaces, in_media) =
            (nearest(libm::sqrt(FACTOR as f64))?, nearest(libm::cbrt(FACTOR as f64))?);
        settings.global.1 = on_surfaces;
        settings.caustic.1 = on_surfaces;
        settings.volume.gather = in_media;
    }
    Ok(settings)
}
