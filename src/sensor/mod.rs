//! Sensors: what paths and photons read of a scene, one mean with its standard error a number.

mod paths;
mod photons;

pub use paths::{PathSettings, by_paths, sample};
pub use photons::{PhotonReadings, PhotonSettings, by_photons};

use crate::scene::Sensor;
use crate::stats::Moments;

/// A measured number.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Reading {
    /// Name of the sensor.
    pub sensor: String,
    /// Name of the quantity, with `.r`, `.g`, `.b` where channels differ.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// Estimate.
    pub mean: f64,
    /// Standard error of the mean; none where one map says nothing about it.
    pub std_error: Option<f64>,
    /// Independent histories or maps behind it.
    pub n: u64,
}

/// The readings of one sensor: one where the scene is grey, otherwise one a channel.
fn readings(sensor: &Sensor, is_grey: bool, moments: &[Moments; 3]) -> Vec<Reading> {
    let suffixes: &[&str] = if is_grey { &[""] } else { &[".r", ".g", ".b"] };
    suffixes
        .iter()
        .zip(moments)
        .map(|(suffix, m)| Reading {
            sensor: sensor.name.clone(),
            quantity: format!("{}{suffix}", sensor.label),
            unit: sensor.unit(),
            mean: m.mean(),
            std_error: (m.n() >= 2).then(|| m.std_error()),
            n: m.n(),
        })
        .collect()
}
