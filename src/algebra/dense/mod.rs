//! Dense matrices: their factorisations and inertia, what is assembled into, counts of solves, and roots of functions.

pub(crate) mod assembly;
pub(crate) mod factorisation;
pub mod inertia;
pub(crate) mod interruptible_lu;
pub(crate) mod lu_factors;
pub(crate) mod solve_counters;
