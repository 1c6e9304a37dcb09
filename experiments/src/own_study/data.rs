//! What the cells say: errors of every setting, what they take in time, and the rival.

use super::asked::OwnStudy;
use super::measure::{maps_group, reference_group};
use super::place::Place;
use super::points::Point;
use super::reference::{self, BATCHES, Reference, Sampler};
use super::words;
use crate::harness::{Cells, Estimate};
use anyhow::Context;
use turbid::estimators::Estimator;
use turbid::sensor::Spread;
use turbid::stats::{Moments, jackknife, poisson_interval};

/// What a place is compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// The value.
    pub value: f64,
    /// Bound of an exact value, standard error of a sampled one; not a number where the tails of its samples leave none.
    pub error: f64,
    /// Whether it is exact.
    pub is_exact: bool,
    /// What the samples say of it.
    pub sampled: (f64, f64),
}

/// A reference that is not known better than this part of itself is none to measure relative errors by.
const KNOWN: f64 = 0.2;

impl Known {
    /// Whether errors relative to it mean something.
    pub fn is_usable(&self) -> bool {
        self.value != 0.0 && self.error <= KNOWN * self.value.abs()
    }

    /// Relative error that it brings into measured errors: exact bounds are far below all noise.
    pub fn relative(&self) -> f64 {
        (self.error / self.value).abs()
    }
}

/// Maps of so many photons read by one estimator.
pub struct Setting<'a> {
    /// Photons emitted a map.
    pub photons: u64,
    /// How maps are read.
    pub estimator: &'a Estimator,
    /// Values of each place, one a map \[the place's unit\].
    pub values: Vec<Vec<f64>>,
    /// Errors relative to the reference, of the places whose reference is usable: a list a map.
    pub errors: Vec<Vec<f64>>,
    /// Mean square of the references' relative errors, and what they leave uncertain of a mean squared error.
    noise_of_references: (f64, f64),
    /// CPU seconds of filling the maps, and of reading all places.
    pub seconds: [Moments; 2],
    /// Share of estimates that found fewer than k photons.
    pub underfull: f64,
}

/// The rival: whoever samples the reference.
pub struct Rival {
    /// Relative variance of one sample at all places, mean over places.
    pub variance: Estimate,
    /// CPU seconds of one sample at all places.
    pub seconds: f64,
}

/// All that is known of one scene.
pub struct Data<'a> {
    /// The scene.
    pub point: &'a Point,
    /// What it is compared with.
    pub reference: &'a Reference,
    /// The same of each place.
    pub known: Vec<Known>,
    /// All settings, by photons, then by estimators.
    pub settings: Vec<Setting<'a>>,
    /// Photons stored a map, by photons emitted.
    pub stored: Vec<(u64, f64)>,
    /// The rival, where it has an error.
    pub rival: Option<Rival>,
}

/// One half of the maps: choices are made by one, and told by the other, so that luck in choosing is not taken for accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// Maps of even numbers.
    Choosing,
    /// Maps of odd numbers.
    Telling,
    /// All maps.
    Both,
}

impl Half {
    fn of<T: Clone>(self, maps: &[T]) -> Vec<T> {
        let (first, step) = match self {
            Half::Choosing => (0, 2),
            Half::Telling => (1, 2),
            Half::Both => (0, 1),
        };
        maps.iter().skip(first).step_by(step).cloned().collect()
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
    sum / n
}

/// Mean over places of the squared mean error, less what noise adds to it, and of the variance between maps.
fn parts(maps: &[Vec<f64>]) -> (f64, f64) {
    let (count, places) = (maps.len() as f64, maps.first().map_or(0, Vec::len));
    let (mut squares, mut variances) = (0.0, 0.0);
    for place in 0..places {
        let own: Moments = maps.iter().map(|errors| errors[place]).collect::<Vec<f64>>().iter().collect();
        squares += own.mean() * own.mean() - own.variance() / count;
        variances += own.variance();
    }
    (squares / places as f64, variances / places as f64)
}

impl Setting<'_> {
    /// Mean squared errors of the maps, over places.
    pub fn squares(&self, half: Half) -> Vec<f64> {
        let square = |errors: &Vec<f64>| mean(errors.iter().map(|e| e * e));
        half.of(&self.errors).iter().map(square).collect()
    }

    /// What the references add to each of them.
    pub fn floor(&self) -> f64 {
        self.noise_of_references.0
    }

