//! The file in which a user asks: TOML, strict.

use anyhow::{Context, anyhow, bail, ensure};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use turbid::estimators::boundary::{Rejection, Treatment};
use turbid::estimators::{BeamBlur, Estimator, Gather, Kernel, RayEnds};
use turbid::input::line_and_column;
use turbid::math::Positive;
use turbid::photons::beams::BeamLength;
use turbid::scene::toml_message;

/// A study as its file says it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Heading of the report, which the report reads.
    #[serde(default, rename = "title")]
    _title: Option<String>,
    /// The scene.
    pub scene: StudyScene,
    /// Keys of the scene with the values that each takes; every combination is studied.
    #[serde(default)]
    pub axes: BTreeMap<String, Vec<toml::Value>>,
    /// What is measured; all sensors of the scene that maps answer if absent.
    #[serde(default = "everything")]
    pub measure: MeasureFile,
    /// How maps are read; a ladder of k if absent.
    #[serde(default)]
    pub estimators: Vec<EstimatorFile>,
    /// Photons emitted, a set of maps each.
    #[serde(deserialize_with = "one_or_more")]
    pub photons: Vec<Count>,
    /// Independent maps of each number of photons.
    #[serde(default = "sixteen")]
    pub maps: Count,
    /// Root mean square error that is asked for, relative to the reference \[1\].
    #[serde(default = "tenth")]
    pub target: f64,
    /// What the maps are compared with.
    #[serde(default)]
    pub reference: ReferenceFile,
}

/// The scene of a study.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "toml::Value")]
pub enum StudyScene {
    /// A scene file, relative to the study's, or a built-in scene.
    Name(String),
    /// What a scene file would hold.
    Table(toml::Table),
}

impl TryFrom<toml::Value> for StudyScene {
    type Error = String;
    fn try_from(value: toml::Value) -> Result<Self, String> {
        match value {
            // Standard input is not a file that a later run can read again.
            toml::Value::String(name) if name != "-" => Ok(StudyScene::Name(name)),
            toml::Value::Table(table) => Ok(StudyScene::Table(table)),
            other => Err(format!(
                "the value is {other}; allowed: a scene file, a built-in scene, or the scene itself as a table"
            )),
        }
    }
}

fn everything() -> MeasureFile {
    MeasureFile {
        sensors: None,
        probes: Vec::new(),
        lattice: None,
        rays: Vec::new(),
        picture: None,
        readings: sixteen(),
        min_order: None,
        max_order: None,
    }
}

/// Most readings of a ray or a bin.
const MOST_READINGS: u64 = 10_000;

fn sixteen() -> Count {
    Count(16)
}

fn tenth() -> f64 {
    0.1
}

/// A whole number, also as 1e5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "f64")]
pub struct Count(pub u64);

impl TryFrom<f64> for Count {
    type Error = String;
    fn try_from(x: f64) -> Result<Self, String> {
        if x.fract() == 0.0 && (1.0..=1e12).contains(&x) {
            Ok(Count(x as u64))
        } else {
            Err(format!("{x} is not a count; allowed: whole numbers from 1 to 1e12, such as 1e5"))
        }
    }
}

/// What is measured beside the sensors of the scene.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasureFile {
    /// Sensors of the scene by their names.
    #[serde(default)]
    pub sensors: Option<Vec<String>>,
    /// Points at which fluence is measured \[L\].
    #[serde(default)]
    pub probes: Vec<[f64; 3]>,
    /// The same on a lattice.
    #[serde(default)]
    pub lattice: Option<Lattice>,
    /// Rays along which radiance is measured.
    #[serde(default)]
    pub rays: Vec<RayFile>,
    /// The camera's picture, in the place of all sensors.
    #[serde(default)]
    pub picture: Option<PictureFile>,
    /// Marches along each ray, and sets of points in each bin, that one reading of a map is the mean of.
    #[serde(default = "sixteen")]
    pub readings: Count,
    /// Smallest order of scattering that counts for probes and rays.
    #[serde(default)]
    pub min_order: Option<u32>,
    /// Largest order of scattering that counts for probes and rays.
    #[serde(default)]
    pub max_order: Option<u32>,
}

