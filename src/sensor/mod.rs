//! Sensors: what paths and photons read of a scene, one mean with its standard error a number; and pictures, a mean
//! with its variance a pixel and layer.

mod advise;
mod bidirectional;
mod compare;
mod film;
mod from_maps;
mod light;
mod maps;
mod method;
mod order_maps;
mod paths;
mod photons;
mod picture_advice;
mod reach;
mod render;
mod tallies;
mod view;

pub use crate::scene::{Camera, Filter, View};
pub use advise::{Advice, MIN_MAPS, PathAdvice, Pilot, PilotSettings, path_advice};
pub use compare::{
    BlockMean, BlockTest, Blocks, Comparison, LEVEL, PictureError, VALUES, compare, luminance_errors,
};
pub use film::{Film, Pixel, Sample};
pub use from_maps::PhotonReadings;
pub use light::{LIGHT_BYTES, LIGHT_PIXEL_BYTES, LightCount, by_light, extend_by_light};
pub use maps::{MapReading, MapSettings, SensorMaps, usual_reach};
pub use method::Method;
pub use order_maps::{FluenceMaps, RadianceMaps};
pub use paths::{
    PathSettings, by_bidirectional_paths, by_guided_paths, by_paths, check_paths, sample, sample_bin,
    sample_counted, sample_guided,
};
pub use photons::{
    PhotonForecast, PhotonSettings, by_given_photons, by_photons, by_photons_in_passes, forecast,
    given_bytes, is_answered_by_map,
};
pub use picture_advice::{PictureAdvice, PicturePilot, PicturePilotSettings};
pub use render::{MAX_SAMPLES, Streams, extend};
pub use tallies::{TallyReadings, TallySettings, by_tallies, tally_bytes};
pub use view::{check_camera, colour, draw_photons};

use crate::Spectrum;
use crate::scene::{Binned, Quantity, Scene, Sensor, Space};
use crate::stats::{HEAVY_TAIL, Moments, Tail, poisson_interval};

/// A measured number.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Measurement {
    /// Name of the sensor.
    pub sensor: String,
    /// Name of the quantity, with `.r`, `.g`, `.b` where channels differ.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// Estimate.
    pub mean: f64,
    /// Standard error of the mean; none where nothing is known of it. A tally of no event, or of one in every history,
    /// has that of its 95 per cent bound, 3 events.
    pub std_error: Option<f64>,
    /// Independent histories or maps behind it.
    pub n: u64,
    /// Why it has no standard error, if it has none.
    #[serde(rename = "why")]
    pub no_error: Option<NoError>,
    /// Which bin of the sensor it is of, if the sensor has bins.
    #[serde(skip)]
    pub bin: Option<Bin>,
    /// How well the standard error itself is known.
    #[serde(skip)]
    pub spread: Spread,
}

/// What contributions say of the variance of their mean, for whoever puts several measurements together: of one alone
/// [`Measurement::std_error`] says whether it has an error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Standard error of the mean, whether or not it can be trusted.
    pub std_error: f64,
    /// Relative variance of the variance.
    pub vov: f64,
    /// Paths that brought something; none where contributions are not of paths.
    pub contributing: Option<u64>,
    /// Whether the largest contributions of paths have too heavy a tail ([`Tail::is_heavy`]).
    pub is_heavy: bool,
}

impl Spread {
    fn of(m: &Moments, tail: Option<&Tail>) -> Self {
        Spread {
            std_error: m.std_error(),
            vov: m.vov(),
            contributing: tail.map(Tail::contributing),
            is_heavy: tail.is_some_and(|tail| tail.is_heavy(m)),
        }
    }
}

/// Which of a sensor's bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Its number along each axis, from 0.
    pub index: [usize; 3],
    /// Its middle \[L\]; none of a region.
    pub middle: Option<[f64; 3]>,
}

impl Bin {
    fn of(binned: &Binned, number: usize) -> Self {
        let [ni, nj, _] = binned.count();
        let middle = match binned {
            Binned::Fluence { space: Space::Shape(_), .. }
            | Binned::Absorption { space: Space::Shape(_), .. } => None,
            _ => Some(binned.point(number, None, [0.5; 3]).to_array()),
        };
        Bin { index: [number % ni, number / ni % nj, number / (ni * nj)], middle }
    }
}

/// Memory of the measurements of all bins \[bytes\]: each with its two names, and what the allocator adds to them.
pub fn row_bytes(scene: &Scene) -> f64 {
    let bins: usize = scene.sensors().iter().filter_map(Sensor::binned).map(Binned::bins).sum();
    let channels = if scene.plan().is_grey { 1 } else { 3 };
    (bins * channels * (size_of::<Measurement>() + 2 * 32)) as f64
}

