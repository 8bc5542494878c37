//! Dense matrices: their factorisations and inertia, what is assembled into, counts of solves, and roots of functions.

pub(crate) mod counted;
pub(crate) mod factorisation;
pub(crate) mod factors;
pub mod inertia;
pub(crate) mod large;
pub(crate) mod root;
pub(crate) mod sink;
