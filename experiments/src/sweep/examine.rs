//! One scene by every method, and what they say of each other.

use super::compare::{Check, Test, conserved, sharpness, shrinking, unbiased};
use super::energy::energy;
use super::maps::maps;
use super::measure::{Effort, Failure, Seen, connected, light, paths};
use super::pairs::pair;
use super::text::SceneText;
use serde::{Deserialize, Serialize};
use turbid::integrators::Layer;
use turbid::scene::Scene;
use turbid::sensor::check_camera;

/// Above this a scene counts as undecided: the smallest relative deviation that it could have shown.
pub const SHARP: f64 = 0.2;

/// What is wrong with a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Which comparison or method.
    pub check: String,
    /// What went wrong where it is not a number: an error, a panic, no end.
    pub failure: Option<String>,
    /// The test that called for a confirmation.
    pub first: Option<Test>,
    /// The same test on a new seed with four times the samples.
    pub second: Option<Test>,
}

impl Alarm {
    /// A method that failed.
    pub fn failure(check: &str, text: impl Into<String>) -> Self {
        Alarm { check: check.into(), failure: Some(text.into()), first: None, second: None }
    }

    /// p-value of the confirmation; 0 where chance has no part in it.
    pub fn p(&self) -> f64 {
        match (&self.first, &self.second) {
            (Some(first), Some(second)) => {
                let same_side = (first.value > first.expected) == (second.value > second.expected);
                if same_side { second.p } else { 1.0 }
            }
            // Stopped by the clock before it was compared again, so that the scene is undecided, or nothing was there to be.
            (Some(_), None) => 1.0,
            (None, _) => 0.0,
        }
    }

    /// Where: what a smaller scene must still show.
    pub fn place(&self) -> (String, String) {
        let cell = self.first.as_ref().map_or("", |t| t.cell.as_str());
        let layer = cell.split(['.', ' ']).next().unwrap_or_default();
        (self.check.clone(), layer.to_string())
    }

    /// In lines.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(failure) = &self.failure {
            lines.push(format!("{}: {failure}", self.check));
        }
        for (word, test) in [("", &self.first), ("again, four times the samples: ", &self.second)] {
            lines.extend(test.as_ref().map(|t| format!("{}: {word}{}", self.check, t.line())));
        }
        lines
    }
}

/// A comparison without its tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Which two.
    pub check: String,
    /// How many numbers were compared.
    pub tests: usize,
    /// [`Check::smallest`].
    pub smallest: Option<f64>,
    /// The farthest number.
    pub worst: Option<Test>,
}

/// What is known of a scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Examined {
    /// Comparisons.
    pub checks: Vec<Summary>,
    /// The smallest detectable deviation in half of the light, over all comparisons of pictures.
    pub smallest: Option<f64>,
    /// Methods that rightly said they cannot, and why: what is allowed is in the module's text.
    pub refused: Vec<String>,
    /// Methods that were stopped by the clock.
    pub late: Vec<String>,
    /// What is wrong.
    pub alarms: Vec<Alarm>,
}

impl Examined {
    /// What a method made; why not, is kept. A refusal is an alarm, but for the one that is `allowed`: every method takes a
    /// valid scene.
    fn keep<T>(&mut self, name: &str, made: Result<T, Failure>, allowed: Option<&str>) -> Option<T> {
        match made {
            Ok(made) => return Some(made),
            Err(Failure::Refused(text)) if allowed == Some(&text) => {
                self.refused.push(format!("{name}: {text}"))
            }
            Err(Failure::Refused(text)) => self.alarms.push(Alarm::failure(name, format!("refused: {text}"))),
            Err(Failure::Broken(text)) => self.alarms.push(Alarm::failure(name, text)),
            Err(Failure::Late) => self.late.push(name.to_string()),
        }
        None
    }