/// Room for the measurements of all sensors: a vector that grows would be there twice.
fn room(scene: &Scene) -> Vec<Measurement> {
    let bins = scene.sensors().iter().map(|s| s.binned().map_or(1, Binned::bins));
    let channels = if scene.plan().is_grey { 1 } else { 3 };
    Vec::with_capacity(channels * bins.sum::<usize>())
}

/// Why a measurement has no standard error; CSV and JSON have the words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoError {
    /// There is one photon map, whose estimates share its photons.
    OneMap,
    /// Nothing was found: no path brought anything, no map has a photon there.
    Nothing,
    /// Fewer than [`FEWEST_PATHS`] paths brought something, fewer than 10 photon histories something to a bin, one map
    /// alone, or there is one history.
    TooFew,
    /// The variance is too uncertain: its own relative variance is above 0.1, or the largest contributions carry it and have the
    /// tail of a distribution whose mean they have not settled ([`Tail::is_heavy`]).
    HeavyTail,
}

impl serde::Serialize for NoError {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.word())
    }
}

impl NoError {
    /// The word that stands in the place of the number.
    pub const fn word(self) -> &'static str {
        match self {
            NoError::OneMap => "one-map",
            NoError::Nothing => "nothing-found",
            NoError::TooFew => "too-few",
            NoError::HeavyTail => "heavy-tail",
        }
    }

    /// What it means, for a note.
    pub fn reason(self) -> String {
        match self {
            NoError::OneMap => "the estimates of one map share its photons: ask for several".into(),
            NoError::Nothing => "nothing was found, so that the value could be any small one".into(),
            NoError::TooFew => {
                format!("fewer than {FEWEST_PATHS} paths or 10 photons contribute, or one map or history alone")
            }
            NoError::HeavyTail => {
                "rare large contributions carry the mean, and too few of them were drawn to trust the mean itself".into()
            }
        }
    }
}

/// Who brought the numbers of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    /// Paths.
    Paths,
    /// Photon histories, each of which brings its power or none of it.
    Tally,
    /// Photon histories, each of which brings anything to a bin, most of them nothing.
    Scores,
    /// Photon maps.
    Maps,
}

/// Fewest numbers whose variance of variance says something of their tail: that of normal ones is about 2/n.
pub const TELLS_TAIL: u64 = 100;

fn is_heavy_tailed(m: &Moments) -> bool {
    m.n() >= TELLS_TAIL && m.is_heavy_tailed()
}

/// Fewest paths that bring something for their mean to have a standard error: where fewer do, those that would carry the
/// mean may not have been drawn at all, and nothing in what was drawn says so.
pub const FEWEST_PATHS: u64 = 1000;

/// Equal values that one value different from them would be as good as, (sum x)^2 / sum x^2: 1 if one alone is not 0.
fn effective_number(m: &Moments) -> f64 {
    let n = m.n() as f64;
    let squares = m.mean() * m.mean() + m.variance() * (n - 1.0) / n;
    if squares == 0.0 { 0.0 } else { n * m.mean() * m.mean() / squares }
}

/// The standard error of a mean, or why it has none; paths tell their tail.
fn std_error(m: &Moments, spread: &Spread, source: Source) -> Result<f64, NoError> {
    let brought_nothing = m.mean() == 0.0 && (m.n() < 2 || m.variance() == 0.0);
    match source {
        Source::Tally if m.n() < 2 => Err(NoError::TooFew),
        // All alike: each history brings its power or none of it.
        Source::Tally if m.variance() == 0.0 => Ok(poisson_interval(0, 0.95).high / m.n() as f64),
        Source::Tally => Ok(m.std_error()),
        Source::Scores if m.n() < 2 => Err(NoError::TooFew),
        Source::Scores if m.mean() == 0.0 && m.variance() == 0.0 => Err(NoError::Nothing),
        // All alike, as a beam's photons on their first flight: another one among them would have been rarer than 3 of all.
        Source::Scores if m.variance() == 0.0 => {
            Ok(m.mean().abs() * poisson_interval(0, 0.95).high / m.n() as f64)
        }
        // The variance of variance of k equal contributions among many histories is 1/k.
        Source::Scores if m.is_heavy_tailed() && effective_number(m) < 1.0 / HEAVY_TAIL => {
            Err(NoError::TooFew)
        }
        Source::Scores if m.is_heavy_tailed() => Err(NoError::HeavyTail),
        Source::Scores => Ok(m.std_error()),
        Source::Paths | Source::Maps if brought_nothing => Err(NoError::Nothing),
        Source::Maps if m.n() < 2 => Err(NoError::OneMap),
        // Between that of one map, 1, and that of two, 2.
        Source::Maps if effective_number(m) < 1.5 => Err(NoError::TooFew),
        Source::Paths if spread.contributing.is_some_and(|paths| paths < FEWEST_PATHS) => {
            Err(NoError::TooFew)
        }
        _ if is_heavy_tailed(m) || spread.is_heavy => Err(NoError::HeavyTail),
        _ => Ok(m.std_error()),
    }
}

