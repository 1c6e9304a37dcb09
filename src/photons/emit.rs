//! Emission: in proportion to power over all lights, everywhere or only where photons can be of use.
//!
//! A light spreads its power evenly over the unit cube of its numbers ([`Light::emit_at`]). Cut into cells, that cube says
//! where photons may start: emission in proportion to power from some of the cells, whose photons then carry what these
//! cells send out, is what all cells would have sent there.
//!
//! Media that emit are lights too. Where one of them is asked for a photon and the medium is not there, or emits less than
//! the bound by which places are chosen, no photon leaves: the history counts as emitted all the same.

use crate::Spectrum;
use crate::faults::{Fault, planted, size};
use crate::light::{Emission, EmissionCell, Light};
use crate::rng::Stream;
use crate::scene::{Scene, Start, Target};
use crate::transport::Walker;

/// Cells that the numbers of a light are cut into, about: each is tested against every specular body, which takes less
/// than a microsecond, and a body that fills a thousandth of what a light sees still fills sixteen of them.
const CELLS: usize = 1 << 14;

/// From where photons leave the lights, and how often.
#[derive(Debug, Clone)]
pub struct Emitter {
    /// What photons of all lights carry together if none is refused \[W\].
    power: Spectrum,
    chosen: Option<Chosen>,
    /// Cells that were tested against specular bodies.
    tested: u64,
}

/// Cells of lights that photons are restricted to.
#[derive(Debug, Clone)]
struct Chosen {
    /// Light and cell.
    cells: Vec<(usize, EmissionCell)>,
    /// Sum of the cells' probabilities up to each of them, the last one 1.
    cumulated: Vec<f64>,
    /// What a photon of each cell carries, over its light's power.
    weights: Vec<f64>,
    /// Power that the cells send out, over that of all lights.
    kept: f64,
}

impl Emitter {
    /// All that the lights send out, in proportion to power.
    pub fn by_power(scene: &Scene) -> Self {
        Emitter { power: scene.ceiling(), chosen: None, tested: 0 }
    }

    /// What can meet a specular body: cells of the lights' numbers whose rays can reach the sphere about one of them.
    /// None where the scene has no specular body, and where no light reaches one.
    ///
    /// Conservative: a cell is left out only if none of its rays, the light's extent included, can meet any of those
    /// spheres. A light whose photons may go anywhere from each part of its numbers is kept whole.
    pub fn towards_specular(scene: &Scene) -> Option<Self> {
        if !scene.plan().has_specular {
            return None;
        }
        let specular = scene.objects().iter().filter(|o| o.surface.is_specular());
        // A body without end is met from everywhere.
        let balls: Option<Vec<_>> = specular.map(|o| o.shape.bounds()).collect();
        let mut tested = 0;
        let mut cells = Vec::new();
        for (index, light) in scene.lights().iter().enumerate() {
            let Some(balls) =
                balls.as_ref().filter(|_| light.bundle(&EmissionCell::WHOLE).is_some() || has_faces(light))
            else {
                cells.push((index, EmissionCell::WHOLE));
                continue;
            };
            for cell in light.cells(CELLS) {
                tested += 1;
                let is_of_use = light.bundle(&cell).is_none_or(|bundle| {
                    balls.iter().any(|(center, radius)| bundle.reaches(*center, *radius))
                });
                if is_of_use {
                    cells.push((index, cell));
                }
            }
        }
        let shares = cells.iter().map(|(light, cell)| share(scene, *light, cell)).collect();
        let emitter = Self::chosen(scene, cells, shares, tested);
        // Where nothing is left out, photons leave though none can be of use.
        emitter.or_else(|| scene.plan().is_full.then(|| Emitter { tested, ..Self::by_power(scene) }))
    }

    /// Emission from cells with probabilities in proportion to `chances`; none if all are 0.
    pub(super) fn chosen(
        scene: &Scene,
        cells: Vec<(usize, EmissionCell)>,
        chances: Vec<f64>,
        tested: u64,
    ) -> Option<Self> {
        let power = scene.ceiling();
        let total: f64 = chances.iter().sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let (mut sum, mut kept) = (0.0, 0.0);
        let (mut cumulated, mut weights) = (Vec::new(), Vec::new());
        for ((light, cell), chance) in cells.iter().zip(&chances) {
            sum += chance;
            cumulated.push(sum / total);
            weights.push(cell.volume() * total / chance);
            if *chance > 0.0 {
                kept += share(scene, *light, cell);
            }
        }
        let kept = kept / power.sum();
        Some(Emitter { power, chosen: Some(Chosen { cells, cumulated, weights, kept }), tested })
    }

