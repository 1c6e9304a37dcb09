//! Settings of photon maps as JSON, for the headers of pictures.

use serde_json::{Value, json};
use turbid::estimators::{Gather, Kernel, RayEnds};
use turbid::integrators::mapper::Settings;
use turbid::integrators::{March, StepRule};
use turbid::photons::maps::{Amount, Indirect, MapSettings};

/// What maps are filled with.
pub fn map_settings(settings: &MapSettings) -> Value {
    let MapSettings { global, caustic, volume, media: _, indirect, seed, replicate: _ } = settings;
    let amount = |amount: &Amount| match amount {
        Amount::Stored(count) => json!({ "stored": count }),
        Amount::Emitted(count) => json!({ "emitted": count }),
    };
    json!({
        "global": amount(global),
        "caustic": amount(caustic),
        "volume": amount(volume),
        "global_is_read": match indirect {
            Indirect::Gathered => "by final gathering",
            Indirect::Seen => "where the eye looks",
        },
        "seed": seed,
    })
}

/// How maps are read.
pub fn mapper_settings(settings: &Settings) -> Value {
    let Settings { global, caustic, volume, slope, clips_discs, gather_rays, near, march, spacing } =
        settings;
    let March { step, rule, is_jittered, adaptive } = march;
    let mut of_volume = read((volume.kernel, volume.gather));
    of_volume["boundary"] = json!(volume.treatment.name().replace(' ', "-"));
    of_volume["reject"] = json!(volume.rejection.name().replace(' ', "-"));
    if let Some(radius) = volume.ray_radius {
        of_volume["ray_radius"] = json!(radius.get());
    }
    if let Some(k) = volume.ray_k {
        of_volume["ray_k"] = json!(k.get());
    }
    if let Some(radius) = volume.beam_radius {
        of_volume["beam_radius"] = json!(radius.get());
        of_volume["beam_blur"] = json!(volume.beam_blur.name());
        of_volume["beam_length"] = json!(volume.beam_length.name());
    }
    if volume.ray_ends != RayEnds::Cut {
        of_volume["ray_ends"] = json!(volume.ray_ends.name());
    }
    if volume.has_planes {
        of_volume["planes"] = json!(true);
    }
    json!({
        "global": read(*global),
        "caustic": read(*caustic),
        "volume": of_volume,
        "slope": slope,
        "edges": if *clips_discs { "clipped" } else { "none" },
        "gather_rays": gather_rays,
        "near": near,
        "step": step.get(),
        "step_rule": match rule {
            StepRule::NearEnd => "near-end",
            StepRule::Middle => "middle",
            StepRule::Integrated => "integrated",
        },
        "jitter": is_jittered,
        "spacing": if settings.shares_gathers() { *spacing } else { 0.0 },
        "adapt": adaptive.map_or(0.0, |adaptive| adaptive.tolerance),
        "shortest_step": adaptive.map(|adaptive| adaptive.shortest.get()),
    })
}

/// Kernel and gather of an estimate.
fn read((kernel, gather): (Kernel, Gather)) -> Value {
    match gather {
        Gather::Radius(radius) => json!({ "kernel": kernel.name(), "radius": radius.get() }),
        _ => json!({ "kernel": kernel.name(), "k": gather.k(), "max_radius": gather.cap() }),
    }
}
