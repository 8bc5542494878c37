//! Dense matrices: factorisations, inertia, assembly, and counters of solves.

pub(crate) mod assembly;
pub(crate) mod factorisation;
pub mod inertia;
pub(crate) mod interruptible_lu;
pub(crate) mod lu_factors;
pub(crate) mod solve_counters;
