//! The folded cell: photons of an oblique beam lie evenly over it. Mirrors in its place would not do.

use crate::support::run::pass;
use crate::support::scenes::{CELL, Incidence, slab};
use crate::support::verdict;
use glam::DVec3;
use turbid::photons::{Photon, fold};
use turbid::rng::{Purpose, Stream};
use turbid::scene::Scene;
use turbid::stats::chi_squared_test;
use turbid::transport::{Roulette, Step, Visitor, Walker, walk};

const SQUARES: usize = 8;
const N: u64 = 1 << 18;

/// Counts by square of the cell.
fn counts(points: impl Iterator<Item = DVec3>) -> Vec<f64> {
    let mut counts = vec![0.0; SQUARES * SQUARES];
    for p in points {
        let index = |x: f64| ((x / CELL * SQUARES as f64) as usize).min(SQUARES - 1);
        counts[SQUARES * index(p.x) + index(p.y)] += 1.0;
    }
    counts
}

fn p_of_even(counts: &[f64]) -> f64 {
    let even = counts.iter().sum::<f64>() / counts.len() as f64;
    chi_squared_test(counts, &vec![even; counts.len()], 0).p
}

/// One order at a time: a history has at most one photon of each, so that the counts are independent.
#[test]
fn photons_of_an_oblique_beam_lie_evenly_over_the_cell() {
    for how in [Incidence::Beam(0.3), Incidence::Beam(1.0), Incidence::Diffuse] {
        let scene = slab(2.0, 0.9, 0.75, how);
        let photons = pass(&scene, &[], N, 1, |p| p.order < 4).photons;
        assert!(
            photons
                .iter()
                .all(|p| (0.0..CELL).contains(&p.position.x) && (0.0..CELL).contains(&p.position.y))
        );
        for order in 0..4 {
            let found = counts(photons.iter().filter(|p| p.order == order).map(|p| p.position));
            assert!(found.iter().sum::<f64>() > 1e5 || order > 1);
            verdict::fits(&format!("{how:?}, order {order}"), p_of_even(&found), 1);
        }
    }
}

/// Where first collisions of an oblique beam are, without the fold.
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

fn unfolded(scene: &Scene) -> Vec<DVec3> {
    let mut visitor = First(Vec::new());
    for history in 0..N {
        let mut stream = Stream::new(2, Purpose::Photons, 0, history);
        let emission = scene.lights()[0].emit(scene.stage(), &mut stream);
        walk(
            scene,
            Walker::new(emission.ray, emission.power),
            Roulette::Analog,
            None,
            &mut stream,
            &mut visitor,
        );
    }
    visitor.0
}

/// The same positions under four mirrors: reflected back and forth instead of taken modulo the side.
#[test]
fn four_mirrors_are_a_wrong_twin() {
    let points = unfolded(&slab(2.0, 0.9, 0.75, Incidence::Beam(0.3)));
    verdict::fits("folded", p_of_even(&counts(points.iter().map(|p| fold::into_cell(*p, CELL)))), 2);
    let mirrored = points.iter().map(|p| {
        let twice = fold::into_cell(*p, 2.0 * CELL);
        let back = |x: f64| if x > CELL { 2.0 * CELL - x } else { x };
        DVec3::new(back(twice.x), back(twice.y), p.z)
    });
    verdict::misfits("mirrored", p_of_even(&counts(mirrored)), 2);
    // Directions that are as often left as right hide the mistake: that is why it is plausible.
    let symmetric = unfolded(&slab(2.0, 0.9, 0.75, Incidence::Diffuse));
    verdict::fits(
        "diffuse, folded",
        p_of_even(&counts(symmetric.iter().map(|p| fold::into_cell(*p, CELL)))),
        2,
    );
}

/// With copies around the cell every ball about a point of the cell meets what it would meet in the endless lattice,
/// each photon once; without copies it does not.
#[test]
fn copies_around_the_cell_are_those_of_the_lattice() {
    let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
    let photon = |position: DVec3| Photon {
        position,
        dir: glam::Vec3::Z,
        power: glam::Vec3::ONE,
        order: 0,
        flags: turbid::photons::Flags::NONE,
    };
    let photons: Vec<Photon> =
        (0..500).map(|_| photon(DVec3::from_array(stream.triple()) * DVec3::new(CELL, CELL, 1.0))).collect();
    for margin in [0.3, 0.5 * CELL, 0.8 * CELL, CELL] {
        let mut around = photons.clone();
        fold::surround(&mut around, CELL, margin);
        let mut missed_without_copies = 0;
        for _ in 0..200 {
            let probe = DVec3::from_array(stream.triple()) * DVec3::new(CELL, CELL, 1.0);
            let is_near = |p: DVec3| p.distance(probe) <= margin;
            let found = around.iter().filter(|p| is_near(p.position)).count();
            let shifts = (-2..=2)
                .flat_map(|i| (-2..=2).map(move |j| DVec3::new(f64::from(i), f64::from(j), 0.0) * CELL));
            let expected: usize =
                shifts.map(|shift| photons.iter().filter(|p| is_near(p.position + shift)).count()).sum();
            assert_eq!(found, expected, "margin {margin}, probe {probe}");
            missed_without_copies +=
                usize::from(photons.iter().filter(|p| is_near(p.position)).count() != expected);
        }
        assert!(missed_without_copies > 0);
    }
}