    /// Root mean square error over places, of one map: never less than its noise, where the references' errors would leave less.
    pub fn rmse(&self, half: Half) -> Estimate {
        let (floor, error) = self.noise_of_references;
        let maps = half.of(&self.errors);
        let square = if parts(&maps).0 > floor {
            let squares: Moments = self.squares(half).iter().collect();
            Estimate::mean(&squares).minus(floor)
        } else if maps.len() < 3 {
            // A variance of two maps has an error that no map tells.
            Estimate::resampled(parts(&maps).1, f64::INFINITY, maps.len() as u64)
        } else {
            Estimate::jackknife(&jackknife(&maps, |maps| parts(maps).1))
        };
        square.with_reference_error(error).root()
    }

    /// Root mean square over places of the mean error.
    pub fn bias(&self) -> Estimate {
        let (floor, error) = self.noise_of_references;
        let squared = jackknife(&self.errors, |maps| parts(maps).0);
        Estimate::jackknife(&squared).minus(floor).with_reference_error(error).root()
    }

    /// Root mean square over places of the standard deviation between maps.
    pub fn noise(&self) -> Estimate {
        Estimate::jackknife(&jackknife(&self.errors, |maps| parts(maps).1)).root()
    }

    /// CPU seconds of filling a map and reading all places.
    pub fn time(&self) -> f64 {
        self.seconds[0].mean() + self.seconds[1].mean()
    }

    /// Photons with which a fixed radius reaches an error, if its bias is below: its variance falls as one over them, exactly, since
    /// histories are independent. None for the k nearest, whose bias changes with the photons.
    pub fn photons_for(&self, target: f64) -> Option<f64> {
        let (squared, variance) = parts(&self.errors);
        let left = target * target - (squared - self.floor()).max(0.0);
        (words::is_fixed(self.estimator) && left > 0.0).then(|| self.photons as f64 * variance / left)
    }
}

impl Rival {
    /// Its error after so many CPU seconds.
    pub fn error_at(&self, seconds: f64) -> f64 {
        (self.variance.value() * self.seconds / seconds).sqrt()
    }

    /// CPU seconds to an error.
    pub fn time_to(&self, error: f64) -> f64 {
        self.variance.value() * self.seconds / (error * error)
    }
}

impl<'a> Data<'a> {
    /// Reads the cells of one scene.
    ///
    /// # Errors
    /// If a cell has no such number
    pub fn new(study: &'a OwnStudy, number: usize, cells: &Cells) -> anyhow::Result<Self> {
        let (point, reference) = (&study.points[number], &study.references[number]);
        let case = words::reference(point);
        let mut known = Vec::with_capacity(point.places.len());
        for (place, exact) in point.places.iter().zip(&reference.exact) {
            let sampled = cells.moments(&case, &place.name)?;
            let error = match is_known(cells, (point, place), reference)? {
                false => f64::NAN,
                // Histories that are all alike: another one among them would be rarer than 3 of all.
                true if reference.sampler == Sampler::Light && sampled.variance() == 0.0 => {
                    let histories = (BATCHES * reference.samples) as f64;
                    sampled.mean().abs() * poisson_interval(0, 0.95).high / histories
                }
                true => sampled.std_error(),
            };
            let sampled = (sampled.mean(), error);
            let (value, error) = exact.unwrap_or(sampled);
            known.push(Known { value, error, is_exact: exact.is_some(), sampled });
        }
        let is_counted = |&place: &usize| known[place].is_usable() && point.is_main(&point.places[place]);
        let usable: Vec<usize> = (0..known.len()).filter(is_counted).collect();
        let rival = rival(cells, (point, reference, number), &known, &usable)?;
        let (mut settings, mut stored) = (Vec::new(), Vec::new());
        for &photons in &study.photons {
            let group = maps_group(number, photons);
            let held = cells.moments(&words::maps(point, photons), "photons stored")?;
            stored.push((photons, held.mean()));
            let seconds = |phase: &str| cells.seconds(&group, phase).iter().collect::<Moments>();
            for (number, estimator) in point.estimators.iter().enumerate() {
                let case = words::case(point, photons, estimator);
                let values = point.places.iter().map(|place| cells.values(&case, &place.name));
                let values = values.collect::<anyhow::Result<Vec<_>>>()?;
                let (errors, noise_of_references) = errors(&values, &known, &usable);
                let underfull = cells.moments(&case, "under-full share")?.mean();
                settings.push(Setting {
                    photons,
                    estimator,
                    values,
                    errors,
                    noise_of_references,
                    seconds: [seconds(words::FILLING), seconds(&words::reading(number))],
                    underfull,
                });
            }
        }
        Ok(Data { point, reference, known, settings, stored, rival })
    }

