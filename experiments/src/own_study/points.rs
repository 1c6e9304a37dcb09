//! The scenes of a study: one a combination of the values of its axes, each with what is measured in it.

use super::file::{MeasureFile, StudyFile, StudyScene};
use super::picture::Picture;
use super::place::Place;
use crate::harness::{Unit, say};
use crate::setups::asked;
use anyhow::{Context, bail, ensure};
use std::collections::BTreeSet;
use std::path::Path;
use turbid::estimators::{BeamBlur, Estimator};
use turbid::exchange::{Opened, open};
use turbid::integrators::mapper::scene_size;
use turbid::output::one_line;
use turbid::photons::check_end;
use turbid::scene::{BUILTIN, Binned, Quantity, QuantityFile, Scene, SceneFile, SceneSource, SensorFile};
use turbid::sensor::{SensorMaps, usual_reach};

/// One scene of a study.
#[derive(Clone)]
pub struct Point {
    /// Values of the axes, as words; empty without axes.
    pub label: String,
    /// The same, one an axis.
    pub values: Vec<(String, String)>,
    /// The scene, whose sensors are what is measured.
    pub scene: Scene,
    /// The camera's picture, if that is measured and not sensors.
    pub picture: Option<Picture>,
    /// The numbers that are measured.
    pub places: Vec<Place>,
    /// How maps are read.
    pub estimators: Vec<Estimator>,
    /// Sensors of the scene that maps do not answer.
    pub left_out: Vec<String>,
}

/// Most scenes, and most numbers measured in one.
const MOST_POINTS: usize = 1000;
const MOST_PLACES: usize = 10_000;

/// Every scene of the study.
///
/// # Errors
/// What is wrong with the scene, an axis or a sensor, by its name
pub fn points(study: &StudyFile, folder: &Path) -> anyhow::Result<Vec<Point>> {
    let product = study.axes.values().try_fold(1usize, |product, values| product.checked_mul(values.len()));
    let Some(count) = product.filter(|count| *count <= MOST_POINTS) else {
        let sizes: Vec<String> = study.axes.values().map(|values| values.len().to_string()).collect();
        bail!("axes: {} scenes; allowed: up to {MOST_POINTS}", sizes.join(" x "));
    };
    for (key, values) in &study.axes {
        let same = |a: &toml::Value, b: &toml::Value| match (number(a), number(b)) {
            (Some(a), Some(b)) => a == b,
            _ => word(a) == word(b),
        };
        let twice = values.iter().enumerate().find(|(i, value)| values[..*i].iter().any(|v| same(v, value)));
        if let Some((_, value)) = twice {
            bail!("axes.{key} has {} twice; allowed: each value once", word(value));
        }
    }
    let points = (0..count).map(|number| point(study, folder, number)).collect::<anyhow::Result<Vec<_>>>()?;
    let labels: BTreeSet<&str> = points.iter().map(|point| point.label.as_str()).collect();
    ensure!(labels.len() == points.len(), "axes: two scenes are called the same; allowed: other values");
    Ok(points)
}

/// A value as a number, if it is one.
fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

