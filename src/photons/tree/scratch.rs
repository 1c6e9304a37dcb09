//! Working memory of one thread's searches, kept from one to the next.

use super::block::ROW;
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};
use wide::f32x8;

/// Lists that a search fills; their contents mean nothing between searches, but for `last`.
#[derive(Default)]
pub(super) struct Scratch {
    /// Nodes or blocks whose boxes touch the ball.
    pub(super) touched: Vec<u32>,
    /// The level above, while `touched` is being filled.
    pub(super) parents: Vec<u32>,
    /// Rows that have photons in the ball, the first `end` of them.
    pub(super) rows: Vec<u32>,
    /// Squared distances of the photons of those rows.
    pub(super) squared: Vec<f32x8>,
    /// How many rows there are.
    pub(super) end: usize,
    /// Squared distances below the bound, as bits, which are ordered as the numbers are.
    pub(super) near: Vec<u32>,
    /// The last search for k nearest photons in each of some trees, which a caller may ask by turns.
    last: [Option<Last>; 4],
}

impl Scratch {
    /// The last search in a tree, if it is remembered.
    pub(super) fn last_in(&self, identity: u64) -> Option<Last> {
        self.last[(identity % 4) as usize].filter(|last| last.identity == identity)
    }

    /// Keeps every squared distance of the rows that is at most `bound`.
    #[inline(always)]
    pub(super) fn keep_near(&mut self, bound: f32) {
        // Every distance is written and only those below the bound are kept: no branch to mispredict.
        self.near.clear();
        self.near.resize(self.end * ROW + 1, 0);
        let mut end = 0;
        for squared in &self.squared[..self.end] {
            for &d in squared.as_array() {
                self.near[end] = d.to_bits();
                end += usize::from(d <= bound);
            }
        }
        self.near.truncate(end);
    }

    /// Remembers a search.
    pub(super) fn remember(&mut self, last: Last) {
        self.last[(last.identity % 4) as usize] = Some(last);
    }
}

/// A finished search: whose, for how many, where, and how far the k-th was.
#[derive(Clone, Copy)]
pub(super) struct Last {
    pub(super) identity: u64,
    pub(super) k: usize,
    pub(super) point: [f32; 3],
    pub(super) squared: f32,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

/// Lends the thread's memory to `work`; a search inside `work` gets memory of its own.
#[inline(always)]
pub(super) fn with_scratch<T>(work: impl FnOnce(&mut Scratch) -> T) -> T {
    let mut scratch = SCRATCH.take().unwrap_or_default();
    let result = work(&mut scratch);
    SCRATCH.set(Some(scratch));
    result
}

/// A number that no other tree of this process has; results do not depend on it.
pub(super) fn new_identity() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
