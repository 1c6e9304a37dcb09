//! results.csv and costs.csv: every parameter a column.

use super::data::{Data, Half, Known, Setting};
use super::words;
use crate::harness::Estimate;
use crate::prediction::Prediction;
use std::collections::HashMap;
use turbid::estimators::Gather;
use turbid::photons::PeakBytes;
use turbid::stats::Moments;

/// A table as text, in CSV.
fn csv_text(header: &[String], rows: impl Iterator<Item = Vec<String>>) -> anyhow::Result<String> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(header)?;
    for row in rows {
        out.write_record(&row)?;
    }
    Ok(String::from_utf8(out.into_inner()?)?)
}

/// The parameters of a setting: the values of the axes, then those of the estimator.
fn parameters(data: &Data, setting: &Setting) -> Vec<String> {
    let estimator = setting.estimator;
    let (radius, k, cap) = match estimator.gather {
        _ if estimator.reads_rays() => Default::default(),
        Gather::Radius(radius) => (radius.get().to_string(), String::new(), String::new()),
        Gather::Nearest { k, max_radius } | Gather::NearestBiased { k, max_radius } => {
            (String::new(), k.get().to_string(), max_radius.get().to_string())
        }
    };
    let mut all: Vec<String> = data.point.values.iter().map(|(_, value)| value.clone()).collect();
    let [of_rays, of_beams] = [estimator.ray_radius, estimator.beam_radius]
        .map(|radius| radius.map_or_else(String::new, |radius| radius.get().to_string()));
    all.extend([setting.photons.to_string(), estimator.kernel.name().to_string(), radius]);
    let ray_k = estimator.ray_k.map_or_else(String::new, |k| k.to_string());
    let of_beam = |word: &str| estimator.beam_radius.map_or_else(String::new, |_| word.to_string());
    let [fluence, planes] = [estimator.has_beam_fluence, estimator.has_planes]
        .map(|is| of_beam(if is { "true" } else { "false" }));
    let ends = if estimator.reads_rays() { estimator.ray_ends.name() } else { "" };
    all.extend([
        of_rays,
        ray_k,
        of_beams,
        of_beam(estimator.beam_blur.name()),
        of_beam(estimator.beam_length.name()),
    ]);
    all.extend([fluence, planes, ends.to_string(), k, cap]);
    all.extend([estimator.treatment.name().to_string(), estimator.rejection.name().to_string()]);
    all
}

const ESTIMATOR: [&str; 15] = [
    "photons",
    "kernel",
    "radius",
    "ray_radius",
    "ray_k",
    "beam_radius",
    "beam_blur",
    "beam_length",
    "beam_fluence",
    "planes",
    "ray_ends",
    "k",
    "max_radius",
    "treatment",
    "rejection",
];

/// The names of the columns: axes, settings, and those of the table. An axis that is called as one of the others is `scene.NAME`.
fn columns(data: &[Data], own: &[&str]) -> Vec<String> {
    let others: Vec<&str> = ESTIMATOR.iter().chain(own).copied().collect();
    let axes = data.first().map(|data| data.point.values.iter().map(|(key, _)| key.as_str()));
    let named = |key: &str| match others.contains(&key) {
        true => format!("scene.{key}"),
        false => key.to_string(),
    };
    axes.into_iter().flatten().map(named).chain(others.iter().map(|name| name.to_string())).collect()
}

/// A number, nothing where there is none.
fn cell(x: f64) -> String {
    if x.is_finite() { format!("{x:?}") } else { String::new() }
}

/// The errors of one place: bias, standard deviation and root mean square error of one map, each with its standard error, relative to
/// the reference.
fn errors(values: &[f64], known: &Known) -> [f64; 6] {
    if !known.is_usable() {
        return [f64::NAN; 6];
    }
    let relative = if known.is_exact { 0.0 } else { known.relative() };
    let errors: Moments = values.iter().map(|x| x / known.value - 1.0).collect::<Vec<f64>>().iter().collect();
    let deviation = errors.std_dev();
    let bias_error = libm::hypot(errors.std_error(), relative);
    // Of a root, half the relative error of the square.
    let deviation_error = 0.5 * deviation * errors.vov().sqrt();
    let n = errors.n() as f64;
    // What noise and the reference's own error add to the square of the mean is taken off it, as far as it goes.
    let bias = errors.mean() * errors.mean() - errors.variance() / n - relative * relative;
    let rmse = (bias.max(0.0) + errors.variance()).sqrt();
    let of_square = libm::hypot(
        2.0 * errors.mean() * bias_error,
        libm::hypot(errors.variance() * errors.vov().sqrt(), 2f64.sqrt() * relative * relative),
    );
    let rmse_error = if rmse > 0.0 { 0.5 * of_square / rmse } else { 0.5 * of_square.sqrt() };
    [errors.mean(), bias_error, deviation, deviation_error, rmse, rmse_error]
}

