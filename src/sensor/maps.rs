//! Maps of one pass, read by any number of estimators.

use super::PhotonForecast;
use super::photons::{PhotonReadings, check, forecast_of, map_orders, maps, margin_of, max_order, read_bins};
use crate::Spectrum;
use crate::error::{Error, Result};
use crate::estimators::Estimator;
use crate::integrators::mapper::{MediumExtent, medium_extents};
use crate::photons::{Histories, Ledger, Part, PhotonMap};
use crate::scene::{Orders, Scene, Sensor};
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
}

/// The maps that answer the sensors of a scene, of one pass.
pub struct SensorMaps<'a> {
    scene: &'a Scene,
    extents: Vec<MediumExtent>,
    maps: Vec<(Orders, PhotonMap)>,
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

/// Whether a map answers a sensor: a fluence or a radiance, at a point, along a ray or over bins.
pub fn is_of_maps(sensor: &Sensor) -> bool {
    map_orders(sensor).is_some()
}

fn checked(scene: &Scene, reach: f64) -> Result<f64> {
    for sensor in scene.sensors() {
        if !is_of_maps(sensor) {
            return Err(Error::Scene(format!(
                "sensor {}: no map answers it; allowed: fluence and radiance, at points or over bins",
                sensor.name
            )));
        }
        check(scene, sensor)?;
    }
    margin_of(scene, scene.sensors(), reach)
}

impl<'a> SensorMaps<'a> {
    /// Emits the photons and builds the maps.
    ///
    /// # Errors
    /// `Error::Scene` for a sensor that maps cannot answer, or a reach beyond the periodic cell; those of the photon pass
    pub fn fill(scene: &'a Scene, settings: MapSettings, progress: &dyn Progress) -> Result<Self> {
        let margin = checked(scene, settings.reach)?;
        let MapSettings { photons, seed, replicate, .. } = settings;
        let sensors = scene.sensors();
        let histories = Histories { count: photons, seed, replicate, max_order: max_order(sensors) };
        let (pass, maps) = maps(scene, sensors, histories, Part { number: 0, of: 1 }, margin, progress)?;
        Ok(SensorMaps { scene, extents: medium_extents(scene), maps, settings, ledger: pass.report.ledger })
    }

    /// What filling maps of so many photons will take, by a pilot.
    ///
    /// # Errors
    /// As [`SensorMaps::fill`]
    pub fn forecast(scene: &Scene, settings: &MapSettings) -> Result<PhotonForecast> {
        let margin = checked(scene, settings.reach)?;
        forecast_of(scene, scene.sensors(), margin, (settings.photons, 1, settings.seed))
    }

    /// Photons that the maps hold, those beyond the edges of a periodic cell too.
    pub fn stored(&self) -> usize {
        self.maps.iter().map(|(_, map)| map.stored()).sum()
    }

    /// Every sensor by one estimator. All estimators ask at the same places.
    ///
    /// # Errors
    /// `Error::OutOfRange` for one that reaches farther than the maps were filled for; `Error::Scene` for a bin that
    /// reaches outside of all media; `Error::NonFinite`
    pub fn read(&self, estimator: &Estimator) -> Result<MapReading> {
        let cap = estimator.gather.cap();
        if cap > self.settings.reach {
            return Err(Error::out_of_range("the reach of an estimator", cap, "at most that of the maps"));
        }
        let (sensors, mut booked) = (self.scene.sensors(), PhotonReadings::new());
        let mut values = Vec::with_capacity(sensors.len());
        for (number, sensor) in sensors.iter().enumerate() {
            let own = map_orders(sensor).and_then(|range| self.maps.iter().find(|(held, _)| *held == range));
            let Some((_, map)) = own else { continue };
            let of = (self.settings.seed, self.settings.replicate, number);
            let around = (self.scene, self.extents.as_slice());
            values.push(read_bins(around, map, sensor, estimator, of, &mut booked)?);
        }
        let count = values.iter().flatten().filter(|value| !value.is_finite()).count() as u64;
        if count > 0 {
            return Err(Error::NonFinite { count, place: "estimates from photon maps" });
        }
        Ok(MapReading { values, underfull: booked.underfull, gathers: booked.gathers })
    }
}
