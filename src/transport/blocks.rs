//! Histories in fixed blocks, merged in block order: the same bits on any number of threads.

use crate::error::{Error, Result};
use crate::faults::{Fault, planted};
use rayon::prelude::*;
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

/// Runs `histories` in blocks, in parallel, and merges the results pairwise in block order.
///
/// # Errors
/// `Error::Cancelled` if the progress says so.
pub fn run_blocks<T: Send>(
    histories: u64,
    progress: &dyn Progress,
    block: impl Fn(Range<u64>) -> T + Sync,
    merge: impl Fn(T, T) -> T,
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
    merge: impl Fn(T, T) -> T,
) -> Result<Option<T>> {
    let one = |index: u64| {
        if progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let range = index * size..((index + 1) * size).min(histories);
        let count = range.end - range.start;
        let result = block(range);
        progress.advance(count);
        Ok(result)
    };
    let mut results = in_parallel(histories.div_ceil(size) as usize, |index| one(index as u64))
        .into_iter()
        .collect::<Result<Vec<T>>>()?;
    while results.len() > 1 {
        let mut pairs = results.into_iter();
        let mut merged = Vec::with_capacity(pairs.len().div_ceil(2));
        while let Some(first) = pairs.next() {
            merged.push(match pairs.next() {
                Some(second) => merge(first, second),
                None => first,
            });
        }
        results = merged;
    }
    Ok(results.pop())
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