fn point(study: &StudyFile, folder: &Path, number: usize) -> anyhow::Result<Point> {
    let path = match &study.scene {
        StudyScene::Name(name) if BUILTIN.iter().any(|builtin| builtin.name == name) => name.into(),
        StudyScene::Name(name) => folder.join(name),
        StudyScene::Table(_) => folder.join("scene"),
    };
    let (mut source, mut left, mut values) = (SceneSource::new(path), number, Vec::new());
    for (key, list) in &study.axes {
        let value = &list[left % list.len()];
        left /= list.len();
        source = source.with(key.as_str(), value.clone());
        values.push((key.clone(), word(value)));
    }
    let mut opened = match &study.scene {
        StudyScene::Name(_) => open(&source, false),
        StudyScene::Table(table) => {
            let text = toml::to_string(table)?;
            // Its lines are not those of the study's file.
            let file = SceneFile::read(&text, None).and_then(|_| source.changed(&text));
            file.map(|file| Opened::new(file, source.folder()))
        }
    }
    .context("scene")?;
    if number == 0 {
        opened.notes.iter().for_each(|note| say(&format!("{}: {note}", source.name())));
    }
    let (file, measure) = (&mut opened.file, &study.measure);
    let left_out = choose(measure, &mut file.sensors).context("measure.sensors")?;
    file.sensors.extend(extra(measure).context("measure")?);
    if let Some(picture) = &measure.picture {
        ensure!(
            measure.sensors.is_none() && !measure.is_of_points(),
            "measure.picture stands alone; allowed beside it: no sensors, probes, lattice or rays"
        );
        file.sensors.clear();
        let scene = asked(opened.scene().with_context(|| source.name())?);
        check_end(&scene).with_context(|| source.name())?;
        let picture = Picture::new(&scene, picture).context("measure")?;
        let (places, estimators) = (picture.places(), study.estimators(0.1 * scene_size(&scene))?);
        let is_of_places = |e: &&Estimator| e.has_beam_fluence || e.beam_blur == BeamBlur::ThreeD;
        if let Some(estimator) = estimators.iter().find(is_of_places) {
            bail!(
                "picture: {} is of sensors alone; allowed in pictures: beam_radius with beam_blur, beam_length and planes, ray_radius with ray_k, ray_ends, radius, k",
                estimator.name()
            );
        }
        for estimator in &estimators {
            estimator.check_ends(&scene).with_context(|| estimator.name())?;
            picture.settings(&scene, estimator)?.media().check(&scene).with_context(|| estimator.name())?;
        }
        ensure!(
            places.len() <= MOST_PLACES,
            "more than {MOST_PLACES} numbers in a scene; allowed: that many"
        );
        let (label, left_out) = (label(&values), Vec::new());
        return Ok(Point { label, values, scene, picture: Some(picture), places, estimators, left_out });
    }
    ensure!(
        !file.sensors.is_empty(),
        "{}: nothing to measure: no sensor of fluence or radiance, and measure has no probes, lattice or rays",
        source.name()
    );
    let scene = asked(opened.scene().with_context(|| source.name())?);
    check_end(&scene).with_context(|| source.name())?;
    let places = places(&scene).context("measure")?;
    let estimators = study.estimators(usual_reach(&scene))?;
    SensorMaps::check(&scene, &estimators).with_context(|| source.name())?;
    Ok(Point { label: label(&values), values, scene, picture: None, places, estimators, left_out })
}

/// The values of the axes in words.
fn label(values: &[(String, String)]) -> String {
    values.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(", ")
}

impl Point {
    /// Whether errors are told of a place: it is of the first group.
    pub fn is_main(&self, place: &Place) -> bool {
        self.places.first().is_some_and(|first| first.group == place.group)
    }
}

/// The farthest that any estimator reaches \[L\].
pub fn reach(estimators: &[Estimator]) -> f64 {
    estimators.iter().map(Estimator::reach).fold(0.0, f64::max)
}

/// A value as a word.
fn word(value: &toml::Value) -> String {
    match value {
        toml::Value::String(word) => one_line(word),
        other => one_line(&other.to_string()),
    }
}

/// Whether a map answers a sensor.
fn is_of_maps(sensor: &SensorFile) -> bool {
    matches!(
        sensor.measure,
        QuantityFile::Fluence { .. }
            | QuantityFile::Radiance { .. }
            | QuantityFile::MeanFluence(_)
            | QuantityFile::MeanRadiance { .. }
    )
}

/// Leaves the sensors that are asked for, and tells the names of those that maps do not answer. A sensor that is named must be
/// there and be answered; without names, probes, lattice and rays stand in the place of the scene's own.
fn choose(measure: &MeasureFile, sensors: &mut Vec<SensorFile>) -> anyhow::Result<Vec<String>> {
    let Some(names) = &measure.sensors else {
        let is_asked = measure.is_of_points();
        let left: Vec<String> =
            sensors.iter().filter(|s| !is_asked && !is_of_maps(s)).map(|s| s.name.clone()).collect();
        sensors.retain(|sensor| !is_asked && is_of_maps(sensor));
        return Ok(left);
    };
    for name in names {
        let own: Vec<&SensorFile> = sensors.iter().filter(|sensor| sensor.name == *name).collect();
        let known: BTreeSet<&str> =
            sensors.iter().filter(|sensor| is_of_maps(sensor)).map(|sensor| sensor.name.as_str()).collect();
        ensure!(
            !own.is_empty(),
            "the scene has no sensor {name:?}; maps answer: {}",
            known.into_iter().collect::<Vec<_>>().join(", ")
        );
        ensure!(
            own.iter().any(|sensor| is_of_maps(sensor)),
            "no map answers {name:?}; allowed: fluence, radiance, mean-fluence, mean-radiance"
        );
    }
    sensors.retain(|sensor| names.contains(&sensor.name) && is_of_maps(sensor));
    Ok(Vec::new())
}

