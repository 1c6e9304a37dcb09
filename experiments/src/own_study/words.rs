//! Names of cases, as cells, predictions and results share them.

use super::points::Point;
use turbid::estimators::{BeamBlur, Estimator, Gather, RayEnds};
use turbid::photons::beams::BeamLength;

/// Name of the experiment, in files and in random streams.
pub const NAME: &str = "own";

/// What precedes a case of a scene.
fn scene(point: &Point) -> String {
    if point.label.is_empty() { String::new() } else { format!("{}, ", point.label) }
}

/// Maps of so many photons.
pub fn maps(point: &Point, photons: u64) -> String {
    format!("{}{photons} photons", scene(point))
}

/// One estimator that reads them.
pub fn case(point: &Point, photons: u64, estimator: &Estimator) -> String {
    format!("{}, {}", maps(point, photons), estimator.name())
}

/// The sampled reference.
pub fn reference(point: &Point) -> String {
    format!("{}reference", scene(point))
}

/// How well the errors of its batches are known: standard error, variance of variance, contributing paths, heavy tails.
pub fn spread(point: &Point) -> [String; 4] {
    ["errors", "variances of variance", "contributing", "heavy tails"]
        .map(|what| format!("{}, {what}", reference(point)))
}

/// The phase of the work that an estimator's reading is.
pub fn reading(estimator: usize) -> String {
    format!("reading {estimator}")
}

/// The phase of the work that emission and building are.
pub const FILLING: &str = "filling";

/// The phase of the work that sampling the reference is.
pub const SAMPLING: &str = "sampling";

/// What estimators that differ in the size of their gather share.
pub fn family(estimator: &Estimator) -> String {
    let Estimator { kernel, gather, treatment, rejection, .. } = estimator;
    let size = match gather {
        Gather::Radius(_) => "fixed radius",
        Gather::Nearest { .. } => "k nearest",
        Gather::NearestBiased { .. } => "k nearest, biased",
    };
    let size = if estimator.ray_k.is_some() { "k nearest of each photon" } else { size };
    let mut name = format!("{size}, {}", kernel.name());
    if estimator.reads_rays() {
        name += if estimator.ray_radius.is_some() { ", along rays" } else { ", beams" };
        if estimator.beam_blur != BeamBlur::OneD {
            name += &format!(" blurred in {}", estimator.beam_blur.name());
        }
        for (is_told, what) in [
            (estimator.beam_length == BeamLength::Whole, ", whole"),
            (estimator.has_beam_fluence, ", at places too"),
            (estimator.has_planes, ", with planes"),
            (estimator.ray_ends == RayEnds::Own, ", ends of their own"),
        ] {
            name += if is_told { what } else { "" };
        }
        return name;
    }
    name += &format!(", {}", treatment.name());
    if *rejection != turbid::estimators::boundary::Rejection::Off {
        name += &format!(", {}", rejection.name());
    }
    name
}

/// The size of a gather: its radius \[L\], or its k.
pub fn size(estimator: &Estimator) -> f64 {
    match estimator.gather {
        Gather::Radius(radius) => estimator.ray_k.map_or(radius.get(), |k| k.get() as f64),
        Gather::Nearest { k, .. } | Gather::NearestBiased { k, .. } => k.get() as f64,
    }
}

/// Whether the gather's radius is fixed.
pub fn is_fixed(estimator: &Estimator) -> bool {
    matches!(estimator.gather, Gather::Radius(_)) && estimator.ray_k.is_none()
}
