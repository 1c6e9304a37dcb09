//! Checked rows of the photon tree: any number of neighbours, and photons in one place or in line.

use super::cases::{Checked, Class};
use super::plain::Plain;
use crate::harness::Settings;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimate, Estimator, Gather, Kernel, count_within};
use turbid::photons::synthetic::{Number, Profile, Synthetic};
use turbid::photons::{Flags, Photon, PhotonMap, Photons};

/// Relative rounding of a sum: at most 32 photons a lane are added in single precision before the sum goes on in
/// double precision, and the weight has a few roundings of its own.
const SUM: f64 = 40.0 / (1u64 << 24) as f64;

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius * radius * radius
}

fn estimate(map: &PhotonMap, point: DVec3, gather: Gather) -> Estimate {
    Estimator::new(Kernel::Uniform, gather).collision_density(map, point, &Boundary::UNKNOWN)
}

/// From 2 neighbours to all photons, against a plain search in double precision.
///
/// A stored coordinate and one of the query point differ by at most the tree's resolution, so every distance by
/// 2 sqrt(3) of it and 4 x 2^-24 of itself; the k-th of the distances by no more than the worst of them; and the
/// density by three times that.
pub fn number_of_neighbors(settings: &Settings, rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let synthetic = Synthetic::new(Profile::Constant, DVec3::ZERO, DVec3::ONE)?;
    let number = Number::Exact(settings.photons(20_000, 1_000_000).max(100));
    let map = synthetic.map(number, settings.seed, 0)?;
    let photons: Vec<Photon> = map.tree().photons().collect();
    let (plain, stored) = (Plain::new(&photons, map.emitted()), photons.len());
    let point = DVec3::new(0.4, 0.55, 0.3);
    let cap = 2.0;
    for k in [2, 3, 10, 100, stored / 10, stored - 1, stored] {
        let estimate = estimate(&map, point, Gather::nearest(k, cap)?);
        let (exact, radius) = plain.nearest(point, k, cap);
        let distance = 2.0 * 3f64.sqrt() * map.tree().resolution() / radius + 4.0 / f64::from(1u32 << 24);
        let name = format!("k={k} of {stored}");
        rows.push(Checked::new(
            Class::Nearest,
            name,
            estimate.value[0],
            exact,
            exact * (3.0 * distance + SUM),
        ));
    }
    // One more than there are: all of them, in the ball of the cap.
    let estimate = estimate(&map, point, Gather::nearest(stored + 1, cap)?);
    let (exact, _) = plain.within(point, cap);
    let name = format!("k={} of {stored}: all in the cap", stored + 1);
    rows.push(Checked::new(Class::Nearest, name, estimate.value[0], exact, exact * SUM));
    Ok(())
}

fn photon(position: DVec3) -> Photon {
    Photon { position, dir: Vec3::Z, normal: Vec3::ZERO, power: Vec3::ONE, order: 1, flags: Flags::MEDIUM }
}

/// A thousand photons in one place, seen from it, from beside it, and from the rim; photons in line.
pub fn coincident(rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    const COUNT: usize = 1000;
    let class = Class::Coincident;
    let n = COUNT as f64;
    for (place, at) in
        [("the origin", DVec3::ZERO), ("1e9", DVec3::splat(1e9)), ("1e-300", DVec3::splat(1e-300))]
    {
        let map = PhotonMap::new(vec![photon(at); COUNT], 10)?;
        let mut add = |what: &str, point: DVec3, gather: Gather, exact: f64| {
            let value = estimate(&map, point, gather).value[0];
            let name = format!("1000 photons at {place}: {what}");
            rows.push(Checked::new(class, name, value, exact, exact * (SUM + 12.0 / f64::from(1u32 << 24))));
        };
        let beside = at + DVec3::new(0.5, 0.0, 0.0);
        add("from half a radius", beside, Gather::radius(1.0)?, n / (10.0 * ball(1.0)));
        add("from the rim", beside, Gather::radius(0.5)?, n / (10.0 * ball(0.5)));
        add("from beyond the rim", beside, Gather::radius(0.25)?, 0.0);
        add("the nearest 10", beside, Gather::nearest(10, 1.0)?, 9.0 / (10.0 * ball(0.5)));
        add("from within", at, Gather::radius(1.0)?, n / (10.0 * ball(1.0)));
        add("the nearest 10 from within", at, Gather::nearest(10, 1.0)?, n / (10.0 * ball(1.0)));
    }
    // Seen from the place itself with one photon farther out: the ball reaches to that one.
    let mut photons = vec![photon(DVec3::ZERO); COUNT];
    photons.push(photon(DVec3::X));
    let map = PhotonMap::new(photons, 10)?;
    let estimate = estimate(&map, DVec3::ZERO, Gather::nearest(10, 4.0)?);
    let exact = n / (10.0 * ball(1.0));
    let name = "1000 photons and one beyond: the nearest 10 from within";
    rows.push(Checked::new(class, name, estimate.value[0], exact, exact * SUM));
    // On the lattice of powers of two nothing is rounded: a photon on the rim is inside.
    let line: Photons = (0..=64).map(|i| photon(DVec3::X * (f64::from(i) / 64.0))).collect();
    let map = PhotonMap::new(line, 10)?;
    for (radius, exact) in [(0.25, 33.0), (0.5, 65.0), (1.0 / 128.0, 1.0)] {
        let found = count_within(&map, DVec3::X * 0.5, radius) as f64;
        rows.push(Checked::new(class, format!("65 photons in line, within {radius}"), found, exact, 0.0));
    }
    Ok(())
}
