//! The periodic cell: photons of an oblique beam lie evenly over it. Mirrors in its place would not do.

use crate::checks::cell::{
    HISTORIES, UNEVEN, an_oblique_beam_fills_the_cell_evenly, counts, evenness, mirrored, unwrapped, wrapped,
};
use crate::support::run::pass;
use crate::support::scenes::{CELL, Incidence, layer, slab};
use crate::support::verdict;
use glam::{DVec2, DVec3};
use turbid::estimators::boundary::{Boundary, Treatment};
use turbid::estimators::{Estimator, Gather, Kernel, count_within};
use turbid::photons::{Photon, PhotonMap, Photons};
use turbid::rng::{Purpose, Stream};
use turbid::transport::NoProgress;

/// One order at a time: a history has at most one photon of each, so that the counts are independent.
#[test]
fn photons_of_an_oblique_beam_lie_evenly_over_the_cell() {
    for how in [Incidence::Beam(0.3), Incidence::Beam(1.0), Incidence::Diffuse] {
        let scene = slab(2.0, 0.9, 0.75, how);
        let photons = pass(&scene, &[], HISTORIES, 1, |p| p.order < 4).photons().collect::<Vec<_>>();
        assert!(
            photons
                .iter()
                .all(|p| (0.0..CELL).contains(&p.position.x) && (0.0..CELL).contains(&p.position.y))
        );
        for order in 0..4 {
            let found = counts(photons.iter().filter(|p| p.order == order).map(|p| p.position));
            assert!(found.iter().sum::<f64>() > 1e5 || order > 1);
            verdict::fits(&format!("{how:?}, order {order}"), evenness(&found), UNEVEN, 1);
        }
    }
}

/// Wrapped, the photons of an oblique beam are even; under four mirrors they are not.
#[test]
fn four_mirrors_are_rejected() {
    an_oblique_beam_fills_the_cell_evenly(wrapped);
    let points = unwrapped(&slab(2.0, 0.9, 0.75, Incidence::Beam(0.3)));
    verdict::misfits("mirrored", evenness(&counts(points.into_iter().map(mirrored))), 2);
    // Directions that are as often left as right hide the mistake: that is why it is plausible.
    let symmetric = unwrapped(&slab(2.0, 0.9, 0.75, Incidence::Diffuse));
    let even = evenness(&counts(symmetric.into_iter().map(wrapped)));
    verdict::fits("diffuse, wrapped", even, UNEVEN, 2);
}

/// With copies around the cell every ball about a point of the cell meets what it would meet in the endless lattice,
/// each photon once; without copies it does not. Square cells, and others.
#[test]
fn copies_around_the_cell_are_those_of_the_lattice() {
    for side in [DVec2::splat(CELL), DVec2::new(CELL, 1.7 * CELL), DVec2::new(1.2 * CELL, CELL)] {
        copies_are_those_of_the_lattice(side);
    }
}

fn copies_are_those_of_the_lattice(side: DVec2) {
    let mut stream = Stream::new(3, Purpose::Synthetic, 0, 0);
    let photon = |position: DVec3| Photon {
        position,
        dir: glam::Vec3::Z,
        normal: glam::Vec3::ZERO,
        power: glam::Vec3::ONE,
        order: 0,
        flags: turbid::photons::Flags::NONE,
    };
    let photons: Photons =
        (0..500).map(|_| photon(DVec3::from_array(stream.triple()) * side.extend(1.0))).collect();
    let map = |reach: f64| PhotonMap::periodic(vec![photons.clone()], 1, Some((side, reach)), &NoProgress);
    assert!(map(1.01 * CELL).is_err() && map(-0.1).is_err());
    for margin in [0.3, 0.5 * CELL, 0.8 * CELL, CELL] {
        let (around, alone) = (map(margin).unwrap(), map(0.0).unwrap());
        let gather = Gather::radius(margin).unwrap();
        let medium = layer(1.0);
        let boundary = Boundary::of(&medium).unwrap();
        let mut missed_without_copies = 0;
        for number in 0..200 {
            let probe = DVec3::from_array(stream.triple()) * side.extend(1.0);
            let shifts = (-2..=2).flat_map(|i| {
                (-2..=2).map(move |j| DVec3::new(f64::from(i), f64::from(j), 0.0) * side.extend(0.0))
            });
            // The tree holds positions to a part in 2^24 of its box.
            let [least, most] = [-1e-6, 1e-6].map(|rounding| {
                let is_near = |p: DVec3| p.distance(probe) <= margin + rounding;
                let near = |shift: DVec3| photons.iter().filter(|p| is_near(p.position + shift)).count();
                shifts.clone().map(near).sum::<usize>()
            });
            // Asked anywhere in the lattice.
            let there = probe
                + DVec3::new(f64::from(number % 7 - 3), f64::from(number % 5 - 2), 0.0) * side.extend(0.0);
            let found = count_within(&around, there, margin);
            assert!((least..=most).contains(&found), "margin {margin}, {probe}: {found}, {least} to {most}");
            // Without copies only balls within the cell have an estimate.
            let is_inside = (0..2).all(|axis| (margin..=side[axis] - margin).contains(&probe[axis]));
            for treatment in Treatment::ALL {
                let estimator = Estimator::new(Kernel::Uniform, gather).treated(treatment);
                let value = estimator.collision_density(&alone, there, &boundary).value[0];
                assert_eq!(value.is_finite(), is_inside, "{treatment:?}, margin {margin}, {probe}");
            }
            missed_without_copies += usize::from(!is_inside);
        }
        assert!(missed_without_copies > 0);
    }
}
