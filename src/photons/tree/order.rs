//! The kd order: photons that are neighbours in space become neighbours in memory.

use super::BLOCK;
use crate::photons::Photon;
use std::cmp::Ordering;

/// Ranges shorter than this are ordered by one thread; the order itself does not depend on it.
const SERIAL: usize = 1 << 14;

/// A photon on its way into the tree: its position in the tree's units, and where its record is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) position: [f32; 3],
    pub(super) index: u32,
}

/// Puts entries in kd order: every range of more than one block is split across the widest axis of its box, at
/// the largest power-of-two number of blocks below its own, nearer photons first.
///
/// Photons at the same coordinate are ordered by their other coordinates and then by their records, so that the
/// order is a function of the set of photons and not of how they came.
pub(super) fn kd_order(entries: &mut [Entry], photons: &[Photon], parallel: bool) {
    let blocks = entries.len().div_ceil(BLOCK);
    if blocks <= 1 {
        // Rows are halves of a block across its widest axis.
        match widest_axis(entries) {
            0 => entries.sort_unstable_by(|a, b| compare::<0>(a, b, photons)),
            1 => entries.sort_unstable_by(|a, b| compare::<1>(a, b, photons)),
            _ => entries.sort_unstable_by(|a, b| compare::<2>(a, b, photons)),
        }
        return;
    }
    let middle = blocks.next_power_of_two() / 2 * BLOCK;
    match widest_axis(entries) {
        0 => entries.select_nth_unstable_by(middle, |a, b| compare::<0>(a, b, photons)),
        1 => entries.select_nth_unstable_by(middle, |a, b| compare::<1>(a, b, photons)),
        _ => entries.select_nth_unstable_by(middle, |a, b| compare::<2>(a, b, photons)),
    };
    let (nearer, farther) = entries.split_at_mut(middle);
    if parallel && nearer.len() > SERIAL {
        rayon::join(|| kd_order(nearer, photons, true), || kd_order(farther, photons, true));
    } else {
        kd_order(nearer, photons, false);
        kd_order(farther, photons, false);
    }
}

fn widest_axis(entries: &[Entry]) -> usize {
    let (mut lower, mut upper) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for entry in entries {
        for axis in 0..3 {
            let c = entry.position[axis];
            lower[axis] = if c < lower[axis] { c } else { lower[axis] };
            upper[axis] = if c > upper[axis] { c } else { upper[axis] };
        }
    }
    let width = [upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]];
    if width[0] >= width[1] && width[0] >= width[2] {
        0
    } else if width[1] >= width[2] {
        1
    } else {
        2
    }
}

#[inline]
fn compare<const AXIS: usize>(a: &Entry, b: &Entry, photons: &[Photon]) -> Ordering {
    let (p, q) = (a.position[AXIS], b.position[AXIS]);
    if p < q {
        Ordering::Less
    } else if p > q {
        Ordering::Greater
    } else {
        compare_records(a, b, photons)
    }
}

#[cold]
fn compare_records(a: &Entry, b: &Entry, photons: &[Photon]) -> Ordering {
    let record = |entry: &Entry| {
        let Photon { position: p, dir, power, order, flags } = photons[entry.index as usize];
        let place = [p.x, p.y, p.z].map(key);
        let rest = [dir.x, dir.y, dir.z, power.x, power.y, power.z].map(|c| key(f64::from(c)));
        (entry.position.map(|c| key(f64::from(c))), place, rest, order, flags_key(flags))
    };
    record(a).cmp(&record(b))
}

/// An integer that orders as the number does.
fn key(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

fn flags_key(flags: crate::photons::Flags) -> u8 {
    use crate::photons::Flags;
    [Flags::SPECULAR, Flags::DIFFUSE, Flags::MEDIUM]
        .into_iter()
        .enumerate()
        .map(|(bit, flag)| u8::from(flags.has(flag)) << bit)
        .sum()
}