    /// What was compared, and how sharply.
    fn summarize(&mut self, checks: &[Check]) {
        let pictures: Vec<&Check> = checks.iter().filter(|c| c.name != ENERGY).collect();
        self.smallest = sharpness(&pictures);
        let summary = |c: &Check| Summary {
            check: c.name.clone(),
            tests: c.tests.len(),
            smallest: c.smallest,
            worst: c.worst().cloned(),
        };
        self.checks = checks.iter().map(summary).collect();
    }

    /// Why nothing can be said, if so: too little was detectable, or nothing.
    pub fn undecided(&self) -> Option<String> {
        if let Some(late) = self.late.first() {
            return Some(format!("{late} took too long"));
        }
        if !self.checks.iter().any(|c| c.check != ENERGY) {
            return Some("nothing to compare".into());
        }
        match self.smallest {
            Some(smallest) if smallest <= SHARP => None,
            Some(smallest) => Some(format!("a deviation of {:.0} % would not be detected", 100.0 * smallest)),
            None => Some("heavy tails".into()),
        }
    }
}

/// What every method makes of a scene.
struct Once {
    checks: Vec<Check>,
    examined: Examined,
}

/// Parts of the effort that are tried in turn: what is decided by one needs no more. Alarms are confirmed with four times the
/// samples of the second, or of the third where it was needed.
const PARTS: [f64; 3] = [0.06, 0.4, 1.0];

/// Examines a scene; alarms are confirmed once, on another seed with four times the samples of a large part of the effort: what
/// a small part found by chance a few times or never, such as a lamp in a mirror, is then found often enough to have an error.
///
/// Where a part of the effort leaves a scene undecided, what was not sharp enough is compared again with more of it. That is a
/// matter of standard errors, not of differences.
///
/// # Arguments   `stage` is told which method is about to work
/// # Errors      what the scene is refused for
pub fn examine(
    text: &SceneText,
    seed: u64,
    effort: &Effort,
    stage: &dyn Fn(&str),
) -> anyhow::Result<Examined> {
    let part = |part: f64| Effort { steps: part * effort.steps, ..*effort };
    let mut found = once(text, (seed, seed), &part(PARTS[0]), stage, &|_| true)?;
    let mut most = PARTS[1];
    for more in &PARTS[1..] {
        let Examined { late, alarms, .. } = &found.examined;
        if !late.is_empty() || !alarms.is_empty() || found.examined.undecided().is_none() {
            break;
        }
        // None alone may be too blunt where no layer is sharp in all that counts for it.
        let is_all = found.checks.iter().all(|c| c.smallest.is_some_and(|s| s <= SHARP));
        let is_blunt = |c: &Check| is_all || c.smallest.is_none_or(|s| s > SHARP);
        let (blunt, mut sharp): (Vec<Check>, Vec<Check>) = found.checks.into_iter().partition(is_blunt);
        let refused = found.examined.refused;
        most = *more;
        found = once(text, (seed, seed), &part(*more), stage, &|name| blunt.iter().any(|c| c.name == name))?;
        sharp.retain(|old| found.checks.iter().all(|new| new.name != old.name));
        found.checks.extend(sharp);
        found.examined.refused = refused;
        found.examined.summarize(&found.checks);
    }
    let Once { checks, mut examined } = found;
    let suspicious: Vec<(&str, &Test)> = checks
        .iter()
        .flat_map(|c| c.tests.iter().filter(|t| t.is_suspicious()).map(|t| (c.name.as_str(), t)))
        .collect();
    if !suspicious.is_empty() {
        let more = Effort { seconds: effort.seconds.map(|s| 4.0 * s), ..part(4.0 * most) };
        // Only what is to be compared again.
        let is_wanted = |name: &str| suspicious.iter().any(|(other, _)| *other == name);
        let again = once(text, (seed ^ (1 << 40), seed), &more, stage, &is_wanted)?;
        examined.alarms.extend(again.examined.alarms);
        examined.late.extend(again.examined.late.iter().map(|name| format!("again, {name}")));
        let late = again.examined.late.first().map(|name| format!("{name} took too long to confirm this"));
        for (name, first) in suspicious {
            let check = again.checks.iter().find(|c| c.name == name);
            let second = check.and_then(|c| c.tests.iter().find(|t| t.cell == first.cell)).cloned();
            let first = Some(first.clone());
            let failure = if second.is_none() { late.clone() } else { None };
            examined.alarms.push(Alarm { check: name.into(), failure, first, second });
        }
    }
    Ok(examined)
}

