//! The kd order of pieces: those that are neighbours in space become neighbours in memory.

/// Pieces below one node of the lowest level.
const BLOCK: usize = 16;

/// Ranges shorter than this are ordered by one thread; the order itself does not depend on it.
const SERIAL: usize = 1 << 14;

/// A piece on its way into the tree: its middle in the tree's units, and its number.
#[derive(Debug, Clone, Copy)]
pub(in crate::photons) struct Entry {
    pub(in crate::photons) middle: [f32; 3],
    pub(in crate::photons) index: u32,
}

/// Puts entries in kd order: every range of more than one block is split across the widest axis of its box at the largest
/// power-of-two number of blocks below its own; where middles tie, by their numbers.
pub(in crate::photons) fn kd_order(entries: &mut [Entry]) {
    let blocks = entries.len().div_ceil(BLOCK);
    if blocks <= 1 {
        return;
    }
    let axis = widest_axis(entries);
    let middle = blocks.next_power_of_two() / 2 * BLOCK;
    let key = |entry: &Entry| entry.middle[axis];
    entries.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.index.cmp(&b.index)));
    let is_long = entries.len() > SERIAL;
    let (nearer, farther) = entries.split_at_mut(middle);
    if is_long {
        rayon::join(|| kd_order(nearer), || kd_order(farther));
    } else {
        kd_order(nearer);
        kd_order(farther);
    }
}

fn widest_axis(entries: &[Entry]) -> usize {
    let (mut lower, mut upper) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for entry in entries {
        for axis in 0..3 {
            lower[axis] = lower[axis].min(entry.middle[axis]);
            upper[axis] = upper[axis].max(entry.middle[axis]);
        }
    }
    let extent = |axis: usize| upper[axis] - lower[axis];
    (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
}
