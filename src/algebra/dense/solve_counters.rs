//! Counters of the right-hand sides solved for and of the systems factorised by this thread, for tests of the amount of
//! work and for diagnostics of a search. No point of a path depends on them.

use std::cell::Cell;

thread_local! {
    static SOLVES: Cell<u64> = const { Cell::new(0) };
    static FACTORISATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The number of sparse systems factorised on this thread since it started, inertia counts included.
pub fn factorisations() -> u64 {
    FACTORISATIONS.get()
}

pub(crate) fn count_factorisation() {
    FACTORISATIONS.set(FACTORISATIONS.get() + 1);
}

/// The number of right-hand sides solved for on this thread since it started, by dense and sparse factorisations,
/// refinements included.
pub fn solves() -> u64 {
    SOLVES.get()
}

pub(crate) fn count_solves(right_hand_sides: usize) {
    SOLVES.set(SOLVES.get() + right_hand_sides as u64);
}
