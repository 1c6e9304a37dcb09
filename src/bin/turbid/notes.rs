//! What a picture's reader should know: maps that are empty, and settings that cannot be good, with the option that helps.

use super::made::Filled;
use super::shared::note;
use std::io::Result;
use turbid::geometry::Shape;
use turbid::integrators::StepRule;
use turbid::integrators::mapper::{Gathers, Report, Settings};
use turbid::math::FOUR_PI;
use turbid::medium::Medium;
use turbid::phase::PhaseFunction;
use turbid::photons::maps::MediumSamples;
use turbid::scene::Scene;
use turbid::sensor::{Film, Pixel};
use turbid::surface::Surface;

/// Says which layers are black since no photon was stored for them.
pub fn tell_empty(filled: &[Option<Filled>; 3]) -> Result<()> {
    let (caustic, volume) = ("the caustic layer is black", "the multiple layer has no light from it");
    let global = "the indirect layer has no light from it";
    let layers = [("global", global), ("caustic", caustic), ("volume", volume)];
    for ((name, black), filled) in layers.into_iter().zip(filled) {
        if let Some(Filled { stored: 0, emitted }) = filled {
            note(&format!(
                "the {name} map is empty: none of {emitted} photons sent out was stored in it, so {black}"
            ))?;
        }
    }
    Ok(())
}

/// Shortest mean free path of the media of a scene that `counts` \[L\]; infinite without any.
fn shortest_path(scene: &Scene, counts: impl Fn(usize) -> bool) -> f64 {
    let media = scene.media().iter().enumerate().filter(|(number, _)| counts(*number));
    1.0 / media.map(|(_, medium)| medium.highest_sigma_t().max()).fold(0.0, f64::max)
}

/// Says where the march steps over mean free paths. Where steps are integrated at random places, it does no harm in a
/// homogeneous medium: the place is chosen by what reaches its near end.
pub fn tell_step(scene: &Scene, settings: &Settings) -> Result<()> {
    let march = &settings.march;
    let is_exact = march.is_jittered && march.rule == StepRule::Integrated;
    let path = shortest_path(scene, |number| !(is_exact && scene.medium(number).is_homogeneous()));
    let step = march.step.get();
    // By rounding a step of a mean free path may be longer than it.
    if step <= 1.001 * path {
        return Ok(());
    }
    let effect = if march.is_jittered { "noisy" } else { "wrong" };
    note(&format!(
        "steps of {step:.2e} L are longer than the shortest mean free path, {path:.2e} L: light in media is {effect} where it \
         is dense; --step {:.1e} takes shorter ones",
        // Rounded, it is still shorter.
        0.95 * path
    ))
}

/// Says where variances are too large or too small for a picture's file.
pub fn tell_variances(film: &Film) -> Result<()> {
    let is_out = |x: f64| x.is_finite() && x > 0.0 && !(x as f32).is_normal();
    let is_lost = |pixel: &&Pixel| {
        pixel.variance().is_some_and(|variance| variance.0.to_array().into_iter().any(is_out))
    };
    match film.pixels().iter().filter(is_lost).count() {
        0 => Ok(()),
        pixels => note(&format!(
            "the variances of {pixels} pixels are beyond single precision, in which the picture's file has them as 0 or inf: \
             other powers of the lights bring them back"
        )),
    }
}

