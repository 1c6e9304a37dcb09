//! The photon tree against brute force in f64 over the positions it holds.

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use turbid::math::warp;
use turbid::photons::tree::{Counted, Nearest, Neighbors, Shell};
use turbid::photons::{Flags, Photon, PhotonTree};
use turbid::rng::{Purpose, Stream};
use turbid::{Error, Result};

fn photon(position: DVec3, tag: u32) -> Photon {
    let mut stream = Stream::new(7, Purpose::Synthetic, 0, u64::from(tag));
    Photon {
        position,
        dir: warp::square_to_sphere(stream.pair()).as_vec3(),
        normal: Vec3::ZERO,
        power: Vec3::new(stream.unit() as f32, 1.0, tag as f32),
        order: tag as u16,
        flags: if tag.is_multiple_of(2) { Flags::MEDIUM } else { Flags::NONE },
    }
}

fn photons(positions: impl IntoIterator<Item = DVec3>) -> Vec<Photon> {
    positions.into_iter().zip(0..).map(|(position, tag)| photon(position, tag)).collect()
}

fn scattered(count: u32, seed: u64) -> Vec<DVec3> {
    let mut stream = Stream::new(seed, Purpose::Synthetic, 0, 0);
    (0..count).map(|_| DVec3::new(stream.unit(), stream.unit(), stream.unit())).collect()
}

/// Places found within a radius, in the order of the visit.
fn within(tree: &PhotonTree, centre: DVec3, radius: f64) -> Vec<usize> {
    let mut places = Vec::new();
    tree.within(centre, radius, &mut |found: Neighbors<'_>| places.extend(found.places().map(|(_, p)| p)));
    places
}

/// The shell and, by place, how much of each photon counts.
fn nearest(tree: &PhotonTree, centre: DVec3, k: usize, cap: f64) -> (Option<Shell>, Vec<(usize, f32)>) {
    let mut places = Vec::new();
    let result = tree.nearest(centre, k, cap, Counted::BelowKth, &mut |found: Neighbors<'_>| {
        places.extend(found.places().map(|(_, place)| (place, found.share())));
    });
    match result {
        Nearest::Found(shell) => (Some(shell), places),
        Nearest::Underfull => (None, places),
    }
}

/// How far a distance in the tree may be from that of the positions it holds: the query point is rounded by
/// one resolution a coordinate, and the arithmetic adds 4 x 2^-24 of the distance.
fn error_of(tree: &PhotonTree, distance: f64) -> f64 {
    2.0 * tree.resolution() + distance * 4.0 / f64::from(1 << 24)
}

fn check_within(tree: &PhotonTree, centre: DVec3, radius: f64) {
    let found = within(tree, centre, radius);
    assert!(found.is_sorted_by(|a, b| a < b), "visited in the tree's order, each photon once");
    let margin = error_of(tree, radius);
    for (place, photon) in tree.photons().enumerate() {
        let distance = photon.position.distance(centre);
        let is_found = found.binary_search(&place).is_ok();
        assert!(is_found || distance > radius - margin, "missed {place} at {distance}, radius {radius}");
        assert!(!is_found || distance <= radius + margin, "found {place} at {distance}, radius {radius}");
    }
}

fn check_nearest(tree: &PhotonTree, centre: DVec3, k: usize, cap: f64) {
    let (shell, found) = nearest(tree, centre, k, cap);
    let mut distances: Vec<f64> = tree.photons().map(|photon| photon.position.distance(centre)).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let kth = distances.get(k - 1).copied().unwrap_or(f64::INFINITY);
    let margin = error_of(tree, kth.min(cap));
    let Some(shell) = shell else {
        assert!(kth > cap - margin, "the {k}-th is at {kth}, the cap {cap}");
        assert!(found.is_empty());
        return;
    };
    assert!((shell.radius - kth).abs() <= margin, "radius {} for {kth}", shell.radius);
    assert!(shell.closer < k && shell.closer + shell.tied >= k);
    let counted: f64 = found.iter().map(|&(_, share)| f64::from(share)).sum();
    assert!((counted - (k as f64 - 1.0)).abs() < 1e-6 * k as f64, "{counted} photons count of k = {k}");
    for (place, _) in found {
        assert!(tree.photon(place).position.distance(centre) <= shell.radius + error_of(tree, shell.radius));
    }
}

