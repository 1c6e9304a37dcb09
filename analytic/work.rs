//! Work, counted in tests: terms of the sums that take longest, so that bounds on it do not depend on a machine.
//!
//! Products of matrices are not counted: they are blocked, and take a small part of the time of the others.

/// Terms that are about to be summed; counted in tests only.
#[cfg(not(test))]
pub(crate) fn add(_terms: usize) {}

#[cfg(test)]
pub(crate) use counted::{add, of};

#[cfg(test)]
mod counted {
    use std::cell::Cell;

    thread_local! {
        static TERMS: Cell<usize> = const { Cell::new(0) };
    }

    pub(crate) fn add(terms: usize) {
        TERMS.set(TERMS.get() + terms);
    }

    /// What some work gives, and the terms that it took on this thread.
    pub(crate) fn of<T>(work: impl FnOnce() -> T) -> (T, usize) {
        let before = TERMS.get();
        (work(), TERMS.get() - before)
    }
}
