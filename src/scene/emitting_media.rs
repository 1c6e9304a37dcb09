//! Media that emit, as lights: their photons start in them.

use super::interiors::is_clear_of;
use super::place::dielectrics;
use super::{SURROUNDINGS, Scene, SceneParts};
use crate::Spectrum;
use crate::geometry::Shape;
use crate::light::{Light, MediumEmission};
use crate::math::FOUR_PI;
use crate::rng::{Purpose, Stream};
use crate::surface::Surface;
use glam::DVec3;

/// Cells of the quadrature of a medium's power when a scene is made: good to some per cent, for choices between lights.
const ROUGH: usize = 1 << 10;

/// The same where measurements are divided by the power: a tenth of a second or so.
const FINE: usize = 1 << 17;

/// A part of the power below which its error does not matter.
const FINE_ENOUGH: f64 = 1e-4;

/// The lights that the media of a scene are, those of regions first; and whether that is all of them: a medium without
/// end, where no cell stands for it, sends out no photon that could be followed.
pub(super) fn of(scene: &Scene) -> (Vec<Light>, bool) {
    let (mut lights, mut is_all) = (Vec::new(), true);
    if !scene.media().iter().any(|medium| medium.is_emitting()) {
        return (lights, is_all);
    }
    let parts = &scene.parts;
    let ball = scene.bounds().map(|ball| Shape::Sphere(*ball));
    let mut add = |number: usize, interior: usize, shapes: &[&Shape], is_certain: bool| {
        let medium = scene.medium(number);
        if !medium.is_emitting() {
            return;
        }
        let periodic_cell = scene.periodic_cell();
        let emission = match shapes {
            [] => None,
            _ => MediumEmission::new((number, interior), medium, shapes, periodic_cell, is_certain),
        };
        match emission {
            Some(emission) => {
                // Thin shells may be missed.
                let rough = measured(scene, &emission, ROUGH).0;
                let power = if rough.is_black() { measured(scene, &emission, FINE).0 } else { rough };
                lights.push(Light::MediumEmission(emission.with_power(power)));
            }
            None => is_all = false,
        }
    };
    for (number, region) in parts.regions.iter().enumerate() {
        let is_alone = number + 1 == parts.regions.len() && !scene.plan().has_dielectrics;
        add(number, SURROUNDINGS, &[&region.shape], is_alone);
    }
    for interior in 0..parts.interiors.len() {
        if let Some(number) = scene.filling(interior) {
            let bodies = enclosing(parts, interior);
            let mut others = dielectrics(&parts.objects).filter(|o| !encloses(&o.surface, interior));
            let is_alone = match bodies.as_deref() {
                Some([body]) if body.is_solid() => {
                    body.bounds().is_some_and(|ball| others.all(|o| is_clear_of(ball, &o.shape)))
                }
                _ => false,
            };
            // About all closed bodies, or behind a surface that encloses nothing, it has no end.
            let shapes = match scene.far.contains(&interior) {
                true => Vec::new(),
                false => bodies.unwrap_or(ball.iter().collect()),
            };
            add(number, interior, &shapes, is_alone);
        }
    }
    (lights, is_all)
}