/// The measurements of one sensor: one where the scene is grey, otherwise one a channel. Paths tell the tails of their
/// contributions.
fn measurements(
    scene: &Scene,
    sensor: &Sensor,
    moments: &[Moments; 3],
    tails: Option<&[Tail; 3]>,
    source: Source,
    bin: Option<usize>,
) -> Vec<Measurement> {
    // The power that parts of it are divided by may be known to an error of its own.
    let of_power = match sensor.quantity {
        Quantity::Outflow { .. } | Quantity::Absorbed(_) => scene.power_error(),
        Quantity::Fluence(_) | Quantity::Radiance(_) | Quantity::Binned(_) => Spectrum::ZERO,
    };
    let bin = sensor.binned().zip(bin).map(|(binned, number)| Bin::of(binned, number));
    let suffixes: &[&str] = if scene.plan().is_grey { &[""] } else { &[".r", ".g", ".b"] };
    suffixes
        .iter()
        .enumerate()
        .map(|(channel, suffix)| {
            let m = &moments[channel];
            let spread = Spread::of(m, tails.map(|tails| &tails[channel]));
            let error = std_error(m, &spread, source);
            let error = error.map(|error| libm::hypot(error, of_power[channel] * m.mean()));
            Measurement {
                sensor: sensor.name.clone(),
                quantity: format!("{}{suffix}", sensor.label),
                unit: sensor.unit(),
                mean: m.mean(),
                std_error: error.ok(),
                n: m.n(),
                no_error: error.err(),
                bin,
                spread,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64], source: Source) -> Result<f64, NoError> {
        let mut tail = Tail::default();
        values.iter().for_each(|x| tail.push(*x));
        let tail = (source == Source::Paths).then_some(&tail);
        let moments = values.iter().collect();
        std_error(&moments, &Spread::of(&moments, tail), source)
    }

    #[test]
    fn maps_that_found_nothing_have_no_error() {
        assert_eq!(of(&[0.0; 10], Source::Maps), Err(NoError::Nothing));
        assert_eq!(of(&[0.0], Source::Maps), Err(NoError::Nothing));
        assert_eq!(of(&[1.0], Source::Maps), Err(NoError::OneMap));
        let one_in_ten = [0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(of(&one_in_ten, Source::Maps), Err(NoError::TooFew));
        assert!(of(&[0.0, 1.0, 0.0, 1.0], Source::Maps).is_ok());
        assert!((of(&[1.0, 3.0], Source::Maps).unwrap() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn tallies_that_are_all_alike_have_the_error_of_three_events() {
        for value in [0.0, 1.0] {
            let error = of(&[value; 1000], Source::Tally).unwrap();
            assert!((error - 0.003).abs() < 1e-5, "{error}");
            assert_eq!(of(&[value], Source::Tally), Err(NoError::TooFew));
        }
    }

    #[test]
    fn scores_of_few_photons_have_no_error() {
        let some = |values: &[f64]| {
            let zeros = std::iter::repeat_n(0.0, 10_000 - values.len());
            of(&values.iter().copied().chain(zeros).collect::<Vec<_>>(), Source::Scores)
        };
        assert_eq!((some(&[]), some(&[2.0; 9])), (Err(NoError::Nothing), Err(NoError::TooFew)));
        assert!(some(&[2.0; 11]).is_ok());
        let rare: Vec<f64> = (0..200).map(|i| if i < 3 { 50.0 } else { 1.0 }).collect();
        assert_eq!(some(&rare), Err(NoError::HeavyTail));
        // A net flux of nothing is known as well as the parts that it is made of.
        let both: Vec<f64> = (0..200).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!((some(&both).unwrap() - (200.0f64).sqrt() / 10_000.0).abs() < 1e-6);
        let alike = of(&[4.0; 1000], Source::Scores).unwrap();
        assert!((alike - 0.012).abs() < 4e-5, "{alike}");
    }

    #[test]
    fn a_thousand_paths_must_contribute() {
        let some = |bring: usize| {
            let values: Vec<f64> = (0..5000).map(|i| if i < bring { 1.0 } else { 0.0 }).collect();
            of(&values, Source::Paths)
        };
        assert_eq!((some(0), some(999)), (Err(NoError::Nothing), Err(NoError::TooFew)));
        assert!(some(1000).is_ok());
    }
}