impl MeasureFile {
    /// Whether points or rays are named.
    pub fn is_of_points(&self) -> bool {
        !self.probes.is_empty() || self.lattice.is_some() || !self.rays.is_empty()
    }
}

/// The camera's picture, in blocks of pixels, by layer.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureFile {
    /// Pixels across; at most 48 if absent.
    #[serde(default)]
    pub width: Option<Count>,
    /// Pixels down; as the camera's sides are to each other if absent.
    #[serde(default)]
    pub height: Option<Count>,
    /// Samples a pixel of pictures from maps.
    #[serde(default = "four")]
    pub samples: Count,
    /// Blocks across and down, whose means are measured.
    #[serde(default = "blocks")]
    pub blocks: [u32; 2],
    /// Rays of a final gathering; 0 reads the global map where the eye looks.
    #[serde(default)]
    pub gather_rays: u32,
}

fn four() -> Count {
    Count(4)
}

fn blocks() -> [u32; 2] {
    [6, 4]
}

/// Points of equal distances.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// First point \[L\].
    pub from: [f64; 3],
    /// Last point \[L\].
    pub to: [f64; 3],
    /// Points along each axis.
    pub count: [usize; 3],
}

/// A ray.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayFile {
    /// Where it starts \[L\].
    pub origin: [f64; 3],
    /// Where it looks.
    pub dir: [f64; 3],
}

/// One or several values of a key.
#[derive(Debug, Clone)]
pub struct OneOrMore<T>(Vec<T>);

impl<T: Clone> OneOrMore<T> {
    fn list(&self) -> Vec<T> {
        self.0.clone()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMore<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // As a value first, so that what is wrong with one value is said, and not that it is neither one nor several.
        let several = match toml::Value::deserialize(deserializer)? {
            toml::Value::Array(list) => list,
            one => vec![one],
        };
        let read = |value: toml::Value| T::deserialize(value).map_err(|e| D::Error::custom(e.message()));
        several.into_iter().map(read).collect::<Result<_, _>>().map(OneOrMore)
    }
}

fn one_or_more<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    OneOrMore::deserialize(deserializer).map(|given| given.0)
}

/// Estimators: every combination of the values of their keys.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EstimatorFile {
    /// Kernels by name; uniform if absent.
    #[serde(default)]
    kernel: Option<OneOrMore<String>>,
    /// Fixed radii \[L\].
    #[serde(default)]
    radius: Option<OneOrMore<f64>>,
    /// Radii about whole rays, which are then read at once \[L\]; at points balls of the same radius.
    #[serde(default)]
    ray_radius: Option<OneOrMore<f64>>,
    /// Which nearest other photon sets the radius of each about rays, at most `ray_radius`.
    #[serde(default)]
    ray_k: Option<OneOrMore<Count>>,
    /// The same from flights as beams \[L\].
    #[serde(default)]
    beam_radius: Option<OneOrMore<f64>>,
    /// Dimensions that beams are blurred in, by name; 1d if absent.
    #[serde(default)]
    beam_blur: Option<OneOrMore<String>>,
    /// How far beams go, by name, the same for all of a study; sampled if absent.
    #[serde(default)]
    beam_length: Option<String>,
    /// Whether sensors of fluence are read from these beams too, in place of from photons in balls.
    #[serde(default)]
    beam_fluence: bool,
    /// Where rays that are read at once end, by name; cut if absent.
    #[serde(default)]
    ray_ends: Option<OneOrMore<String>>,
    /// Whether light that is scattered twice and more is read from planes of flights, beside these beams.
    #[serde(default)]
    planes: bool,
    /// Numbers of nearest photons.
    #[serde(default)]
    k: Option<OneOrMore<Count>>,
    /// The farthest that the k nearest are sought \[L\].
    #[serde(default)]
    max_radius: Option<f64>,
    /// Treatments of boundaries by name; clipped if absent.
    #[serde(default)]
    treatment: Option<OneOrMore<String>>,
    /// Rejections of false photons by name; off if absent.
    #[serde(default)]
    rejection: Option<OneOrMore<String>>,
}