/// The power of a medium, and its standard error \[W\]: by cells of a box, halved along each axis where a boundary runs through
/// them or the medium varies, down to `most` of them or so. In whole cells of an even medium the power is exact; in the others it is asked
/// for at two random points.
fn measured(scene: &Scene, emission: &MediumEmission, most: usize) -> (Spectrum, Spectrum) {
    let known = Light::MediumEmission(emission.clone()).power(scene.periodic_cell());
    let Some((low, high)) = emission.extent(scene.periodic_cell()).filter(|_| !emission.is_certain()) else {
        return (known, Spectrum::ZERO);
    };
    let (number, medium) = (emission.number(), scene.medium(emission.number()));
    let regions = if emission.interior() == SURROUNDINGS { scene.regions() } else { &[] };
    let bodies = dielectrics(scene.objects()).map(|o| &o.shape);
    let boundaries: Vec<&Shape> = bodies.chain(regions.iter().map(|region| &region.shape)).collect();
    // An open surface decides of places far from itself.
    let is_local = boundaries.iter().all(|shape| shape.is_closed());
    let owns = |p: DVec3| scene.medium_number_at(p) == Some(number);
    let (mut sum, mut squares) = (Spectrum::ZERO, Spectrum::ZERO);
    // Middles of cells, and whether a boundary may run through.
    let mut cells = vec![(0.5 * (low + high), true)];
    let mut half = 0.5 * (high - low);
    // What a cell sends out of an emission of 1.
    let unit = |half: DVec3| FOUR_PI * 8.0 * half.element_product();
    while !cells.is_empty() && cells.len() * 4 <= most {
        half *= 0.5;
        let radius = half.length();
        let mut smaller = Vec::with_capacity(8 * cells.len());
        for (middle, was_near) in cells {
            for corner in 0..8 {
                let sign = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let middle = middle + half * DVec3::new(sign(0), sign(1), sign(2));
                let is_near =
                    was_near && (!is_local || boundaries.iter().any(|b| b.distance(middle, radius) < radius));
                if is_near {
                    smaller.push((middle, true));
                } else if !owns(middle) {
                    continue;
                } else if medium.is_homogeneous() {
                    sum += medium.emission(middle) * unit(half);
                } else {
                    smaller.push((middle, false));
                }
            }
        }
        cells = smaller;
        // Half of the cells' power is as far as they could be off, each by itself.
        let left = 0.5 * (cells.len() as f64).sqrt() * unit(half) * medium.emission(0.5 * (low + high)).max();
        if medium.is_homogeneous() && left < FINE_ENOUGH * sum.max() {
            break;
        }
    }
    for (index, (middle, _)) in cells.iter().enumerate() {
        let mut stream = Stream::new(0, Purpose::Emission, number as u64, index as u64);
        let mut one = || {
            let p = *middle + half * (2.0 * DVec3::from(stream.triple()) - 1.0);
            if owns(p) { medium.emission(p) * unit(half) } else { Spectrum::ZERO }
        };
        let (a, b) = (one(), one());
        sum += (a + b) * 0.5;
        squares += ((a - b) * 0.5).map(|x| x * x);
    }
    (sum, squares.map(f64::sqrt))
}

/// The power of all lights, and its standard error \[W\].
pub(super) fn power(scene: &Scene) -> (Spectrum, Spectrum) {
    let (mut sum, mut squares) = (Spectrum::ZERO, Spectrum::ZERO);
    for light in scene.lights() {
        let (power, error) = match light {
            Light::MediumEmission(emission) => measured(scene, emission, FINE),
            light => (light.power(scene.periodic_cell()), Spectrum::ZERO),
        };
        sum += power;
        squares += error.map(|x| x * x);
    }
    (sum, squares.map(f64::sqrt))
}

/// Whether a surface has an interior on its inside.
fn encloses(surface: &Surface, interior: usize) -> bool {
    matches!(surface, Surface::Dielectric(dielectric) if dielectric.inside() == interior)
}

/// The shapes that an interior lies in, if its boundary encloses it; it may lie in a part of them only.
fn enclosing(parts: &SceneParts, interior: usize) -> Option<Vec<&Shape>> {
    let bodies = parts.objects.iter().filter(|o| encloses(&o.surface, interior));
    let shapes: Vec<&Shape> = bodies.map(|o| &o.shape).collect();
    (!shapes.is_empty() && shapes.iter().all(|shape| shape.is_closed())).then_some(shapes)
}

impl Scene {
    /// Power of all lights \[W\], to [`Scene::power_error`]. Where media emit that fill no simple shape of their own, it takes some
    /// hundredths of a second, the first time.
    pub fn power(&self) -> Spectrum {
        self.answers.power.get_or_init(|| power(self)).0
    }

    /// Standard error of the power, over it: 0 but where media emit whose place is known point by point.
    pub fn power_error(&self) -> Spectrum {
        let (power, error) = *self.answers.power.get_or_init(|| power(self));
        let part = |c: usize| if power[c] > 0.0 { error[c] / power[c] } else { 0.0 };
        Spectrum::rgb(part(0), part(1), part(2))
    }
}