/// Says which look-ups cannot be good, after the picture is made; `stored` are the photons in the global, the caustic and the
/// volume map.
pub fn tell_gathers(
    scene: &Scene,
    settings: &Settings,
    work: &Report,
    stored: [Option<usize>; 3],
) -> Result<()> {
    let smallest = |shapes: &mut dyn Iterator<Item = &Shape>| {
        shapes.map(Shape::shortest_extent).filter(|extent| *extent > 0.0).fold(f64::INFINITY, f64::min)
    };
    let is_diffuse = |surface: &Surface| matches!(surface, Surface::Lambertian(_));
    let bodies = scene.objects().iter().filter(|o| is_diffuse(&o.surface));
    let body = smallest(&mut bodies.map(|o| &o.shape));
    let medium = smallest(&mut scene.colliding_shapes());
    // Of the thinnest medium: a picture of several has one mean radius.
    let colliding = scene.media().iter().filter(|m| m.is_colliding());
    let path = 1.0 / colliding.map(|m| m.highest_sigma_t().max()).fold(f64::INFINITY, f64::min);
    let maps = [
        ("global", &work.global, settings.global.1.cap(), ("the smallest diffuse body", body), f64::INFINITY),
        (
            "caustic",
            &work.caustic,
            settings.caustic.1.cap(),
            ("the smallest diffuse body", body),
            f64::INFINITY,
        ),
        ("volume", &work.volume, settings.volume.gather.cap(), ("the smallest medium", medium), path),
    ];
    for (((name, gathers, cap, (what, extent), path), stored), k) in
        maps.into_iter().zip(stored).zip(settings.nearest())
    {
        let Some(stored) = stored.filter(|stored| *stored > 0 && gathers.count > 0) else { continue };
        let radius = Gathers::mean_radius(gathers);
        let is_fixed = k.is_none();
        let k = k.filter(|_| name != "volume" || !settings.volume.reads_rays());
        if let Some(k) = k.filter(|k| stored < *k) {
            note(&format!(
                "the {name} map holds {stored} photons, fewer than an estimate takes, {k}: --{name} for more of them"
            ))?;
        } else if gathers.found == 0 {
            let (what, brings) = match settings.media() {
                _ if name != "volume" => ("photon", "no light"),
                MediumSamples::Points => ("photon", "no light"),
                MediumSamples::Beams(_) => ("beam", "no light"),
                MediumSamples::Planes(None) => continue,
                // No body sends any.
                MediumSamples::Planes(_) if scene.objects().is_empty() => continue,
                MediumSamples::Planes(_) => ("beam", "no light that comes to media from bodies"),
            };
            note(&format!(
                "none of the {} look-ups in the {name} map found a {what} within {radius:.2e} L, so that it brings {brings}: --{name} \
                 for more of them, or a larger radius",
                gathers.count
            ))?;
        } else if 2 * gathers.underfull > gathers.count {
            let part = 100.0 * gathers.underfull as f64 / gathers.count as f64;
            let reach = gathers.underfull_radii / gathers.underfull as f64;
            // Curved bodies end sooner.
            let (within, or) = match reach < 0.9 * cap {
                true => (reach, ""),
                false => (cap, ", or, with less noise and more blur, a larger --max-radius"),
            };
            note(&format!(
                "{part:.0} % of the look-ups in the {name} map found fewer photons than asked for within {within:.2e} L: \
                 --{name} for more of them{or}"
            ))?;
        }
        let advice = match (name, settings.volume.ray_radius, settings.volume.beam_radius) {
            ("volume", Some(_), _) => "a smaller --ray-radius".to_string(),
            ("volume", _, Some(_)) => "a smaller --beam-radius".to_string(),
            _ if is_fixed => "a smaller --radius".to_string(),
            _ => format!("--{name} for more photons, or a smaller --max-radius"),
        };
        if 2.0 * radius > extent {
            note(&format!(
                "look-ups in the {name} map reach {radius:.2e} L in the mean, and {what} is {extent:.2e} L across: {advice}"
            ))?;
        } else if radius > path {
            note(&format!(
                "look-ups in the {name} map reach {radius:.2e} L in the mean, farther than a mean free path, {path:.2e} L: \
                 {advice}"
            ))?;
        }
    }
    Ok(())
}

/// A photon in the peak of a phase function, forwards or backwards, brings so many times what it brings on average, or more: radiances may then
/// hang on few of them. In a box of fog beside a lamp errors of 16 maps held where it was 45 (g = 0.8), and the mean was 26 of
/// them low where it was 190 (g = 0.9).
pub const PEAKED: f64 = 20.0;

/// How many times the mean a medium scatters into the peak of its phase function.
pub fn peak(medium: &Medium) -> f64 {
    let phase = medium.phase();
    FOUR_PI * phase.eval(0.0, 2.0).max(phase.eval(2.0, 0.0))
}

/// Says where planes make a picture too dark: in peaked media most of the light hangs on few of them.
pub fn tell_planes(scene: &Scene, settings: &Settings) -> Result<()> {
    let highest = scene.media().iter().map(peak).fold(0.0, f64::max);
    if !settings.volume.has_planes || highest < PEAKED {
        return Ok(());
    }
    note(&format!(
        "a plane in the peak of a phase function brings {highest:.0} times the mean one: pictures of few planes are too dark, by more than \
         their variance says; --beam-radius without --planes has lighter tails"
    ))
}