/// What the maps are compared with.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReferenceFile {
    /// Who says it.
    pub with: ReferenceBy,
    /// Relative standard error that sampled references are to have \[1\], root mean square over places.
    pub error: f64,
    /// Most paths a place, or photons of light tracing.
    pub most: Count,
}

impl Default for ReferenceFile {
    fn default() -> Self {
        ReferenceFile { with: ReferenceBy::Auto, error: 0.01, most: Count(1 << 20) }
    }
}

/// Who says the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceBy {
    /// Exact values where the scene is a solved problem, else whoever of paths and light tracing is better known.
    Auto,
    /// The path tracer.
    Paths,
    /// Light tracing: sensors with bins alone.
    Light,
}

/// Most estimators of a study.
const MOST_ESTIMATORS: usize = 1000;

/// A name of a list, or what is allowed.
fn named<T: Copy>(what: &str, word: &str, all: &[T], name: impl Fn(T) -> &'static str) -> anyhow::Result<T> {
    all.iter().copied().find(|x| name(*x) == word).with_context(|| {
        let names: Vec<&str> = all.iter().map(|x| name(*x)).collect();
        format!("{what} is {word:?}; allowed: {}", names.join(", "))
    })
}

impl EstimatorFile {
    /// The estimators; the k nearest are sought within `cap` where the file does not say.
    fn all(&self, cap: f64) -> anyhow::Result<Vec<Estimator>> {
        let words = |given: &Option<OneOrMore<String>>, usual: &str| {
            given.as_ref().map_or_else(|| vec![usual.to_string()], OneOrMore::list)
        };
        let mut gathers = Vec::new();
        for radius in self.radius.iter().flat_map(OneOrMore::list) {
            gathers.push(Gather::radius(radius)?);
        }
        for k in self.k.iter().flat_map(OneOrMore::list) {
            gathers.push(Gather::nearest(k.0 as usize, self.max_radius.unwrap_or(cap))?);
        }
        let mut about_rays = Vec::new();
        for radius in self.ray_radius.iter().flat_map(OneOrMore::list) {
            about_rays.push(Positive::new("ray_radius", radius)?);
        }
        let mut across_beams = Vec::new();
        for radius in self.beam_radius.iter().flat_map(OneOrMore::list) {
            across_beams.push(Positive::new("beam_radius", radius)?);
        }
        ensure!(
            !(gathers.is_empty() && about_rays.is_empty() && across_beams.is_empty()),
            "neither radius, ray_radius, beam_radius nor k; allowed: a list of any of them"
        );
        ensure!(
            self.max_radius.is_none() || self.k.is_some(),
            "max_radius goes with k; a fixed radius is its own"
        );
        let ks = self.ray_k.iter().flat_map(OneOrMore::list).map(|k| NonZeroUsize::new(k.0 as usize));
        let own: Vec<NonZeroUsize> = ks.collect::<Option<_>>().context("ray_k is 0; allowed: at least 1")?;
        ensure!(
            own.is_empty() || !about_rays.is_empty(),
            "ray_k goes with ray_radius, which no radius exceeds"
        );
        let is_of_beams =
            self.beam_blur.is_some() || self.beam_length.is_some() || self.beam_fluence || self.planes;
        ensure!(
            !is_of_beams || !across_beams.is_empty(),
            "beam_blur, beam_length, beam_fluence and planes say how beams are read; allowed: with beam_radius"
        );
        ensure!(
            self.ray_ends.is_none() || !(about_rays.is_empty() && across_beams.is_empty()),
            "ray_ends says where rays end that are read at once; allowed: with ray_radius or beam_radius"
        );
        let of_ends = |word: &String| named("ray_ends", word, &RayEnds::ALL, RayEnds::name);
        let ends: Vec<RayEnds> =
            words(&self.ray_ends, RayEnds::Cut.name()).iter().map(of_ends).collect::<anyhow::Result<_>>()?;
        let of_blur = |word: &String| named("beam_blur", word, &BeamBlur::ALL, BeamBlur::name);
        let blurs: Vec<BeamBlur> = words(&self.beam_blur, BeamBlur::OneD.name())
            .iter()
            .map(of_blur)
            .collect::<anyhow::Result<_>>()?;
        let length = self.beam_length.as_deref().unwrap_or(BeamLength::Sampled.name());
        let length = named("beam_length", length, &BeamLength::ALL, BeamLength::name)?;
        let mut all = Vec::new();
        for kernel in words(&self.kernel, Kernel::Uniform.name()) {
            let kernel = named("kernel", &kernel, &Kernel::ALL, Kernel::name)?;
            for &radius in &about_rays {
                let of_points = Estimator::new(kernel, Gather::Radius(radius)).treated(Treatment::Clipped);
                for &ends in &ends {
                    let of_rays = of_points.along_rays(radius).ending(ends);
                    match &own[..] {
                        [] => all.push(of_rays),
                        own => all.extend(own.iter().map(|k| of_rays.of_nearest(*k))),
                    }
                }
            }
            for &radius in &across_beams {
                let of_points = Estimator::new(kernel, Gather::Radius(radius)).treated(Treatment::Clipped);
                let of_beams = of_points.along_beams(radius).of_length(length);
                let of_beams =
                    Estimator { has_beam_fluence: self.beam_fluence, has_planes: self.planes, ..of_beams };
                for &blur in &blurs {
                    all.extend(ends.iter().map(|ends| of_beams.blurred(blur).ending(*ends)));
                }
            }
            for treatment in words(&self.treatment, Treatment::Clipped.name()) {
                let treatment = named("treatment", &treatment, &Treatment::ALL, |t| t.name())?;
                for rejection in words(&self.rejection, Rejection::Off.name()) {
                    let rejection = named("rejection", &rejection, &Rejection::ALL, |r| r.name())?;
                    for gather in &gathers {
                        all.push(Estimator::new(kernel, *gather).treated(treatment).rejecting(rejection));
                    }
                }
            }
        }
        Ok(all)
    }
}