    /// Places whose errors are measured.
    pub fn usable(&self) -> usize {
        let places = self.point.places.iter().zip(&self.known);
        places.filter(|(place, known)| known.is_usable() && self.point.is_main(place)).count()
    }

    /// Settings of one family that are best by the choosing half, one a number of photons.
    pub fn best(&self, family: &str) -> Vec<&Setting<'a>> {
        let sizes: Vec<u64> = self.stored.iter().map(|(photons, _)| *photons).collect();
        let own = |photons: u64| {
            let own = self.settings.iter().filter(move |s| s.photons == photons);
            own.filter(|s| words::family(s.estimator) == family)
        };
        let square = |s: &Setting| mean(s.squares(Half::Choosing).into_iter());
        let least = |photons: u64| own(photons).min_by(|a, b| square(a).total_cmp(&square(b)));
        sizes.into_iter().filter_map(least).collect()
    }

    /// A setting's errors at the places of another group, if the reference of any is usable.
    pub fn of_group(&self, setting: &Setting<'a>, group: &str) -> Option<Setting<'a>> {
        let is_own =
            |&place: &usize| self.point.places[place].group == group && self.known[place].is_usable();
        let usable: Vec<usize> = (0..self.known.len()).filter(is_own).collect();
        let (errors, noise_of_references) = errors(&setting.values, &self.known, &usable);
        (!usable.is_empty()).then(|| Setting {
            errors,
            noise_of_references,
            values: Vec::new(),
            seconds: setting.seconds,
            ..*setting
        })
    }

    /// The families, in the order of the file.
    pub fn families(&self) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for name in self.point.estimators.iter().map(words::family) {
            if !all.contains(&name) {
                all.push(name);
            }
        }
        all
    }

    /// The setting that reaches an error in the least time, by the choosing half.
    pub fn cheapest(&self, target: f64) -> Option<&Setting<'a>> {
        // References that are not known to the target cannot tell that it is reached.
        let known = self.settings.iter().filter(|s| s.floor() < target * target);
        let reaching = known.filter(|s| s.rmse(Half::Choosing).value() <= target);
        reaching.min_by(|a, b| a.time().total_cmp(&b.time()))
    }

    /// The setting of the least error, by the choosing half.
    pub fn most_accurate(&self) -> Option<&Setting<'a>> {
        let error = |s: &Setting| s.rmse(Half::Choosing).value();
        self.settings.iter().min_by(|a, b| error(a).total_cmp(&error(b)))
    }

    /// The setting of the least error for each number of photons, as far as it beats all cheaper ones, by the choosing half.
    pub fn frontier(&self) -> Vec<&Setting<'a>> {
        let error = |s: &Setting| s.rmse(Half::Choosing).value();
        let best = |&(photons, _): &(u64, f64)| {
            let own = self.settings.iter().filter(|s| s.photons == photons);
            own.min_by(|a, b| error(a).total_cmp(&error(b)))
        };
        let mut all: Vec<&Setting> = self.stored.iter().filter_map(best).collect();
        all.sort_by(|a, b| a.time().total_cmp(&b.time()));
        let mut least = f64::INFINITY;
        all.retain(|setting| {
            let is_better = error(setting) < least;
            least = least.min(error(setting));
            is_better
        });
        all
    }
}

/// Errors relative to the reference at some places, a list a map, and what the references' own errors add to them.
fn errors(values: &[Vec<f64>], known: &[Known], usable: &[usize]) -> (Vec<Vec<f64>>, (f64, f64)) {
    let maps = values.first().map_or(0, Vec::len);
    let error = |map: usize, place: usize| values[place][map] / known[place].value - 1.0;
    let errors: Vec<Vec<f64>> =
        (0..maps).map(|map| usable.iter().map(|&place| error(map, place)).collect()).collect();
    let noise = noise(&errors, known, usable);
    (errors, noise)
}

/// Mean square of the references' relative errors, and the standard error that they leave of a mean squared error: they are the
/// same for all maps, and add twice the bias times their own.
fn noise(errors: &[Vec<f64>], known: &[Known], usable: &[usize]) -> (f64, f64) {
    let places = usable.len() as f64;
    let (mut floor, mut variance) = (0.0, 0.0);
    for (index, &place) in usable.iter().enumerate().filter(|(_, place)| !known[**place].is_exact) {
        let bias = mean(errors.iter().map(|map| map[index]));
        let square = known[place].relative().powi(2);
        floor += square;
        variance += 4.0 * bias * bias * square + 2.0 * square * square;
    }
    (floor / places, variance.sqrt() / places)
}

