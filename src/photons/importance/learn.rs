//! What photons are worth: a pilot of photons that score where they are read.

use super::branching::Branching;
use super::grid::{Aim, DIRECTIONS, Grid};
use super::readout::Readout;
use super::settings::{ImportanceSettings, Stage};
use super::values::Importance;
use crate::error::{Error, Result};
use crate::light::EmissionCell;
use crate::photons::Emitter;
use crate::photons::emit::cells_towards_scene;
use crate::photons::maps::{Indirect, is_global, is_volume};
use crate::photons::pass::is_diffuse;
use crate::rng::Stream;
use crate::scene::{Scene, Target};
use crate::transport::{Progress, Step, Visitor, Walker, run_blocks};

/// Cells of each light's numbers, about.
const CELLS: usize = 1024;
/// Part of the emission that follows power alone, and of the mean value that every box has at least: what the pilot never
/// saw is found too, with weights at most this many times too large.
const DEFENCE: f64 = 0.1;
/// Observations that a box's mean is believed as much as the mean of all.
const PRIOR: f64 = 4.0;

/// Sums of what was observed: scores over weights, and how many.
#[derive(Debug, Clone, Default)]
struct Observed {
    boxes: Vec<(f64, f64)>,
    cells: Vec<(f64, f64)>,
}

impl Observed {
    fn new(boxes: usize, cells: usize) -> Self {
        Observed { boxes: vec![(0.0, 0.0); boxes], cells: vec![(0.0, 0.0); cells] }
    }

    fn merged(mut self, other: Observed) -> Self {
        let add = |a: &mut Vec<(f64, f64)>, b: Vec<(f64, f64)>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = (a.0 + b.0, a.1 + b.1));
        };
        add(&mut self.boxes, other.boxes);
        add(&mut self.cells, other.cells);
        self
    }
}

/// The mean of each, drawn towards the mean of its group where little was observed, and that towards the mean of all.
fn means(observed: &[(f64, f64)], group: usize) -> Vec<f64> {
    let sum = |of: &[(f64, f64)]| of.iter().fold((0.0, 0.0), |(s, n), o| (s + o.0, n + o.1));
    let drawn = |(sum, n): (f64, f64), mean: f64| (sum + PRIOR * mean) / (n + PRIOR);
    let all = drawn(sum(observed), 0.0);
    let mut values = Vec::with_capacity(observed.len());
    for members in observed.chunks(group) {
        let mean = drawn(sum(members), all);
        values.extend(members.iter().map(|one| drawn(*one, mean).max(DEFENCE * all)));
    }
    values
}

/// An event of a history, for what comes after it.
struct Event {
    parent: Option<u32>,
    /// Box and direction of the photon that left it.
    index: usize,
    /// Weight with which the photon flew on; 0 if it did not.
    departed: f64,
    /// Score here and later.
    score: f64,
    here: f64,
}

/// Scores the histories of one block.
struct Learner<'a> {
    scene: &'a Scene,
    indirect: Indirect,
    grid: &'a Grid,
    aim: Aim,
    readout: &'a Readout,
    parent: Option<u32>,
    events: Vec<Event>,
}

impl Learner<'_> {
    fn event(&mut self, here: f64) {
        self.events.push(Event { parent: self.parent, index: 0, departed: 0.0, score: here, here });
    }

    /// Adds a finished history to what was observed; returns its score.
    fn finish(&mut self, observed: &mut Observed) -> f64 {
        let mut total = 0.0;
        // Children stand behind their parents.
        for i in (0..self.events.len()).rev() {
            let Event { parent, index, departed, score, here } = self.events[i];
            if departed > 0.0 {
                let sums = &mut observed.boxes[index];
                *sums = (sums.0 + (score - here) / departed, sums.1 + 1.0);
            }
            match parent {
                Some(parent) => self.events[parent as usize].score += score,
                None => total += score,
            }
        }
        self.events.clear();
        total
    }
}

