//! Dense matrices: factorisations, inertia, assembly, and counters of solves.

pub(crate) mod dense_factors;
pub(crate) mod dense_lu;
pub mod inertia;
pub(crate) mod interruptible_lu;
pub(crate) mod matrix_sink;
pub(crate) mod solve_counters;
