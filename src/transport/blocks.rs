//! Histories in fixed blocks, merged in block order: the same bits on any number of threads.

use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;

/// Histories a block, whatever the total and the threads.
pub const BLOCK: u64 = 4096;

/// Who watches a long computation.
pub trait Progress: Sync {
    /// A stage begins that will take so many steps; a computation of one stage need not say it.
    fn stage(&self, _name: &'static str, _steps: u64) {}

    /// So many more steps, histories for the most part, are done.
    fn advance(&self, steps: u64);

    /// Whether to stop.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Nobody watches.
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&self, _steps: u64) {}
}

/// Runs `histories` in blocks, in parallel, and merges the results pairwise in block order, each as soon as its neighbour is
/// there: of any number of blocks few results wait at a time.
///
/// # Errors
/// `Error::Cancelled` if the progress says so.
pub fn run_blocks<T: Send>(
    histories: u64,
    progress: &dyn Progress,
    block: impl Fn(Range<u64>) -> T + Sync,
    merge: impl Fn(T, T) -> T + Sync,
) -> Result<Option<T>> {
    let size = if planted(Fault::BlocksByThreads) {
        histories.div_ceil(rayon::current_num_threads() as u64).max(1)
    } else {
        BLOCK
    };
    run_blocks_of(size, histories, progress, block, merge)
}

/// The same in blocks of another size, for results that do not depend on it.
///
/// # Errors
/// `Error::Cancelled` if the progress says so.
pub fn run_blocks_of<T: Send>(
    size: u64,
    histories: u64,
    progress: &dyn Progress,
    block: impl Fn(Range<u64>) -> T + Sync,
    merge: impl Fn(T, T) -> T + Sync,
) -> Result<Option<T>> {
    let blocks = histories.div_ceil(size);
    let (waiting, whole) = (Mutex::new(BTreeMap::new()), Mutex::new(Ok(None)));
    let end = |result: Result<Option<T>>| {
        if let Ok(mut whole) = whole.lock() {
            *whole = result;
        }
    };
    spread(blocks as usize, &|index| {
        if progress.is_cancelled() {
            return end(Err(Error::Cancelled));
        }
        let start = index as u64 * size;
        let range = start..start.saturating_add(size).min(histories);
        let count = range.end - range.start;
        let result = block(range);
        progress.advance(count);
        if let Some(result) = merged(&waiting, blocks, index as u64, result, &merge) {
            end(Ok(Some(result)));
        }
    });
    whole.into_inner().unwrap_or(Ok(None))
}

/// Results that wait for their neighbours, by level and number.
type Waiting<T> = Mutex<BTreeMap<(u32, u64), T>>;

/// Merges the result of a block with what waits for it, as far as that goes: numbers 2i and 2i+1 of a level become number i of the
/// next one, and a last one without neighbour moves on as it is, so that the order is that of the blocks, whoever was first.
///
/// # Returns
/// the result of all blocks, from whoever brings the last one
fn merged<T>(
    waiting: &Waiting<T>,
    blocks: u64,
    mut number: u64,
    mut result: T,
    merge: &impl Fn(T, T) -> T,
) -> Option<T> {
    let (mut level, mut count) = (0, blocks);
    while count > 1 {
        let neighbour = number ^ 1;
        if neighbour < count {
            // Merged when the lock is free again.
            let other = {
                let mut waiting = waiting.lock().ok()?;
                match waiting.remove(&(level, neighbour)) {
                    Some(other) => other,
                    None => {
                        waiting.insert((level, number), result);
                        return None;
                    }
                }
            };
            result = if number < neighbour { merge(result, other) } else { merge(other, result) };
        }
        (level, number, count) = (level + 1, number / 2, count.div_ceil(2));
    }
    Some(result)
}

/// Results of so many blocks that are in memory at a time, about: each thread makes one, and beside it wait those of the levels that
/// its part of the blocks has.
pub fn blocks_at_once(blocks: u64) -> f64 {
    let (blocks, threads) = (blocks as f64, rayon::current_num_threads() as f64);
    blocks.min(threads * (1.0 + libm::log2((blocks / threads).max(1.0))))
}

