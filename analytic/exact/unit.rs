//! The unit of every quantity: what its value is a multiple of. `mfp` is a mean free path, 1 a pure number.

use crate::answer::{Answer, Field};

/// The unit of a quantity in an answer.
pub fn unit(answer: &Answer, quantity: &str) -> &'static str {
    let word = |name: &str| {
        answer.parameters.iter().find(|(n, _)| *n == name).map_or("", |(_, field)| match field {
            Field::Text(text) => text.as_str(),
            _ => "",
        })
    };
    match answer.problem {
        "half-space" if word("source") == "infinitely deep" => match quantity {
            "fluence" => "exitance",
            "radiance" => "exitance/sr",
            _ => lit(quantity),
        },
        "slab" | "half-space" | "thick" | "two-stream" | "xy" => lit(quantity),
        "sphere" if word("source") == "incident" => match quantity {
            "escape" | "escape_direct" => "incident power",
            "exit_radiance" => "irradiance/sr",
            _ => lit(quantity),
        },
        "sphere" => match quantity {
            "escape" | "escape_direct" | "absorptance" => "emitted power",
            "exit_radiance" => "power/(mfp^2 sr)",
            _ => emitted(quantity),
        },
        "infinite" => emitted(quantity),
        "cavity" => match quantity {
            "irradiance_wall" | "fluence_wall" => "exitance",
            "irradiance_centre" if word("medium") == "none" => "power/length^2",
            "irradiance_centre" => "power/mfp^2",
            "irradiance_mean" => "unit of first",
            _ => "1",
        },
        "critical" if quantity == "size" => "mfp",
        "critical" => "middle",
        "path" => match quantity {
            "mean_path_absorbing" => "mfp",
            "chord_moment" => "length^n",
            "chord_density" => "1/length",
            _ => "length",
        },
        "kernel" => match quantity {
            "m2" => "radius^2",
            "m4" => "radius^4",
            "roughness" | "normalization" => "1/radius^d",
            "equivalent_width" | "line_deviation" | "rise_width_10_90" | "missing_length" => "radius",
            "line_spread" => "1/radius",
            "face_moment_1" => "radius",
            "face_moment_2" => "radius^2",
            "exponential_mean" => "field",
            _ => "1",
        },
        "beams" | "nearest" => match quantity {
            "exponential_mean" | "expectation_exponential" => "field",
            "mean_square_distance_k" | "mean_square_distance_k_minus_1" => "length^2",
            "optimum_radius" => "length",
            _ => "1",
        },
        "boundary" => match quantity {
            "variance_over_whole_ball" => "whole ball",
            "mean_at_wall" => "field in front",
            _ => "field",
        },
        "progressive" if quantity.ends_with("_ratio") => "first pass",
        _ => "1",
    }
}

/// Where light of unit irradiance falls on a face.
fn lit(quantity: &str) -> &'static str {
    match quantity {
        _ if quantity.starts_with("fluence") || quantity == "flux" => "irradiance",
        _ if quantity.starts_with("radiance") => "irradiance/sr",
        _ if ["reflectance", "transmittance", "absorptance", "specular"]
            .iter()
            .any(|q| quantity.starts_with(q)) =>
        {
            "incident power"
        }
        "decay" | "second_decay" => "1/mfp",
        "extrapolation_length" => "mfp",
        "escape_direct_from" => "emitted there",
        _ => "1",
    }
}

/// Where a source of unit power emits.
fn emitted(quantity: &str) -> &'static str {
    match quantity {
        "total_fluence" | "transform" => "power mfp",
        "mean_square_radius" | "mean_square_distance" => "mfp^2",
        "mean_cosine" => "1",
        "decay" => "1/mfp",
        "escape_direct_from" => "emitted there",
        _ => "power/mfp^2",
    }
}
