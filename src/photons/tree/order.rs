//! The kd order: photons that are neighbours in space become neighbours in memory.

use super::block::BLOCK;
use super::columns::{Columns, Entry};
use crate::transport::Progress;
use std::cmp::Ordering;
use wide::f32x4;

/// Ranges shorter than this are ordered by one thread; the order itself does not depend on it.
const SERIAL: usize = 1 << 14;

/// Ranges of at most so many entries are ordered with memory to move them to, one and a half times their own. Longer ranges are split in
/// place, a little slower, unless that memory for all threads together is an eighth of what the whole would need. The order does not
/// depend on this either.
const MOVED: usize = 1 << 20;

/// Puts entries in kd order: every range of more than one block is split across the widest axis of its box,
/// at the largest power-of-two number of blocks below its own, nearer photons first.
///
/// Photons at the same coordinate are ordered by what the tree holds of them, so that the order is a function of the set of
/// photons and not of how they came.
///
/// `progress` is told of every entry that has its place.
pub(super) fn kd_order(entries: &mut [Entry], photons: &Columns, parallel: bool, progress: &dyn Progress) {
    let threads = if parallel { rayon::current_num_threads() } else { 1 };
    let most = (entries.len() / (8 * threads)).max(MOVED);
    Order { photons, parallel, progress }.sort_in_place(entries, most);
    if entries.len() <= SERIAL {
        progress.advance(entries.len() as u64);
    }
}

/// What the whole recursion shares.
#[derive(Clone, Copy)]
struct Order<'a> {
    photons: &'a Columns,
    parallel: bool,
    progress: &'a dyn Progress,
}