    /// How many cells were tested against specular bodies.
    pub fn projection_cells(&self) -> u64 {
        self.tested
    }

    /// Power that photons are sent out for, over that of all lights.
    pub fn kept(&self) -> f64 {
        self.chosen.as_ref().map_or(1.0, |chosen| chosen.kept)
    }

    /// A photon, ready to walk: its weight is its power as though it were the only one \[W\]. None if none leaves this
    /// time, which is for media alone to decide.
    pub fn emit(&self, scene: &Scene, stream: &mut Stream) -> Option<Walker> {
        self.emit_from(scene, stream).1
    }

    /// The same, and the number of the cell that it comes from; 0 where there are no cells.
    pub(super) fn emit_from(&self, scene: &Scene, stream: &mut Stream) -> (usize, Option<Walker>) {
        let (lights, stage) = (scene.lights(), scene.stage());
        let Some(chosen) = &self.chosen else { return (0, by_power(scene, self.power, stream)) };
        let u = stream.unit();
        // The first cell whose sum exceeds u: one without probability is never it.
        let i = chosen.cumulated.partition_point(|sum| *sum <= u).min(chosen.cells.len() - 1);
        let (index, cell) = &chosen.cells[i];
        let light = &lights[*index];
        let needs = light.needs();
        let numbers = cell.numbers((needs.position, needs.direction), stream);
        let emission = light.emit_aimed(stage, &numbers);
        (i, start(scene, *index, &emission, emission.power * chosen.weights[i], stream))
    }
}

/// Power of a light's cell, summed over channels \[W\].
fn share(scene: &Scene, light: usize, cell: &EmissionCell) -> f64 {
    scene.lights()[light].ceiling(scene.stage()).sum() * cell.volume()
}

/// Whether a light's cells have bundles though the whole has none: those of a cuboid, a face each.
fn has_faces(light: &Light) -> bool {
    light.cells(1).first().is_some_and(|cell| light.bundle(cell).is_some())
}

/// A photon from one of the lights, chosen in proportion to power; it carries the power of all of them \[W\], in the
/// colour of its own.
fn by_power(scene: &Scene, power: Spectrum, stream: &mut Stream) -> Option<Walker> {
    let (lights, stage) = (scene.lights(), scene.stage());
    let total = power.sum();
    let part = |power: Spectrum| {
        if planted(Fault::LightByLargestChannel) { power.max() } else { power.sum() }
    };
    let mut index = 0;
    if lights.len() > 1 {
        let mut target = stream.unit() * part(power);
        while index + 1 < lights.len() && target >= part(lights[index].ceiling(stage)) {
            target -= part(lights[index].ceiling(stage));
            index += 1;
        }
    }
    let emission = lights[index].emit(stage, stream);
    let own = lights[index].ceiling(stage).sum();
    let weight = if lights.len() > 1 { emission.power * (total / own) } else { emission.power };
    start(scene, index, &emission, weight, stream)
}

/// The walker of a photon that leaves a light, if it does.
fn start(
    scene: &Scene,
    index: usize,
    emission: &Emission,
    weight: Spectrum,
    stream: &mut Stream,
) -> Option<Walker> {
    let weight = if planted(Fault::PowerRaised) { weight * (1.0 + size()) } else { weight };
    let light = &scene.lights()[index];
    let origin = emission.ray.origin;
    if let Light::Glow(glow) = light {
        let is_there = glow.is_certain() || scene.medium_number_at(origin) == Some(glow.number());
        let leaves = is_there && (emission.chance >= 1.0 || stream.unit() < emission.chance);
        return leaves.then(|| Walker { within: glow.within(), ..Walker::new(emission.ray, weight) });
    }
    let from = light.body().map(|_| Start { target: Target::Light(index), primitive: emission.primitive });
    let within = scene.interior_of_light(index, origin);
    Some(Walker { from, within, ..Walker::new(emission.ray, weight) })
}