#[test]
fn finds_what_brute_force_finds() -> Result<()> {
    for count in [1, 2, 15, 16, 17, 31, 33, 255, 256, 257, 4_097, 20_000] {
        let tree = PhotonTree::new(photons(scattered(count, u64::from(count))))?;
        assert_eq!(tree.len(), count as usize);
        for (query, centre) in scattered(12, 99).into_iter().enumerate() {
            let centre = centre * 1.4 - 0.2;
            check_within(&tree, centre, [0.01, 0.05, 0.2, 0.7, 2.5][query % 5]);
            for k in [1, 2, 16, 100, 300, 5_000] {
                check_nearest(&tree, centre, k, if query % 2 == 0 { 10.0 } else { 0.15 });
            }
        }
    }
    Ok(())
}

#[test]
fn a_march_through_strong_contrast_finds_what_brute_force_finds() -> Result<()> {
    // A dense sheet in a thin mist: guesses from the last search are wrong by orders of magnitude at its
    // faces.
    let mist = scattered(2_000, 1);
    let sheet = scattered(30_000, 2).into_iter().map(|p| DVec3::new(p.x, p.y, 0.5 + 1e-3 * p.z));
    let tree = PhotonTree::new(photons(mist.into_iter().chain(sheet)))?;
    for step in 0..60 {
        let centre = DVec3::new(0.4, 0.6, f64::from(step) / 60.0);
        check_nearest(&tree, centre, 50, 10.0);
        check_within(&tree, centre, 0.08);
    }
    Ok(())
}

#[test]
fn degenerate_sets() -> Result<()> {
    let empty = PhotonTree::new(Vec::new())?;
    assert!(empty.is_empty() && within(&empty, DVec3::ZERO, 1.0).is_empty());
    assert_eq!(nearest(&empty, DVec3::ZERO, 1, 1.0), (None, vec![]));

    let equal = PhotonTree::new(photons(vec![DVec3::new(3.0, -1.0, 2.0); 100]))?;
    let beside = DVec3::new(3.0, -1.0, 2.5);
    assert_eq!(within(&equal, beside, 0.5).len(), 100, "a photon exactly at the radius is inside");
    assert!(within(&equal, beside, 0.49).is_empty());
    let (shell, found) = nearest(&equal, beside, 21, 1.0);
    assert_eq!(shell, Some(Shell { radius: 0.5, closer: 0, tied: 100, coincident: 0 }));
    assert!(found.iter().all(|&(_, share)| share == 0.2), "20 of 100 count: a fifth of each");

    let line = PhotonTree::new(photons((0..1000).map(|i| DVec3::new(f64::from(i), 0.0, 0.0))))?;
    assert_eq!(within(&line, DVec3::new(500.0, 0.0, 0.0), 3.0).len(), 7);
    let (shell, _) = nearest(&line, DVec3::new(500.0, 0.0, 0.0), 6, 10.0);
    assert_eq!(shell, Some(Shell { radius: 3.0, closer: 5, tied: 2, coincident: 0 }));

    let origin = PhotonTree::new(photons(vec![DVec3::ZERO; 3]))?;
    assert_eq!(within(&origin, DVec3::new(0.0, 0.0, 0.25), 0.25).len(), 3);
    Ok(())
}