/// Whether the batches of a place have a standard error together; those of a block of pixels tell nothing of it.
fn is_known(cells: &Cells, (point, place): (&Point, &Place), reference: &Reference) -> anyhow::Result<bool> {
    if point.picture.is_some() {
        return Ok(true);
    }
    let [errors, vovs, contributing, heavy] = words::spread(point);
    let values = |case: &str| cells.values(case, &place.name);
    let (errors, vovs, heavy) = (values(&errors)?, values(&vovs)?, values(&heavy)?);
    let paths = match reference.sampler {
        Sampler::Paths => values(&contributing)?.into_iter().map(|paths| Some(paths as u64)).collect(),
        Sampler::Light => vec![None; errors.len()],
    };
    let spreads = errors.into_iter().zip(vovs).zip(heavy).zip(paths);
    let spread = |(((std_error, vov), heavy), contributing)| Spread {
        std_error,
        vov,
        contributing,
        is_heavy: heavy > 0.0,
    };
    Ok(reference::is_known(&spreads.map(spread).collect::<Vec<_>>(), reference.samples))
}

fn rival(
    cells: &Cells,
    (point, reference, number): (&Point, &Reference, usize),
    known: &[Known],
    usable: &[usize],
) -> anyhow::Result<Option<Rival>> {
    let case = words::reference(point);
    // A rival without an error of its own is none.
    let usable: Vec<usize> =
        usable.iter().copied().filter(|&place| !known[place].sampled.1.is_nan()).collect();
    let values = usable.iter().map(|&place| cells.values(&case, &point.places[place].name));
    let values = values.collect::<anyhow::Result<Vec<_>>>()?;
    let batches: Vec<Vec<f64>> = (0..BATCHES as usize)
        .map(|batch| values.iter().zip(&usable).map(|(v, &place)| v[batch] / known[place].value).collect())
        .collect();
    let seconds: Moments = cells.seconds(&reference_group(number), words::SAMPLING).iter().collect();
    if usable.is_empty() || seconds.n() == 0 {
        return Ok(None);
    }
    let variance = Estimate::jackknife(&jackknife(&batches, |maps| parts(maps).1));
    let samples = reference.samples as f64;
    Ok(Some(Rival { variance: variance.times(samples), seconds: seconds.mean() / samples }))
}

/// The data of all scenes.
///
/// # Errors
/// As [`Data::new`]
pub fn all<'a>(study: &'a OwnStudy, cells: &Cells) -> anyhow::Result<Vec<Data<'a>>> {
    (0..study.points.len())
        .map(|number| Data::new(study, number, cells).with_context(|| study.points[number].label.clone()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use turbid::estimators::{Gather, Kernel};
    use turbid::rng::{Purpose, Stream};

    /// Maps of known bias and noise against references that are off by their own error: the root mean square error is never below the
    /// noise, and not above both by more than its own error allows.
    #[test]
    fn errors_are_not_less_than_their_noise() {
        let estimator = Estimator::new(Kernel::Uniform, Gather::radius(1.0).unwrap());
        let (bias, noise, places, reference) = (0.02, 0.05, 5, 0.06);
        let mut normal = {
            let mut stream = Stream::new(23, Purpose::Synthetic, 0, 0);
            // The sum of twelve numbers in [0, 1) has the variance 1.
            move || (0..12).map(|_| stream.unit()).sum::<f64>() - 6.0
        };
        let mut within = 0;
        for _ in 0..200 {
            let off: Vec<f64> = (0..places).map(|_| reference * normal()).collect();
            let errors: Vec<Vec<f64>> =
                (0..16).map(|_| off.iter().map(|off| bias + noise * normal() - off).collect()).collect();
            let known: Vec<Known> = (0..places)
                .map(|_| Known { value: 1.0, error: reference, is_exact: false, sampled: (1.0, reference) })
                .collect();
            let noise_of_references = super::noise(&errors, &known, &(0..places).collect::<Vec<_>>());
            let setting = Setting {
                photons: 1,
                estimator: &estimator,
                values: Vec::new(),
                errors,
                noise_of_references,
                seconds: [Moments::new(); 2],
                underfull: 0.0,
            };
            let (rmse, own) = (setting.rmse(Half::Both), setting.noise());
            assert!(rmse.value() >= 0.95 * own.value(), "{} below {}", rmse.value(), own.value());
            let truth = (bias * bias + noise * noise).sqrt();
            within += usize::from((rmse.value() - truth).abs() < 2.0 * rmse.std_error());
        }
        assert!(within >= 170, "{within} of 200");
    }
}
