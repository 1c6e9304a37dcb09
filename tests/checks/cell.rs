//! Photons of an oblique beam in the periodic cell.

use crate::support::scenes::{CELL, Incidence, slab};
use crate::support::verdict::{self, Fit};
use glam::DVec3;
use turbid::math::wrap;
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::transport::{Roulette, Step, Visitor, Walker, walk};

const SQUARES: usize = 8;
pub const HISTORIES: u64 = 1 << 18;
/// Root mean square relative deviation of the density over the cell that is seen: of 2^16 photons or more.
pub const UNEVEN: f64 = 0.05;

/// Counts by square of the cell.
pub fn counts(points: impl Iterator<Item = DVec3>) -> Vec<f64> {
    let mut counts = vec![0.0; SQUARES * SQUARES];
    for p in points {
        let index = |x: f64| ((x / CELL * SQUARES as f64) as usize).min(SQUARES - 1);
        counts[SQUARES * index(p.x) + index(p.y)] += 1.0;
    }
    counts
}

/// Whether independent photons lie evenly over the cell.
pub fn evenness(counts: &[f64]) -> Fit {
    let even = counts.iter().sum::<f64>() / counts.len() as f64;
    verdict::counted(counts, &vec![even; counts.len()])
}

/// Where first collisions of an oblique beam are, unwrapped.
struct First(Vec<DVec3>);

impl Visitor for First {
    fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
        if let Step::Collision(arrival, _) = step
            && walker.order == 1
        {
            self.0.push(arrival.position);
        }
    }
}

/// The positions of the first photons that were scattered once, as they fly.
pub fn unwrapped(scene: &Scene) -> Vec<DVec3> {
    let mut visitor = First(Vec::new());
    for history in 0..HISTORIES {
        let mut stream = Stream::new(2, Purpose::Photons, 0, history);
        let emission = scene.lights()[0].emit(scene.periodic_cell(), &mut stream);
        let start = Walker::new(emission.ray, emission.power);
        walk(scene, start, Roulette::Analog, None, &mut stream, &mut visitor);
    }
    visitor.0
}

/// The wrapped position: modulo the cell's side.
pub fn wrapped(p: DVec3) -> DVec3 {
    wrap(p, glam::DVec2::splat(CELL))
}

/// The same position under four mirrors: reflected back and forth.
pub fn mirrored(p: DVec3) -> DVec3 {
    let twice = wrap(p, glam::DVec2::splat(2.0 * CELL));
    let back = |x: f64| if x > CELL { 2.0 * CELL - x } else { x };
    DVec3::new(back(twice.x), back(twice.y), p.z)
}

/// Photons of an oblique beam lie evenly over the cell, however they are brought into it.
pub fn an_oblique_beam_fills_the_cell_evenly(place: fn(DVec3) -> DVec3) {
    let points = unwrapped(&slab(2.0, 0.9, 0.75, Incidence::Beam(0.3)));
    verdict::fits("oblique beam", evenness(&counts(points.into_iter().map(place))), UNEVEN, 2);
}