#[test]
fn lengths_beyond_single_precision() -> Result<()> {
    for scale in [1e-300, 1e-30, 1.0, 1e30, 1e300] {
        let place = |x: f64, y: f64| DVec3::new(x * scale, y * scale, 0.0);
        let tree = PhotonTree::new(photons([place(0.0, 0.0), place(1.0, 0.0), place(0.0, 3.0)]))?;
        assert_eq!(within(&tree, place(0.0, 0.0), 2.0 * scale).len(), 2, "at {scale}");
        let (shell, _) = nearest(&tree, place(1.0, 1.0), 2, 100.0 * scale);
        assert!((shell.unwrap().radius / scale - 2.0f64.sqrt()).abs() < 1e-6, "at {scale}");
        // A radius that sees the map as one point, from inside and from outside.
        if scale < 1.0 {
            assert_eq!(within(&tree, DVec3::ZERO, 1.0).len(), 3);
            assert_eq!(within(&tree, DVec3::new(0.5, 0.0, 0.0), 1.0).len(), 3);
            assert_eq!(within(&tree, DVec3::new(1.5, 0.0, 0.0), 1.0).len(), 0);
            let (shell, found) = nearest(&tree, DVec3::new(0.5, 0.0, 0.0), 2, 1.0);
            assert_eq!(shell, Some(Shell { radius: 0.5, closer: 0, tied: 3, coincident: 0 }));
            assert_eq!(found.len(), 3);
        }
    }
    let far = PhotonTree::new(photons(scattered(50, 3)))?;
    let away = DVec3::new(1e100, 0.0, 0.0);
    assert!(within(&far, away, 1.0).is_empty());
    assert_eq!(within(&far, away, 2e100).len(), 50);
    assert_eq!(nearest(&far, away, 5, 1.0).0, None);
    assert_eq!(nearest(&far, away, 5, 2e100).0.unwrap().tied, 50);
    Ok(())
}

#[test]
fn duplicates_of_the_query_point_are_counted_and_stepped_over() -> Result<()> {
    let mut positions = vec![DVec3::splat(0.25); 40];
    positions.extend([DVec3::new(0.75, 0.25, 0.25), DVec3::splat(1.0), DVec3::ZERO - 0.25]);
    let tree = PhotonTree::new(photons(positions))?;
    let centre = DVec3::splat(0.25);
    for k in [2, 10, 40] {
        let (shell, found) = nearest(&tree, centre, k, 10.0);
        assert_eq!(shell, Some(Shell { radius: 0.5, closer: 40, tied: 1, coincident: 40 }));
        assert_eq!(found.len(), 40, "all at the centre count, the one on the shell does not");
    }
    let (shell, _) = nearest(&tree, centre, 41, 10.0);
    assert_eq!(shell, Some(Shell { radius: 0.5, closer: 40, tied: 1, coincident: 0 }));
    assert_eq!(
        nearest(&tree, centre, 10, 0.4),
        (None, vec![]),
        "none but those at the centre is within the cap"
    );
    Ok(())
}

#[test]
fn holds_every_photon_once_and_unchanged_but_for_position() -> Result<()> {
    let given = photons(scattered(5_000, 4));
    let tree = PhotonTree::new(given.clone())?;
    let mut held: Vec<Photon> = tree.photons().collect();
    held.sort_unstable_by_key(|photon| photon.power.z as u32);
    for (held, given) in held.iter().zip(&given) {
        let moved = (held.position - given.position).abs().max_element();
        assert!(moved <= tree.resolution(), "moved by {moved}, resolution {}", tree.resolution());
        assert_eq!(Photon { position: given.position, ..*held }, *given);
    }
    // A unit is at most the box's longest edge, so 2^-25 of it bounds the resolution.
    assert!(tree.resolution() <= 1.0 / f64::from(1u32 << 25));
    assert!(tree.bytes() as f64 / 5_000.0 < 43.0, "{} bytes a photon", tree.bytes() as f64 / 5_000.0);
    Ok(())
}

#[test]
fn refuses_what_is_not_finite() {
    let mut given = photons(scattered(20, 5));
    given[3].position.y = f64::NAN;
    given[8].position.x = f64::INFINITY;
    given[9].power.x = f32::NAN;
    assert_eq!(PhotonTree::new(given).err(), Some(Error::NonFinite { count: 3, place: "stored photons" }));
}

