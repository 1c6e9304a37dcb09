//! Maps of one pass, read by any number of estimators.

use super::PhotonForecast;
use super::from_maps::{PhotonReadings, Surroundings, read_bins};
use super::order_maps::{OrderMaps, RadianceMaps, map_orders, maps, max_order};
use super::photons::{check, check_orders, check_rays, forecast_of, margin_of};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::Estimator;
use crate::photons::{Histories, Ledger, Part};
use crate::scene::{Quantity, Scene};
use crate::transport::Progress;

/// Which photons the maps of a pass are of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapSettings {
    /// Photons emitted.
    pub photons: u64,
    /// Seed of the whole computation.
    pub seed: u64,
    /// Number of the independent pass.
    pub replicate: u64,
    /// The farthest that any estimator will reach \[L\].
    pub reach: f64,
    /// Marches along each ray, and sets of points in each bin, that a reading is the mean of: at least 1. A fluence at a point is
    /// read once, since nothing in it is random.
    pub readings: usize,
    /// What any estimator will read radiance from.
    pub radiance: RadianceMaps,
}

/// The maps that answer the sensors of a scene, of one pass.
pub struct SensorMaps<'a> {
    scene: &'a Scene,
    maps: OrderMaps,
    settings: MapSettings,
    /// Powers \[W\] by history.
    pub ledger: Ledger,
}

/// What maps answer by one estimator.
#[derive(Debug, Clone, PartialEq)]
pub struct MapReading {
    /// Estimates of every sensor, in the scene's order, and of its bins: one of a sensor without bins \[the sensor's unit\].
    pub values: Vec<Vec<Spectrum>>,
    /// Estimates that found fewer than k photons within the cap.
    pub underfull: u64,
    /// Estimates made.
    pub gathers: u64,
}

/// How far the k nearest photons are sought where nobody says \[L\]: half the cell, or a mean free path of the densest medium.
pub fn usual_reach(scene: &Scene) -> f64 {
    let densest = scene.media().iter().map(|medium| medium.highest_sigma_t().max()).fold(0.0, f64::max);
    match scene.periodic_cell() {
        Some(periodic_cell) => 0.5 * periodic_cell.side.min_element(),
        None if densest > 0.0 => 1.0 / densest,
        None => 1.0,
    }
}

/// How far beyond the edges of the cell the maps have to go on, if they can answer.
fn checked(scene: &Scene, reach: f64, radiance: RadianceMaps) -> Result<f64> {
    for sensor in scene.sensors() {
        if map_orders(sensor).is_none() {
            return Err(Error::Scene(format!(
                "sensor {}: no map answers it; allowed: fluence and radiance, at points or over bins",
                sensor.name
            )));
        }
        check(scene, sensor)?;
    }
    check_orders(scene, scene.sensors(), radiance)?;
    margin_of(scene, scene.sensors(), reach)
}

impl<'a> SensorMaps<'a> {
    /// Emits the photons and builds the maps.
    ///
    /// # Errors
    /// `Error::Scene` for a sensor that maps cannot answer, or a reach beyond the periodic cell; those of the photon pass
    pub fn fill(scene: &'a Scene, settings: MapSettings, progress: &dyn Progress) -> Result<Self> {
        let margin = checked(scene, settings.reach, settings.radiance)?;
        let MapSettings { photons, seed, replicate, radiance, .. } = settings;
        let sensors = scene.sensors();
        let histories = Histories { count: photons, seed, replicate, max_order: max_order(sensors) };
        let part = Part { number: 0, of: 1 };
        let (pass, maps) = maps(scene, (sensors, radiance), histories, part, margin, progress)?;
        Ok(SensorMaps { scene, maps, settings, ledger: pass.report.ledger })
    }

    /// Whether maps of one pass can answer every sensor of a scene by each of these estimators.
    ///
    /// # Errors
    /// `Error::Scene` that names the sensor, the cell that is too small, what planes cannot be stored of, or beams of two lengths
    pub fn check(scene: &Scene, estimators: &[Estimator]) -> Result<()> {
        RadianceMaps::check_lengths(estimators)?;
        for estimator in estimators {
            check_rays(scene, scene.sensors(), estimator)?;
            check_orders(scene, scene.sensors(), RadianceMaps::of([estimator]))?;
        }
        let reach = estimators.iter().map(Estimator::reach).fold(0.0, f64::max);
        checked(scene, reach, RadianceMaps::of(estimators)).map(|_| ())
    }

    /// What filling maps of so many photons will take, by a pilot.
    ///
    /// # Errors
    /// As [`SensorMaps::fill`]
    pub fn forecast(scene: &Scene, settings: &MapSettings) -> Result<PhotonForecast> {
        let margin = checked(scene, settings.reach, settings.radiance)?;
        let sensors = (scene.sensors(), settings.radiance);
        forecast_of(scene, sensors, margin, (settings.photons, 1, settings.seed), 1)
    }

    /// Photons that the maps hold, those beyond the edges of a periodic cell too, beams, and planes.
    pub fn stored(&self) -> usize {
        self.maps.stored()
    }

    /// Every sensor by one estimator. All estimators ask at the same places.
    ///
    /// # Errors
    /// `Error::OutOfRange` for one that reaches farther than the maps were filled for; `Error::Scene` for a bin that
    /// reaches outside of all media; `Error::NonFinite`
    pub fn read(&self, estimator: &Estimator) -> Result<MapReading> {
        let cap = estimator.reach();
        if cap > self.settings.reach {
            return Err(Error::out_of_range("the reach of an estimator", cap, "at most that of the maps"));
        }
        check_rays(self.scene, self.scene.sensors(), estimator)?;
        let (sensors, mut booked) = (self.scene.sensors(), PhotonReadings::new());
        let around = Surroundings::of(self.scene, estimator);
        let radii = self.maps.radii(sensors, estimator);
        let mut values: Vec<Vec<Spectrum>> = Vec::with_capacity(sensors.len());
        for (number, sensor) in sensors.iter().enumerate() {
            let Some(map) = self.maps.of(sensor, estimator, &radii) else {
                return Err(Error::Scene(format!(
                    "sensor {}: the maps were not filled for {}",
                    sensor.name,
                    estimator.name()
                )));
            };
            let is_random = !matches!(sensor.quantity, Quantity::Fluence(_));
            let readings = if is_random { self.settings.readings.max(1) } else { 1 };
            let mut sums: Vec<Spectrum> = Vec::new();
            for reading in 0..readings {
                let of = (self.settings.seed, self.settings.replicate, number + reading * sensors.len());
                let read = read_bins(&around, map, sensor, estimator, of, &mut booked)?;
                match reading {
                    0 => sums = read,
                    _ => sums.iter_mut().zip(read).for_each(|(sum, value)| *sum += value),
                }
            }
            values.push(sums.into_iter().map(|sum| sum / readings as f64).collect());
        }
        let count = values.iter().flatten().filter(|value| !value.is_finite()).count() as u64;
        if count > 0 {
            return Err(Error::NonFinite { count, place: "estimates from photon maps" });
        }
        Ok(MapReading { values, underfull: booked.underfull, gathers: booked.gathers })
    }
}