impl Visitor for Learner<'_> {
    const LOOKS_AHEAD: bool = false;

    fn visit(&mut self, _walker: &Walker, step: Step, _stream: &mut Stream) {
        match step {
            Step::Collision(arrival, _) => {
                let walker = arrival.walker;
                let read = if is_volume(walker.flags) { self.readout.medium(arrival.position) } else { 0.0 };
                self.event(walker.weight.sum() * read);
            }
            Step::Surface(arrival, found) => {
                if let Target::Object(index) = found.target
                    && is_diffuse(&self.scene.objects()[index].surface)
                {
                    let walker = arrival.walker;
                    let is_stored = is_global(walker.flags, self.indirect);
                    let read = if is_stored { self.readout.surface(arrival.position) } else { 0.0 };
                    self.event(walker.weight.sum() * read);
                }
            }
            _ => {}
        }
    }
}

impl Branching for Learner<'_> {
    fn enter(&mut self, event: Option<u32>) {
        self.parent = event;
    }

    fn left(&mut self, walker: &Walker) -> u32 {
        let number = self.events.len() as u32 - 1;
        if let Some(event) = self.events.last_mut() {
            event.departed = walker.weight.sum();
            event.index = self.grid.index(walker.ray.origin) * DIRECTIONS
                + self.aim.directions(walker.ray.origin).index(walker.ray.dir);
        }
        number
    }
}

/// Runs the rounds of the pilot.
pub(super) fn learn(
    scene: &Scene,
    indirect: Indirect,
    grid: Grid,
    readout: &Readout,
    settings: &ImportanceSettings,
    progress: &dyn Progress,
) -> Result<Importance> {
    let all = || {
        let lights = scene.lights().iter().enumerate();
        lights.flat_map(|(light, l)| l.cells(CELLS).into_iter().map(move |cell| (light, cell))).collect()
    };
    let cells: Vec<(usize, EmissionCell)> =
        cells_towards_scene(scene, CELLS).map_or_else(all, |(cells, _)| cells);
    let powers: Vec<f64> = cells
        .iter()
        .map(|(light, cell)| scene.lights()[*light].power_bound(scene.periodic_cell()).sum() * cell.volume())
        .collect();
    let dark = || Error::Scene("no photon comes where the camera reads them; importance cannot help".into());
    let whole: f64 = powers.iter().sum();
    // Before anything is known every place has the same value, and weights stay as they are emitted.
    let mut importance = Importance {
        values: vec![1.0; grid.len() * DIRECTIONS],
        response: whole,
        aim: readout.aim(),
        emitter: Emitter::chosen(scene, cells.clone(), powers.clone(), 0).ok_or_else(dark)?,
        grid,
    };
    let mut observed = Observed::new(importance.values.len(), cells.len());
    for round in 0..settings.rounds {
        let block = |range: std::ops::Range<u64>| {
            let mut found = Observed::new(importance.values.len(), cells.len());
            let mut learner = Learner {
                scene,
                indirect,
                grid: &importance.grid,
                aim: importance.aim,
                readout,
                parent: None,
                events: Vec::new(),
            };
            for history in range {
                let mut stream = settings.stream(Stage::Round(round), history);
                let (cell, start) = importance.emitter.emit_from(scene, &mut stream);
                let score = start.map_or(0.0, |start| {
                    let weight = start.weight.sum();
                    importance.walk(scene, start, None, &mut stream, &mut learner);
                    learner.finish(&mut found) / weight
                });
                let sums = &mut found.cells[cell];
                *sums = (sums.0 + score, sums.1 + 1.0);
            }
            found
        };
        let found = run_blocks(settings.pilot, progress, block, Observed::merged)?;
        observed = observed.merged(found.unwrap_or_default());
        let values = means(&observed.cells, cells.len());
        let scores = values.iter().zip(&powers).map(|(value, power)| value * power);
        let response: f64 = scores.clone().sum();
        if response.is_nan() || response <= 0.0 {
            return Err(dark());
        }
        let chances = scores
            .zip(&powers)
            .map(|(score, power)| (1.0 - DEFENCE) * score / response + DEFENCE * power / whole)
            .collect();
        importance.emitter = Emitter::chosen(scene, cells.clone(), chances, 0).ok_or_else(dark)?;
        importance.values = means(&observed.boxes, DIRECTIONS);
        importance.response = response;
    }
    Ok(importance)
}