impl Order<'_> {
    /// Orders `entries`, ranges of at most `most` of them with memory to move them to.
    fn sort_in_place(self, entries: &mut [Entry], most: usize) {
        let count = entries.len();
        if count <= most {
            let mut spare = vec![Entry::NONE; count];
            let mut band = vec![Entry::NONE; count / 2];
            return self.sort(entries, &mut spare, &mut band, true);
        }
        let middle = middle(count);
        match widest_axis(entries) {
            0 => self.select::<0>(entries, middle),
            1 => self.select::<1>(entries, middle),
            _ => self.select::<2>(entries, middle),
        }
        let (nearer, farther) = entries.split_at_mut(middle);
        if self.parallel {
            rayon::join(|| self.sort_in_place(nearer, most), || self.sort_in_place(farther, most));
        } else {
            self.sort_in_place(nearer, most);
            self.sort_in_place(farther, most);
        }
        self.count_placed(count);
    }

    /// Orders `entries`, with `spare` and `band`, half as long, to work in; the result is left in `entries`
    /// if `in_place`, else in `spare`.
    fn sort(self, entries: &mut [Entry], spare: &mut [Entry], band: &mut [Entry], in_place: bool) {
        let count = entries.len();
        let axis = widest_axis(entries);
        if count <= BLOCK {
            return self.sort_block(axis, entries, spare, in_place);
        }
        let middle = middle(count);
        let moved = match axis {
            0 => self.split::<0>(entries, spare, band, middle),
            1 => self.split::<1>(entries, spare, band, middle),
            _ => self.split::<2>(entries, spare, band, middle),
        };
        let ((from, to), in_place) =
            if moved { ((spare, entries), !in_place) } else { ((entries, spare), in_place) };
        let (nearer, farther) = from.split_at_mut(middle);
        let (nearer_spare, farther_spare) = to.split_at_mut(middle);
        let (nearer_band, farther_band) = band.split_at_mut(middle / 2);
        if self.parallel && nearer.len() > SERIAL {
            rayon::join(
                || self.sort(nearer, nearer_spare, nearer_band, in_place),
                || self.sort(farther, farther_spare, farther_band, in_place),
            );
        } else {
            let this = Order { parallel: false, ..self };
            this.sort(nearer, nearer_spare, nearer_band, in_place);
            this.sort(farther, farther_spare, farther_band, in_place);
        }
        self.count_placed(count);
    }

    /// Tells of a range whose two parts are in order: of those that are too short to tell of themselves.
    fn count_placed(self, count: usize) {
        if count > SERIAL {
            let parts = [middle(count), count - middle(count)];
            let placed: usize = parts.into_iter().filter(|n| *n <= SERIAL).sum();
            if placed > 0 {
                self.progress.advance(placed as u64);
            }
        }
    }

    /// Sorts a block across its widest axis: its two rows are halves of it.
    fn sort_block(self, axis: usize, entries: &mut [Entry], spare: &mut [Entry], in_place: bool) {
        // By rank, which is the number of smaller coordinates: no branch to mispredict.
        let mut coordinates = [f32::INFINITY; BLOCK];
        for (c, entry) in coordinates.iter_mut().zip(entries.iter()) {
            *c = entry.position[axis];
        }
        let ranks = coordinates.map(|c| coordinates.iter().map(|&other| u32::from(other < c)).sum::<u32>());
        let seen = ranks[..entries.len()].iter().fold(0u32, |seen, rank| seen | 1 << rank);
        if seen.count_ones() as usize == entries.len() {
            for (entry, rank) in entries.iter().zip(ranks) {
                spare[rank as usize] = *entry;
            }
            if in_place {
                entries.copy_from_slice(spare);
            }
        } else {
            entries.sort_unstable_by(|a, b| self.compare(axis, a, b));
            if !in_place {
                spare.copy_from_slice(entries);
            }
        }
    }

    /// Brings the `middle` nearest entries along an axis before the others; whether the result is in `spare`.
    ///
    /// One pass moves what lies clearly below or above the middle, by two pivots from a sample (Floyd and
    /// Rivest 1975), and only the band between them is searched. Which entries come first does not depend on
    /// the sample.
    fn split<const AXIS: usize>(
        self,
        entries: &mut [Entry],
        spare: &mut [Entry],
        band: &mut [Entry],
        middle: usize,
    ) -> bool {
        let Some([low, high]) = pivots::<AXIS>(entries, middle) else {
            self.select::<AXIS>(entries, middle);
            return false;
        };
        let (mut below, mut above, mut between) = (0, entries.len(), 0);
        for entry in entries.iter() {
            // Written to all three places, kept in one: no branch to mispredict. What is still to come always
            // has room between `below` and `above`.
            let c = entry.position[AXIS];
            let (is_below, is_above) = (c < low, c > high);
            spare[below] = *entry;
            spare[above - 1] = *entry;
            band[between] = *entry;
            below += usize::from(is_below);
            above -= usize::from(is_above);
            between += usize::from(!is_below & !is_above);
            if between == band.len() {
                break;
            }
        }
        if between == band.len() || below > middle || middle >= above {
            self.select::<AXIS>(entries, middle);
            return false;
        }
        spare[below..above].copy_from_slice(&band[..between]);
        self.select::<AXIS>(&mut spare[below..above], middle - below);
        true
    }

    /// Brings the `middle` nearest entries along an axis before the others.
    fn select<const AXIS: usize>(self, entries: &mut [Entry], middle: usize) {
        let along = |entry: &Entry| entry.position[AXIS];
        let by_coordinate = |a: &Entry, b: &Entry| along(a).partial_cmp(&along(b)).unwrap_or(Ordering::Equal);
        let (nearer, &mut pivot, _) = entries.select_nth_unstable_by(middle, by_coordinate);
        // Only where coordinates tie across the middle do the records decide.
        if nearer.iter().fold(false, |tie, entry| tie | (along(entry) == along(&pivot))) {
            entries.select_nth_unstable_by(middle, |a, b| self.compare(AXIS, a, b));
        }
    }

    #[inline]
    fn compare(self, axis: usize, a: &Entry, b: &Entry) -> Ordering {
        let (p, q) = (a.position[axis], b.position[axis]);
        if p < q {
            Ordering::Less
        } else if p > q {
            Ordering::Greater
        } else {
            compare_records(a, b, self.photons)
        }
    }
}

/// Entries of the nearer part of a range of more than one block.
fn middle(count: usize) -> usize {
    count.div_ceil(BLOCK).next_power_of_two() / 2 * BLOCK
}