/// What each of `tasks` tasks gives, in their order, whoever was first. The threads are asked in one place, which is compiled
/// once, not for every kind of task.
pub fn in_parallel<T: Send>(tasks: usize, task: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let places: Vec<Mutex<Option<T>>> = (0..tasks).map(|_| Mutex::new(None)).collect();
    spread(tasks, &|index| {
        let result = task(index);
        if let Ok(mut place) = places[index].lock() {
            *place = Some(result);
        }
    });
    places.into_iter().filter_map(|place| place.into_inner().ok().flatten()).collect()
}

fn spread(tasks: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..tasks).into_par_iter().for_each(task);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicI64, Ordering};

    /// Blocks in brackets, merged level by level when all are there.
    fn bracketed(blocks: u64) -> Option<String> {
        let mut all: Vec<String> = (0..blocks).map(|number| number.to_string()).collect();
        while all.len() > 1 {
            all = all
                .chunks(2)
                .map(|pair| if let [a, b] = pair { format!("({a} {b})") } else { pair[0].clone() })
                .collect();
        }
        all.pop()
    }

    fn pool(threads: usize) -> rayon::ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
    }

    /// The last block is shorter; any order of arrival makes the same tree.
    #[test]
    fn blocks_are_merged_pairwise_in_order() {
        for threads in [1, 3, 8] {
            for blocks in (0..40u64).chain([64, 65, 255, 257, 1000]) {
                let block = |range: Range<u64>| {
                    if range.start.is_multiple_of(3) {
                        std::thread::yield_now();
                    }
                    (range.start / 7).to_string()
                };
                let merge = |a: String, b: String| format!("({a} {b})");
                let histories = (7 * blocks).saturating_sub(3);
                let run = || run_blocks_of(7, histories, &NoProgress, block, merge).unwrap();
                assert_eq!(pool(threads).install(run), bracketed(blocks), "{threads} {blocks}");
            }
        }
        // Backwards every result waits for the first one.
        for blocks in 1..40 {
            let waiting = Mutex::new(BTreeMap::new());
            let merge = |a: String, b: String| format!("({a} {b})");
            let mut found = None;
            for number in (0..blocks).rev() {
                assert_eq!(found, None);
                found = merged(&waiting, blocks, number, number.to_string(), &merge);
            }
            assert_eq!(found, bracketed(blocks));
        }
    }

    /// One that is counted while it is there.
    struct Counted<'a>(&'a AtomicI64);

    impl Drop for Counted<'_> {
        fn drop(&mut self) {
            self.0.fetch_sub(1, Ordering::SeqCst);
        }
    }

    /// Of 10^5 blocks few are there at a time: as many as is said, but for how threads take work from each other.
    #[test]
    fn few_results_wait() {
        let (there, most) = (AtomicI64::new(0), AtomicI64::new(0));
        let block = |_: Range<u64>| {
            let now = there.fetch_add(1, Ordering::SeqCst) + 1;
            most.fetch_max(now, Ordering::SeqCst);
            Counted(&there)
        };
        let run =
            || (run_blocks_of(1, 100_000, &NoProgress, block, |a, _| a).unwrap(), blocks_at_once(100_000));
        let (last, said) = pool(4).install(run);
        assert!(last.is_some() && there.load(Ordering::SeqCst) == 1);
        let most = most.load(Ordering::SeqCst) as f64;
        assert!((0.1 * said..10.0 * said).contains(&most) && said < 100.0, "{most} {said}");
    }

    /// Whoever stops, nothing comes of it.
    #[test]
    fn a_stopped_run_gives_nothing() {
        struct Stopped(AtomicI64);
        impl Progress for Stopped {
            fn advance(&self, _: u64) {
                self.0.fetch_sub(1, Ordering::SeqCst);
            }
            fn is_cancelled(&self) -> bool {
                self.0.load(Ordering::SeqCst) <= 0
            }
        }
        for left in [0, 1, 50] {
            let stopped = Stopped(AtomicI64::new(left));
            let run = || run_blocks_of(1, 100, &stopped, |range| range.start, |a, b| a + b);
            assert_eq!(pool(4).install(run), Err(Error::Cancelled), "{left}");
        }
    }
}