/// The ladder of k of a file that names no estimator.
const LADDER: [u64; 4] = [25, 50, 100, 200];

impl StudyFile {
    /// Reads a file.
    ///
    /// # Errors
    /// File, line, column and key of what is wrong, and what is allowed
    pub fn read(name: &str, text: &str) -> anyhow::Result<Self> {
        let file: StudyFile = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start).min(text.len());
            let (line, column) = line_and_column(text, start);
            anyhow!("{name}:{line}:{column}: {}", toml_message(text, &error))
        })?;
        file.check().with_context(|| name.to_string())?;
        Ok(file)
    }

    fn check(&self) -> anyhow::Result<()> {
        if self.photons.is_empty() {
            bail!("photons is empty; allowed: a list such as [1e4, 1e5]");
        }
        ensure!(
            self.maps.0 >= 4,
            "maps is {}; allowed: at least 4, half of which choose the best estimator and half tell its error",
            self.maps.0
        );
        ensure!(
            self.target > 0.0 && self.target <= 1.0,
            "target is {}; allowed: a relative error above 0, to 1",
            self.target
        );
        let error = self.reference.error;
        ensure!(
            (1e-5..=0.5).contains(&error),
            "reference.error is {error}; allowed: a relative error from 1e-5 to 0.5"
        );
        ensure!(
            self.measure.readings.0 <= MOST_READINGS,
            "measure.readings is {}; allowed: 1 to {MOST_READINGS}",
            self.measure.readings.0
        );
        if let Some(empty) = self.axes.iter().find(|(_, values)| values.is_empty()) {
            bail!("axes.{} is empty; allowed: a list of values", empty.0);
        }
        Ok(())
    }

    /// The estimators; the k nearest are sought within `cap` where the file does not say.
    ///
    /// # Errors
    /// Which entry is wrong, and what is allowed
    pub fn estimators(&self, cap: f64) -> anyhow::Result<Vec<Estimator>> {
        let ladder =
            EstimatorFile { k: Some(OneOrMore(LADDER.map(Count).to_vec())), ..EstimatorFile::default() };
        let given = if self.estimators.is_empty() { &[ladder][..] } else { &self.estimators };
        let mut all: Vec<Estimator> = Vec::new();
        for (number, entry) in given.iter().enumerate() {
            let own = entry.all(cap).with_context(|| format!("estimators[{number}]"))?;
            for estimator in own {
                ensure!(
                    !all.contains(&estimator),
                    "estimators[{number}]: {} is asked twice",
                    estimator.name()
                );
                all.push(estimator);
            }
            ensure!(
                all.len() <= MOST_ESTIMATORS,
                "estimators are more than {MOST_ESTIMATORS}; allowed: that many"
            );
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        format!("{:#}", StudyFile::read("a.toml", text).unwrap_err())
    }

    #[test]
    fn every_combination_is_an_estimator() {
        let text = "scene = 'slab'\nphotons = [1e4]\n[[estimators]]\nkernel = ['uniform', 'cone']\nradius = [0.1, 0.2]\nk = 50\n\
                    treatment = ['none', 'clipped']\n";
        let file = StudyFile::read("a.toml", text).unwrap();
        let all = file.estimators(1.0).unwrap();
        assert_eq!(all.len(), 2 * 2 * 3);
        let names: std::collections::BTreeSet<String> = all.iter().map(Estimator::name).collect();
        assert_eq!(names.len(), all.len());
        let plain = StudyFile::read("a.toml", "scene = 'slab'\nphotons = [1e4]\n").unwrap();
        assert_eq!(plain.estimators(0.5).unwrap().len(), LADDER.len());
        assert!(plain.estimators(0.5).unwrap().iter().all(|e| e.gather.cap() == 0.5));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        assert!(
            refused("scene = 'slab'\nphotons = [1e4]\nphoton = 3\n")
                .starts_with("a.toml:3:1: unknown key `photon`; nearest: `photons`")
        );
        assert!(refused("scene = 'slab'\nphotons = [0.5]\n").contains("a.toml:2"));
        for scene in ["'-'", "3", "[]"] {
            let text = refused(&format!("scene = {scene}\nphotons = [1e4]\n"));
            assert!(
                text.starts_with("a.toml:1:9: scene is ") && text.contains("; allowed: a scene file"),
                "{text}"
            );
        }
        assert!(refused("scene = 'slab'\nphotons = []\n").contains("photons is empty"));
        let one = StudyFile::read("a.toml", "scene = 'slab'\nphotons = 1e4\n").unwrap();
        assert_eq!(one.photons, [Count(10_000)]);
        let half = refused("scene = 'slab'\nphotons = 1e4\n[[estimators]]\nk = [30.5]\n");
        assert!(half.contains("a.toml:4:") && half.contains("k: 30.5 is not a count"), "{half}");
        let near = refused("scene = 'slab'\nphotons = 1e4\n[[estimators]]\nraduis = 1\n");
        assert!(near.contains("unknown key `raduis`; nearest: `radius`"), "{near}");
        assert!(refused("scene = 'slab'\nphotons = [1e4]\nmaps = 2\n").contains("maps is 2"));
        assert!(refused("scene = 'slab'\nphotons = [1e4]\ntarget = nan\n").contains("target is NaN"));
        assert!(refused("scene = 'slab'\nphotons = [1e4]\n[axes]\ng = []\n").contains("axes.g is empty"));
        let wrong = |entry: &str| {
            let text = format!("scene = 'slab'\nphotons = [1e4]\n[[estimators]]\n{entry}\n");
            format!("{:#}", StudyFile::read("a.toml", &text).unwrap().estimators(1.0).unwrap_err())
        };
        assert!(wrong("k = 1").starts_with("estimators[0]: k is 1; allowed"));
        assert!(wrong("radius = -1").contains("allowed"));
        assert!(wrong("kernel = 'boxy'\nk = 5").contains("kernel is \"boxy\"; allowed: uniform"));
        assert!(wrong("kernel = 'cone'").contains("neither radius, ray_radius, beam_radius nor k"));
        assert!(wrong("k = [5, 5]").contains("asked twice"));
        assert!(wrong("radius = 1\nmax_radius = 2").contains("max_radius goes with k"));
    }
}