/// results.csv: a row a setting and place, and one over all places of a setting (`all`); the same bits on any number of threads.
pub fn results(data: &[Data], predictions: &[Prediction]) -> anyhow::Result<String> {
    let own = [
        "place",
        "x",
        "y",
        "z",
        "unit",
        "maps",
        "mean",
        "std_error",
        "predicted",
        "reference",
        "reference_error",
        "reference_by",
        "bias",
        "bias_error",
        "std_dev",
        "std_dev_error",
        "rmse",
        "rmse_error",
        "photons_stored",
        "under_full_share",
    ];
    let header = columns(data, &own);
    let predicted: HashMap<(&str, &str), f64> =
        predictions.iter().map(|p| ((p.case.as_str(), p.quantity.as_str()), p.value)).collect();
    let mut rows = Vec::new();
    for data in data {
        for setting in &data.settings {
            let case = words::case(data.point, setting.photons, setting.estimator);
            let own = parameters(data, setting);
            let stored = data.stored.iter().find(|(photons, _)| *photons == setting.photons);
            let stored = stored.map_or(f64::NAN, |(_, stored)| *stored);
            let maps = setting.errors.len().to_string();
            for ((place, values), known) in data.point.places.iter().zip(&setting.values).zip(&data.known) {
                let moments: Moments = values.iter().collect();
                let mut row = own.clone();
                row.push(place.name.clone());
                row.extend(place.at.map(cell));
                row.extend([place.unit.name().to_string(), maps.clone()]);
                row.extend([moments.mean(), moments.std_error()].map(cell));
                let key = (case.as_str(), place.name.as_str());
                row.push(predicted.get(&key).map_or_else(String::new, |value| cell(*value)));
                row.extend([known.value, known.error].map(cell));
                row.push(by(data, known).to_string());
                row.extend(errors(values, known).map(cell));
                row.extend([cell(stored), cell(setting.underfull)]);
                rows.push(row);
            }
            for group in other_groups(data) {
                let mut row = own.clone();
                row.extend([&format!("all {group}"), "", "", "", "1", &maps].map(String::from));
                row.extend(std::iter::repeat_n(String::new(), 6));
                let own = data.of_group(setting, group);
                let estimates = own.map(|own| [own.bias(), own.noise(), own.rmse(Half::Both)]);
                for estimate in estimates.map_or([None; 3], |all| all.map(Some)) {
                    let number = |of: fn(&Estimate) -> f64| estimate.as_ref().map_or(f64::NAN, of);
                    row.extend([number(Estimate::value), number(Estimate::std_error)].map(cell));
                }
                row.extend([cell(stored), cell(setting.underfull)]);
                rows.push(row);
            }
            if data.usable() > 0 {
                let mut row = own;
                row.extend(["all", "", "", "", "1", &maps, "", "", "", "", "", ""].map(String::from));
                for estimate in [setting.bias(), setting.noise(), setting.rmse(Half::Both)] {
                    row.extend([estimate.value(), estimate.std_error()].map(cell));
                }
                row.extend([cell(stored), cell(setting.underfull)]);
                rows.push(row);
            }
        }
    }
    csv_text(&header, rows.into_iter())
}

/// The groups of places that errors are not told of by the report.
fn other_groups(data: &Data) -> Vec<&'static str> {
    let mut groups: Vec<&'static str> = data
        .point
        .places
        .iter()
        .filter(|place| !data.point.is_main(place))
        .map(|place| place.group)
        .collect();
    groups.dedup();
    groups
}

/// Who says a reference.
pub fn by(data: &Data, known: &Known) -> &'static str {
    if known.is_exact { "exact" } else { data.reference.sampler.name() }
}

/// costs.csv: CPU seconds and memory of every setting, and of the rival, on this machine.
pub fn costs(data: &[Data]) -> anyhow::Result<String> {
    let own = ["method", "filling_seconds", "reading_seconds", "peak_bytes", "samples"];
    let header = columns(data, &own);
    let mut rows = Vec::new();
    for data in data {
        for setting in &data.settings {
            let mut row = parameters(data, setting);
            let stored = data.stored.iter().find(|(photons, _)| *photons == setting.photons);
            let bytes = stored.map_or(f64::NAN, |(_, stored)| PeakBytes::MAPS.of(*stored));
            row.push("photon map".to_string());
            row.extend(setting.seconds.iter().map(|seconds| cell(seconds.mean())));
            row.extend([cell(bytes), String::new()]);
            rows.push(row);
        }
        if let Some(rival) = &data.rival {
            let mut row: Vec<String> = data.point.values.iter().map(|(_, value)| value.clone()).collect();
            row.resize(header.len() - own.len(), String::new());
            row.push(data.reference.sampler.name().to_string());
            row.extend([String::new(), cell(rival.seconds * data.reference.samples as f64)]);
            row.extend([String::new(), data.reference.samples.to_string()]);
            rows.push(row);
        }
    }
    csv_text(&header, rows.into_iter())
}