/// Two values that the entry of rank `middle` lies between, three standard deviations of the sample's rank
/// apart from it; none for a short range.
fn pivots<const AXIS: usize>(entries: &[Entry], middle: usize) -> Option<[f32; 2]> {
    const SAMPLE: usize = 256;
    if entries.len() < 4 * SAMPLE {
        return None;
    }
    let stride = entries.len() / SAMPLE;
    let mut sample: [f32; SAMPLE] = std::array::from_fn(|i| entries[i * stride].position[AXIS]);
    sample.sort_unstable_by(f32::total_cmp);
    let rank = SAMPLE * middle / entries.len();
    let margin = 3 * 8;
    Some([sample[rank.saturating_sub(margin)], sample[(rank + margin).min(SAMPLE - 1)]])
}

fn widest_axis(entries: &[Entry]) -> usize {
    let as_lanes =
        |e: &Entry| f32x4::new([e.position[0], e.position[1], e.position[2], f32::from_bits(e.index)]);
    let first = as_lanes(&entries[0]);
    let (mut lower, mut upper) = (first, first);
    for entry in entries {
        let lanes = as_lanes(entry);
        lower = lower.fast_min(lanes);
        upper = upper.fast_max(lanes);
    }
    let [x, y, z, _] = (upper - lower).to_array();
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

#[cold]
fn compare_records(a: &Entry, b: &Entry, photons: &Columns) -> Ordering {
    let record = |entry: &Entry| {
        let index = entry.index as usize;
        let vectors = [photons.dirs[index], photons.normal(index), photons.powers[index]];
        let (order, flags) = photons.histories[index];
        (entry.position.map(key), vectors.map(|v| v.to_array().map(key)), order, flags_key(flags))
    };
    record(a).cmp(&record(b))
}

/// An integer that orders as the number does.
fn key(x: f32) -> i32 {
    let bits = x.to_bits() as i32;
    bits ^ (((bits >> 31) as u32) >> 1) as i32
}

fn flags_key(flags: crate::photons::Flags) -> u8 {
    use crate::photons::Flags;
    [Flags::SPECULAR, Flags::DIFFUSE, Flags::MEDIUM]
        .into_iter()
        .enumerate()
        .map(|(bit, flag)| u8::from(flags.has(flag)) << bit)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photons::Photons;
    use crate::photons::tree::units::Units;
    use crate::photons::{Flags, Photon};
    use crate::rng::{Purpose, Stream};
    use glam::{DVec3, Vec3};
    use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

    struct Counted(AtomicU64);

    impl Progress for Counted {
        fn advance(&self, steps: u64) {
            self.0.fetch_add(steps, Relaxed);
        }
    }

    /// However much is split in place, in one thread or many, and where half of all coordinates tie.
    #[test]
    fn the_order_does_not_depend_on_the_memory() {
        for steps in [f64::INFINITY, 8.0] {
            let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
            let place = |x: f64| if steps.is_finite() && x < 0.5 { (x * steps).floor() / steps } else { x };
            let photon = |number: u16| Photon {
                position: DVec3::from(stream.triple().map(place)),
                dir: Vec3::Z,
                normal: Vec3::ZERO,
                power: Vec3::splat(f32::from(number)),
                order: number,
                flags: Flags::MEDIUM,
            };
            let photons: Photons = (0..50_000).map(photon).collect();
            let count = photons.len();
            let units = Units::of(std::slice::from_ref(&photons), false).unwrap();
            let (entries, columns) = Columns::of(vec![photons], &units);
            let sorted = |most: usize, parallel: bool| {
                let (mut entries, progress) = (entries.clone(), Counted(AtomicU64::new(0)));
                Order { photons: &columns, parallel, progress: &progress }.sort_in_place(&mut entries, most);
                assert_eq!(progress.0.into_inner(), count as u64, "{most} {parallel}");
                entries.into_iter().map(|entry| entry.index).collect::<Vec<_>>()
            };
            let moved = sorted(count, false);
            assert!(!moved.is_sorted());
            for most in [BLOCK, 1000, SERIAL, 40_000] {
                assert!([false, true].into_iter().all(|parallel| sorted(most, parallel) == moved), "{most}");
            }
        }
    }
}