/// Probes, lattice and rays as sensors.
fn extra(measure: &MeasureFile) -> anyhow::Result<Vec<SensorFile>> {
    let sensor = |name: String, quantity| SensorFile {
        name,
        label: None,
        measure: quantity,
        min_order: measure.min_order,
        max_order: measure.max_order,
    };
    let fluence = |name: String, at: [f64; 3]| sensor(name, QuantityFile::Fluence { at });
    let mut all: Vec<SensorFile> =
        measure.probes.iter().enumerate().map(|(i, &at)| fluence(format!("probe {i}"), at)).collect();
    if let Some(lattice) = measure.lattice {
        let [nx, ny, nz] = lattice.count;
        let count = nx.checked_mul(ny).and_then(|n| n.checked_mul(nz));
        ensure!(
            count.is_some_and(|n| (1..=MOST_PLACES).contains(&n)),
            "lattice.count is {nx} x {ny} x {nz}; allowed: 1 to {MOST_PLACES} points"
        );
        let along = |axis: usize, i: usize| {
            let (from, to, n) = (lattice.from[axis], lattice.to[axis], lattice.count[axis]);
            if n == 1 { 0.5 * (from + to) } else { from + (to - from) * i as f64 / (n - 1) as f64 }
        };
        for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
            all.push(fluence(format!("lattice {i} {j} {k}"), [along(0, i), along(1, j), along(2, k)]));
        }
    }
    for (i, ray) in measure.rays.iter().enumerate() {
        let quantity = QuantityFile::Radiance { origin: ray.origin, dir: ray.dir };
        all.push(sensor(format!("ray {i}"), quantity));
    }
    Ok(all)
}

/// Names that rows of cells and results have.
const RESERVED: [&str; 3] = ["all", "under-full share", "photons stored"];

/// Every number that is measured.
pub(super) fn places(scene: &Scene) -> anyhow::Result<Vec<Place>> {
    let suffixes: &[&str] = if scene.plan().is_grey { &[""] } else { &[".r", ".g", ".b"] };
    let mut places: Vec<Place> = Vec::new();
    for (number, sensor) in scene.sensors().iter().enumerate() {
        let binned = sensor.binned();
        let bins = binned.map_or(1, Binned::bins);
        ensure!(
            places.len() + bins * suffixes.len() <= MOST_PLACES,
            "more than {MOST_PLACES} numbers in a scene; allowed: that many"
        );
        for bin in 0..bins {
            let (at, name) = match (&sensor.quantity, binned) {
                (_, Some(binned)) => {
                    let [ni, nj, _] = binned.count();
                    let name =
                        format!("{} [{} {} {}]", sensor.name, bin % ni, bin / ni % nj, bin / (ni * nj));
                    (binned.point(bin, scene.periodic_cell(), [0.5; 3]), name)
                }
                (Quantity::Fluence(p), None) => (*p, sensor.name.clone()),
                (Quantity::Radiance(ray), None) => (ray.origin, sensor.name.clone()),
                _ => bail!("no map answers {}", sensor.name),
            };
            for (channel, suffix) in suffixes.iter().enumerate() {
                let name = one_line(&format!("{name}{suffix}"));
                ensure!(
                    !RESERVED.contains(&name.as_str()),
                    "a sensor is called {name}, which means something else in the results; allowed: another name"
                );
                ensure!(
                    places.iter().all(|place| place.name != name),
                    "two sensors are called {}; allowed: names of their own",
                    sensor.name
                );
                let unit = Unit::new(sensor.unit());
                let at = at.to_array();
                places.push(Place { name, group: "", sensor: number, bin, channel, unit, at });
            }
        }
    }
    Ok(places)
}
