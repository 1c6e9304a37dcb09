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
use crate::geometry::Shape;
use crate::light::{Bundle, Emission, EmissionCell, Light};
use crate::rng::Stream;
use crate::scene::{Scene, Start, Target};
use crate::transport::Walker;
use glam::DVec3;

/// Cells that the numbers of a light are cut into, about: each is tested against every specular body, which takes less
/// than a microsecond, and a body that fills a thousandth of what a light sees still fills sixteen of them.
const CELLS: usize = 1 << 14;

/// Emission is restricted to what can meet the scene if that is at most this part of the power. Photons that escape cost a
/// test against the bodies and nothing else: above a half, to leave them out would not even halve that.
const WORTH: f64 = 0.5;

/// How often cells are cut in four where few are left: the sides of the smallest, a thousandth of the first ones', are ten
/// thousand times what rounding may move a ray of a bundle by (1e-9).
const HALVINGS: usize = 10;

/// From where photons leave the lights, and how often.
#[derive(Debug, Clone)]
pub struct Emitter {
    /// What photons of all lights carry together if none is refused \[W\].
    power: Spectrum,
    chosen: Option<Chosen>,
    /// Cells that were tested against bodies.
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
    /// Power that the lights send out elsewhere, summed over channels \[W\].
    left_out: f64,
}

impl Emitter {
    /// All that the lights send out, in proportion to power.
    pub fn by_power(scene: &Scene) -> Self {
        Emitter { power: scene.power_bound(), chosen: None, tested: 0 }
    }

    /// What can meet anything at all: cells of the lights' numbers whose rays can reach the sphere about a body or about a
    /// medium in which light collides. What the other cells send out escapes, and [`Emitter::left_out`] says how much.
    ///
    /// All that the lights send out, as [`Emitter::by_power`] emits it, where more than `WORTH` of the power is kept,
    /// where a body or a medium has no end, where no light reaches anything, and where a plan leaves nothing out.
    pub fn towards_scene(scene: &Scene) -> Self {
        let aimed = cells_towards_scene(scene, CELLS).and_then(|(cells, tested)| {
            let shares = cells.iter().map(|(light, cell)| share(scene, *light, cell)).collect();
            Self::chosen(scene, cells, shares, tested)
        });
        aimed.unwrap_or_else(|| Self::by_power(scene))
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
            let Some(balls) = balls.as_ref().filter(|_| has_bundles(light)) else {
                cells.push((index, EmissionCell::WHOLE));
                continue;
            };
            let reaches =
                |bundle: &Bundle| balls.iter().any(|(center, radius)| bundle.reaches(*center, *radius));
            tested += keep(light, light.cells(CELLS), &reaches, |cell| cells.push((index, cell)));
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
        let power = scene.power_bound();
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
        // Of media the power itself: their bounds are what photons are refused by.
        let sent = |light: &Light| light.power(scene.periodic_cell()).sum();
        let used = |index: usize| {
            let own =
                cells.iter().zip(&chances).filter(|((light, _), chance)| *light == index && **chance > 0.0);
            own.map(|((_, cell), _)| cell.volume()).sum::<f64>()
        };
        let lights = scene.lights().iter().enumerate();
        let left_out = lights.map(|(index, light)| sent(light) * (1.0 - used(index)).max(0.0)).sum();
        Some(Emitter { power, chosen: Some(Chosen { cells, cumulated, weights, kept, left_out }), tested })
    }

    /// How many cells were tested against bodies.
    pub fn projection_cells(&self) -> u64 {
        self.tested
    }

    /// Power that photons are sent out for, over that of all lights.
    pub fn kept(&self) -> f64 {
        self.chosen.as_ref().map_or(1.0, |chosen| chosen.kept)
    }

    /// Power that the lights send where photons are not sent, summed over channels \[W\].
    pub fn left_out(&self) -> f64 {
        self.chosen.as_ref().map_or(0.0, |chosen| chosen.left_out)
    }

    /// A photon, ready to walk: its weight is its power as though it were the only one \[W\]. None if none leaves this
    /// time, which is for media alone to decide.
    pub fn emit(&self, scene: &Scene, stream: &mut Stream) -> Option<Walker> {
        self.emit_from(scene, stream).1
    }

    /// The same, and the number of the cell that it comes from; 0 where there are no cells.
    pub(super) fn emit_from(&self, scene: &Scene, stream: &mut Stream) -> (usize, Option<Walker>) {
        let (lights, periodic_cell) = (scene.lights(), scene.periodic_cell());
        let Some(chosen) = &self.chosen else { return (0, by_power(scene, self.power, stream)) };
        let u = stream.unit();
        // The first cell whose sum exceeds u: one without probability is never it.
        let i = chosen.cumulated.partition_point(|sum| *sum <= u).min(chosen.cells.len() - 1);
        let (index, cell) = &chosen.cells[i];
        let light = &lights[*index];
        let needs = light.needs();
        let numbers = cell.numbers((needs.position, needs.direction), stream);
        let emission = light.emit_aimed(periodic_cell, &numbers);
        (i, start(scene, *index, &emission, emission.power * chosen.weights[i], stream))
    }
}

/// Power of a light's cell, summed over channels \[W\].
fn share(scene: &Scene, light: usize, cell: &EmissionCell) -> f64 {
    scene.lights()[light].power_bound(scene.periodic_cell()).sum() * cell.volume()
}

