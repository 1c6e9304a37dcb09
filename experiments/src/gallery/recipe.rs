//! How a picture is made: settings for the photon mapper, and the command that makes the same picture as EXR.

use super::pictures::Picture;
use turbid::estimators::Gather;
use turbid::integrators::mapper;
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples};

/// What the maps are filled with, `factor` times the photons of the original.
pub fn maps(picture: &Picture, factor: u64, seed: u64, replicate: u64) -> MapSettings {
    let [global, caustic, volume] = picture.photons.map(|amount| match amount {
        Amount::Emitted(n) => Amount::Emitted(n * factor),
        Amount::Stored(n) => Amount::Stored(n * factor),
    });
    let indirect = if picture.gather > 0 { Indirect::Gathered } else { Indirect::Seen };
    MapSettings { global, caustic, volume, media: MediumSamples::Points, indirect, seed, replicate }
}

/// How the maps are read: as in 1998, with this picture's numbers of photons; of maps with `factor` times the photons, with
/// its root as many in an estimate, which then has less blur and less noise.
///
/// # Errors
/// those of the settings
pub fn readout(picture: &Picture, factor: u64) -> turbid::Result<mapper::Settings> {
    let mut settings = mapper::Settings::for_size(picture.size, picture.nearest[0])?;
    let gathers = [&mut settings.global.1, &mut settings.caustic.1, &mut settings.volume.gather];
    for (gather, k) in gathers.into_iter().zip(picture.nearest) {
        *gather = Gather::nearest(k * factor.isqrt() as usize, picture.reach)?;
    }
    settings.gather_rays = picture.gather.max(1);
    settings.near = picture.near;
    if !picture.is_adaptive {
        settings.march.adaptive = None;
    }
    Ok(settings)
}

/// The arguments of `turbid` that render a picture as EXR: the very numbers of the one that is shown.
pub fn arguments(picture: &Picture, seed: u64) -> anyhow::Result<Vec<String>> {
    let settings = readout(picture, 1)?;
    let [global, caustic, volume] = picture.photons.map(|amount| amount.to_string());
    let [k, caustic_k, volume_k] = picture.nearest.map(|k| k.to_string());
    let mut arguments: Vec<String> =
        ["render", &format!("experiments/scenes/{}.toml", picture.name)].map(str::to_string).into();
    let mut flag = |name: &str, value: String| arguments.extend([name.to_string(), value]);
    flag("--output", format!("{}.exr", picture.name));
    flag("--samples", picture.samples.to_string());
    flag("--global", global);
    flag("--caustic", caustic);
    flag("--volume", volume);
    flag("--k", k);
    flag("--caustic-k", caustic_k);
    flag("--volume-k", volume_k);
    flag("--max-radius", picture.reach.to_string());
    flag("--gather-rays", picture.gather.to_string());
    flag("--near", picture.near.to_string());
    flag("--step", settings.march.step.get().to_string());
    flag("--adapt", settings.march.adaptive.map_or(0.0, |a| a.tolerance).to_string());
    flag("--spacing", settings.spacing.to_string());
    flag("--exposure", super::develop::tone(picture.exposure).exposure.to_string());
    flag("--seed", seed.to_string());
    Ok(arguments)
}

/// The command of the page, for a shell in the repository's folder.
pub fn command(picture: &Picture, seed: u64) -> anyhow::Result<String> {
    Ok(format!("cargo run --release --bin turbid -- {}", arguments(picture, seed)?.join(" ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::pictures::ALL;

    /// As in 1998, steps shorten where the light changes; not in the cloud.
    #[test]
    fn pictures_march_adaptively() {
        for picture in ALL {
            let adaptive = readout(picture, 1).unwrap().march.adaptive;
            assert_eq!(
                adaptive.map(|a| a.tolerance),
                (picture.name != "cloud").then_some(0.5),
                "{}",
                picture.name
            );
        }
    }
}
