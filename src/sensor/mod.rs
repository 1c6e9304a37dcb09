//! Sensors: what paths and photons read of a scene, one mean with its standard error a number; and pictures, a mean
//! with its variance a pixel and layer.

mod advise;
mod film;
mod light;
mod paths;
mod photons;
mod render;
mod view;

pub use crate::scene::{Camera, Filter, View};
pub use advise::{Advice, MIN_MAPS, PathAdvice, Pilot, PilotSettings, path_advice};
pub use film::{Film, Pixel, Sample};
pub use light::{LightCount, by_light, extend_by_light};
pub use paths::{PathSettings, by_paths, sample, sample_counted};
pub use photons::{
    PhotonForecast, PhotonReadings, PhotonSettings, by_photons, by_photons_in_passes, forecast,
};
pub use render::{MAX_SAMPLES, Streams, extend, render};
pub use view::{check_camera, colour, draw_photons};

use crate::scene::Sensor;
use crate::stats::{Moments, poisson_interval};

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
    /// Standard error of the mean; none where nothing is known of it: a single map, paths of which none brought
    /// anything, a variance that is itself too uncertain. A tally of no event has that of its 95 per cent bound, 3
    /// events.
    pub std_error: Option<f64>,
    /// Independent histories or maps behind it.
    pub n: u64,
    /// Whether the variance is too uncertain for a standard error: its own relative variance is above 0.1.
    #[serde(skip)]
    pub is_heavy_tailed: bool,
}

/// Who brought the numbers of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    /// Paths.
    Paths,
    /// Photon histories, each of which brings its power or none of it.
    Tally,
    /// Photon maps.
    Maps,
}

/// Fewest numbers whose variance of variance says something of their tail: that of normal ones is about 2/n.
const TELLS_TAIL: u64 = 100;

fn is_heavy_tailed(m: &Moments) -> bool {
    m.n() >= TELLS_TAIL && m.is_heavy_tailed()
}

fn std_error(m: &Moments, source: Source) -> Option<f64> {
    let brought_nothing = m.mean() == 0.0 && m.std_error() == 0.0;
    match source {
        _ if m.n() < 2 => None,
        Source::Tally if brought_nothing => Some(poisson_interval(0, 0.95).high / m.n() as f64),
        Source::Paths if brought_nothing => None,
        Source::Paths | Source::Maps if is_heavy_tailed(m) => None,
        _ => Some(m.std_error()),
    }
}

/// The readings of one sensor: one where the scene is grey, otherwise one a channel.
fn readings(sensor: &Sensor, is_grey: bool, moments: &[Moments; 3], source: Source) -> Vec<Reading> {
    let suffixes: &[&str] = if is_grey { &[""] } else { &[".r", ".g", ".b"] };
    suffixes
        .iter()
        .zip(moments)
        .map(|(suffix, m)| Reading {
            sensor: sensor.name.clone(),
            quantity: format!("{}{suffix}", sensor.label),
            unit: sensor.unit(),
            mean: m.mean(),
            std_error: std_error(m, source),
            n: m.n(),
            is_heavy_tailed: is_heavy_tailed(m),
        })
        .collect()
}