/// Everything the tree holds, in its order.
fn contents(tree: &PhotonTree) -> Vec<Photon> {
    tree.photons().collect()
}

#[test]
fn the_number_of_threads_changes_nothing() -> Result<()> {
    let given = photons(scattered(70_000, 6));
    let alone = contents(&PhotonTree::new(given.clone())?);
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together = pool.install(|| PhotonTree::new_parallel(given.clone()))?;
        assert!(contents(&together) == alone, "{threads} threads");
    }
    Ok(())
}

#[test]
fn the_order_of_arrival_changes_nothing() -> Result<()> {
    // Many equal coordinates and equal positions: the records must decide.
    let lattice = (0..6_000u32).map(|i| DVec3::new(f64::from(i % 7), f64::from(i % 5), f64::from(i % 3)));
    for positions in [scattered(6_000, 8), lattice.collect()] {
        let mut given = photons(positions);
        let sorted = contents(&PhotonTree::new(given.clone())?);
        given.reverse();
        assert!(contents(&PhotonTree::new(given.clone())?) == sorted);
        let mut stream = Stream::new(9, Purpose::Resampling, 0, 0);
        for last in (1..given.len()).rev() {
            given.swap(last, stream.index(last + 1));
        }
        assert!(contents(&PhotonTree::new(given)?) == sorted);
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::common::config(200))]

    /// Clouds squeezed by up to 10^12 along each axis, with duplicates: what brute force finds.
    #[test]
    fn squeezed_clouds(
        count in 1u32..400,
        seed in any::<u64>(),
        squeeze in [0.0..12.0, 0.0..12.0, 0.0..12.0],
        repeats in 1usize..4,
        k in 1usize..60,
        radius in 0.001..2.0f64,
        shift in -1e3..1e3f64,
    ) {
        let by = DVec3::from_array(squeeze.map(|digits: f64| 1.0 / libm::exp10(digits)));
        let positions: Vec<DVec3> = scattered(count, seed)
            .into_iter()
            .flat_map(|p| std::iter::repeat_n(p * by + shift, repeats))
            .collect();
        let centre = positions[0] + DVec3::splat(0.1) * by;
        let tree = PhotonTree::new(photons(positions)).unwrap();
        check_within(&tree, centre, radius * by.max_element());
        if k > repeats {
            check_nearest(&tree, centre, k, 3.0 * by.max_element());
        }
    }

    /// A map scaled by a power of two holds the same photons in the same order, and finds them alike.
    #[test]
    fn powers_of_two_change_no_bit(count in 1u32..300, seed in any::<u64>(), exponent in -40i32..40) {
        let scale = libm::ldexp(1.0, exponent);
        let plain = PhotonTree::new(photons(scattered(count, seed))).unwrap();
        let scaled = PhotonTree::new(photons(scattered(count, seed).into_iter().map(|p| p * scale))).unwrap();
        for (a, b) in plain.photons().zip(scaled.photons()) {
            prop_assert_eq!(Photon { position: a.position * scale, ..a }, b);
        }
        let centre = DVec3::splat(0.4);
        prop_assert_eq!(within(&plain, centre, 0.3), within(&scaled, centre * scale, 0.3 * scale));
        let (a, b) = (nearest(&plain, centre, 9, 1.0), nearest(&scaled, centre * scale, 9, scale));
        prop_assert_eq!(a.0.map(|s| s.radius * scale), b.0.map(|s| s.radius));
        prop_assert_eq!(a.1, b.1);
    }

    /// The k-th photon is never farther than the next one.
    #[test]
    fn the_radius_grows_with_k(count in 20u32..300, seed in any::<u64>()) {
        let tree = PhotonTree::new(photons(scattered(count, seed))).unwrap();
        let radii: Vec<f64> =
            (1..=20).map(|k| nearest(&tree, DVec3::splat(0.5), k, 10.0).0.unwrap().radius).collect();
        prop_assert!(radii.is_sorted(), "{:?}", radii);
    }
}
