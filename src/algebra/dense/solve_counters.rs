//! How many right-hand sides this thread has solved for, and how many systems it has factorised: what a test asks that is to
//! fail where the work grows, and what diagnostics say of a search. No point of a path depends on it.

use std::cell::Cell;

thread_local! {
    static SOLVES: Cell<u64> = const { Cell::new(0) };
    static FACTORISATIONS: Cell<u64> = const { Cell::new(0) };
}

/// Sparse systems factorised on this thread since it began, counts of eigenvalues included, whoever asked for them.
pub fn factorisations() -> u64 {
    FACTORISATIONS.get()
}

pub(crate) fn count_factorisation() {
    FACTORISATIONS.set(FACTORISATIONS.get() + 1);
}

/// Right-hand sides solved for on this thread since it began, refinements included, by dense and sparse factorisations.
pub fn solves() -> u64 {
    SOLVES.get()
}

pub(crate) fn count_solves(right_hand_sides: usize) {
    SOLVES.set(SOLVES.get() + right_hand_sides as u64);
}
