//! The smooth program that stands for the one with complementarity constraints, and sequential quadratic programming on it.
//!
//! | file | what it does |
//! |---|---|
//! | `pair_treatment` | how each pair is treated |
//! | `relaxation` | the rows of the relaxed program and their linearisation |
//! | `cone_rows` | the rows of cone pairs |
//! | `damped_bfgs` | a positive definite stand-in for the Hessian |
//! | `sqp` | sequential quadratic programming |

pub(crate) mod cone_rows;
pub(crate) mod damped_bfgs;
pub(crate) mod pair_treatment;
pub(crate) mod relaxation;
pub(crate) mod sqp;