/// Names of comparisons; those of pairs say what was changed.
const ENERGY: &str = "energy";
const LIGHT_PATHS: &str = "light - paths";
const CONNECTED_PATHS: &str = "bidirectional - paths";
const MAPS_PATHS: &str = "maps - paths";
const MAPS_LIGHT: &str = "maps - light";
/// The same again, without directions in which a specular body is seen.
const BUT_SPECULAR: &str = ", no specular";

/// What methods by photons rightly refuse a scene for, if so: a medium that emits and has no end.
fn cannot_emit(scene: &Scene) -> Option<String> {
    scene.check_emission().err().map(|error| error.to_string())
}

/// The comparisons that are wanted, once. Of the two seeds one is that of the methods, the other says what is changed.
fn once(
    text: &SceneText,
    (seed, changed_by): (u64, u64),
    effort: &Effort,
    stage: &dyn Fn(&str),
    is_wanted: &dyn Fn(&str) -> bool,
) -> anyhow::Result<Once> {
    stage("scene");
    let scene = text.scene()?;
    let camera = *scene.camera().ok_or_else(|| anyhow::anyhow!("the scene has no camera"))?;
    let mut examined = Examined::default();
    let mut checks = Vec::new();
    // A camera that is shut in is refused by every method, in words.
    if let Err(error) = check_camera(&scene, &camera) {
        examined.refused.push(format!("camera: {error}"));
        return Ok(Once { checks, examined });
    }
    let endless = cannot_emit(&scene);
    let endless = endless.as_deref();
    let (has_paths, has_photons) = (scene.plan().unreachable.is_empty(), scene.periodic_cell().is_none());
    stage("energy");
    let balance = energy(&scene, seed, effort);
    let steps = balance.as_ref().map_or(1.0, |e| e.steps);
    let balance = examined.keep("energy", balance, endless);
    checks.extend(balance.as_ref().map(conserved));
    let with_maps = if has_paths { MAPS_PATHS } else { MAPS_LIGHT };
    let other = pair(text, &scene, changed_by);
    let with_other = other.as_ref().map_or(String::new(), |other| {
        format!("{} - {}", other.name, if has_paths { "paths" } else { "light" })
    });
    let but_specular = |name: &str| format!("{name}{BUT_SPECULAR}");
    let is_wanted = |name: &str| is_wanted(name) || is_wanted(&but_specular(name));
    let (needs_maps, needs_other) = (has_photons && is_wanted(with_maps), is_wanted(&with_other));
    let by_paths = has_paths.then(|| {
        stage("paths");
        examined.keep("paths", paths(&scene, &camera, seed, effort), None)
    });
    // Their subpaths of light start where photons do.
    let by_connected = (has_paths && has_photons && is_wanted(CONNECTED_PATHS)).then(|| {
        stage("bidirectional");
        examined.keep("bidirectional", connected(&scene, &camera, seed, effort), None)
    });
    let by_light = (has_photons && (!has_paths || is_wanted(LIGHT_PATHS))).then(|| {
        stage("light");
        examined.keep("light", light(&scene, &camera, seed, effort), endless)
    });
    let by_maps = needs_maps.then(|| {
        stage("maps");
        examined.keep("maps", maps(&scene, &camera, seed, effort, steps), endless)
    });
    let (by_paths, by_light, by_maps) = (by_paths.flatten(), by_light.flatten(), by_maps.flatten());
    let scatters = |layer: Layer| layer != Layer::Emission;
    if let (Some(by_paths), Some(by_light)) = (&by_paths, &by_light) {
        checks.push(unbiased(LIGHT_PATHS, by_light, &by_paths.straight, scatters));
    }
    if let (Some(by_paths), Some(Some(by_connected))) = (&by_paths, &by_connected) {
        checks.push(unbiased(CONNECTED_PATHS, &by_connected.all, &by_paths.all, |_| true));
    }
    let has_media = scene.plan().has_media;
    match (&by_maps, &by_paths, &by_light) {
        (Some(made), Some(by_paths), _) => {
            checks.push(shrinking(MAPS_PATHS, made, |s| &s.all, &by_paths.all, |_| true, has_media));
            if by_paths.has_specular {
                let (name, straight) = (but_specular(MAPS_PATHS), &by_paths.straight);
                checks.push(shrinking(&name, made, |s| &s.straight, straight, |_| true, has_media));
            }
        }
        (Some(made), None, Some(by_light)) => {
            checks.push(shrinking(MAPS_LIGHT, made, |s| &s.straight, by_light, scatters, has_media));
        }
        (None, ..) | (_, None, None) => {}
    }
    // The same scene in other words, by paths where they reach all of it, else by light tracing.
    stage("pair");
    match other {
        Ok(_) if !needs_other => {}
        Err(error) => examined.alarms.push(Alarm::failure("pair", format!("refused: {error:#}"))),
        Ok(other) => {
            let camera = other.scene.camera().unwrap_or(&camera);
            let endless = cannot_emit(&other.scene).filter(|_| !has_paths);
            let seed = seed ^ (1 << 41);
            let second = match has_paths {
                true => paths(&other.scene, camera, seed, effort),
                false => light(&other.scene, camera, seed, effort).map(Seen::from),
            };
            let second = examined.keep(&with_other, second, endless.as_deref());
            let first = if has_paths { by_paths } else { by_light.map(Seen::from) };
            if let (Some(first), Some(second)) = (first, second) {
                let second = if other.is_mirrored { second.flipped() } else { second };
                checks.push(unbiased(&with_other, &second.all, &first.all, |_| true));
                if first.has_specular {
                    let name = but_specular(&with_other);
                    checks.push(unbiased(&name, &second.straight, &first.straight, |_| true));
                }
            }
        }
    }
    examined.summarize(&checks);
    Ok(Once { checks, examined })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A refusal is an alarm at any level, unless it is the one of physics, by its words.
    #[test]
    fn a_refusal_is_an_alarm_unless_it_is_physics() {
        let refused = |text: &str| -> Result<(), Failure> { Err(Failure::Refused(text.to_string())) };
        let mut examined = Examined::default();
        assert_eq!(examined.keep("maps", refused("no end"), Some("no end")), None);
        assert_eq!(
            (examined.refused.as_slice(), examined.alarms.len()),
            (&["maps: no end".to_string()][..], 0)
        );
        for allowed in [None, Some("no end")] {
            let mut examined = Examined::default();
            assert_eq!(examined.keep("maps", refused("the step is 0"), allowed), None);
            assert_eq!((examined.refused.len(), examined.alarms.len()), (0, 1));
            assert_eq!(examined.alarms[0].p(), 0.0);
            assert_eq!(examined.alarms[0].lines(), ["maps: refused: the step is 0"]);
        }
    }

    /// A medium without end that emits: energy, light tracing and maps refuse it in words, and that is no alarm.
    #[test]
    fn emission_without_end_is_refused_and_no_alarm() {
        let table = toml::from_str(
            r#"
            camera = { position = [0, 0, -4], look_at = [0, 0, 0], fov = 50, width = 16, height = 12 }
            regions = [{ shape = { slab = { top = 0, thickness = 2 } }, sigma_t = 1, albedo = 0.5, g = 0, emission = 1 }]
            "#,
        );
        let text = SceneText { table: table.unwrap(), ..SceneText::default() };
        let effort = Effort { steps: 2e4, ..Effort::default() };
        let examined = examine(&text, 1, &effort, &|_| {}).unwrap();
        assert!(examined.alarms.is_empty(), "{:?}", examined.alarms);
        let refused: Vec<&str> =
            examined.refused.iter().map(|line| line.split(':').next().unwrap()).collect();
        assert_eq!(refused, ["energy", "light", "maps"]);
    }
}