/// Whether a light's cells have bundles; those of a cuboid have them a face each, though the whole has none.
fn has_bundles(light: &Light) -> bool {
    let has_one = |cell: &EmissionCell| light.bundle(cell).is_some();
    has_one(&EmissionCell::WHOLE) || light.cells(1).first().is_some_and(has_one)
}

/// Hands over those of a light's cells whose rays can reach something; returns how many were tested.
fn keep(
    light: &Light,
    cells: Vec<EmissionCell>,
    reaches: &dyn Fn(&Bundle) -> bool,
    mut take: impl FnMut(EmissionCell),
) -> u64 {
    let tested = cells.len() as u64;
    cells
        .into_iter()
        .filter(|cell| light.bundle(cell).is_none_or(|bundle| reaches(&bundle)))
        .for_each(&mut take);
    tested
}

/// Cells of the lights' numbers, about `count` a light, from which light can meet anything, and how many were tested; none
/// where [`Emitter::towards_scene`] leaves nothing out.
pub(super) fn cells_towards_scene(scene: &Scene, count: usize) -> Option<(Vec<(usize, EmissionCell)>, u64)> {
    let (bounds, power) = (scene.bounds()?, scene.power_bound().sum());
    if scene.plan().is_full || scene.periodic_cell().is_some() || fills_space(scene) {
        return None;
    }
    let media = scene.regions().iter().filter(|r| r.medium.is_colliding()).map(|r| &r.shape);
    let shapes: Vec<&Shape> = media.chain(scene.objects().iter().map(|o| &o.shape)).collect();
    let balls = shapes.iter().map(|shape| shape.bounds()).collect::<Option<Vec<_>>>()?;
    let (mut chosen, mut tested, mut kept) = (Vec::new(), 0, 0.0);
    for (index, light) in scene.lights().iter().enumerate() {
        if !has_bundles(light) {
            chosen.push((index, EmissionCell::WHOLE));
            kept += share(scene, index, &EmissionCell::WHOLE);
            continue;
        }
        // What stands in the way of light keeps it from escaping, the bodies of other lights too.
        let others = scene.lights().iter().enumerate().filter(|(other, _)| *other != index);
        let bodies: Vec<_> = others.filter_map(|(_, l)| l.body()?.bounds()).collect();
        let reaches = |bundle: &Bundle| {
            bundle.reaches(bounds.center(), bounds.radius())
                && balls.iter().chain(&bodies).any(|(center, radius)| bundle.reaches(*center, *radius))
        };
        let mut cells = Vec::new();
        tested += keep(light, light.cells(count), &reaches, |cell| cells.push(cell));
        for _ in 0..HALVINGS {
            let quarters: Vec<EmissionCell> = cells.iter().flat_map(|cell| light.quarters(cell)).collect();
            if quarters.len() > count {
                break;
            }
            let mut smaller = Vec::new();
            tested += keep(light, quarters, &reaches, |cell| smaller.push(cell));
            cells = smaller;
        }
        kept += cells.iter().map(|cell| share(scene, index, cell)).sum::<f64>();
        chosen.extend(cells.into_iter().map(|cell| (index, cell)));
    }
    (kept <= WORTH * power).then_some((chosen, tested))
}

/// Whether a medium that fills an interior reaches out of the scene, so that light meets it everywhere.
fn fills_space(scene: &Scene) -> bool {
    let Some(bounds) = scene.bounds() else { return true };
    let outside = |dir: DVec3| scene.interior_at(bounds.center() + dir * (2.0 * bounds.radius()));
    DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).any(|dir| scene.filling(outside(dir)).is_some())
}

/// A photon from one of the lights, chosen in proportion to power; it carries the power of all of them \[W\], in the
/// colour of its own.
fn by_power(scene: &Scene, power: Spectrum, stream: &mut Stream) -> Option<Walker> {
    let (lights, periodic_cell) = (scene.lights(), scene.periodic_cell());
    let total = power.sum();
    let part = |power: Spectrum| {
        if planted(Fault::LightByLargestChannel) { power.max() } else { power.sum() }
    };
    let mut index = 0;
    if lights.len() > 1 {
        let mut target = stream.unit() * part(power);
        while index + 1 < lights.len() && target >= part(lights[index].power_bound(periodic_cell)) {
            target -= part(lights[index].power_bound(periodic_cell));
            index += 1;
        }
    }
    let emission = lights[index].emit(periodic_cell, stream);
    let own = lights[index].power_bound(periodic_cell).sum();
    let weight = if lights.len() > 1 { emission.power * (total / own) } else { emission.power };
    start(scene, index, &emission, weight, stream)
}

/// A photon from the light of this index, if one leaves it this time; it carries that light's power \[W\].
pub(crate) fn from_light(scene: &Scene, index: usize, stream: &mut Stream) -> Option<Walker> {
    let emission = scene.lights()[index].emit(scene.periodic_cell(), stream);
    start(scene, index, &emission, emission.power, stream)
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
    if let Light::MediumEmission(medium) = light {
        let is_there = medium.is_certain() || scene.medium_number_at(origin) == Some(medium.number());
        let leaves = is_there && (emission.chance >= 1.0 || stream.unit() < emission.chance);
        return leaves.then(|| Walker { interior: medium.interior(), ..Walker::new(emission.ray, weight) });
    }
    let origin_surface =
        light.body().map(|_| Start { target: Target::Light(index), primitive: emission.primitive });
    let interior = scene.interior_of_light(index, origin);
    Some(Walker { origin_surface, interior, ..Walker::new(emission.ray, weight) })
}
