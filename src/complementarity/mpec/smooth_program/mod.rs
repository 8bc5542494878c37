//! The smooth program in place of the program with complementarity constraints, and its solution by sequential
//! quadratic programming.
//!
//! | file | what it does |
//! |---|---|
//! | `pair_treatment` | the treatment of each pair |
//! | `smooth_rows` | the rows of the relaxed program and their linearisation |
//! | `cone_rows` | the rows of cone pairs |
//! | `damped_bfgs` | a positive definite approximation of the Hessian |
//! | `sqp` | sequential quadratic programming |

pub(crate) mod cone_rows;
pub(crate) mod damped_bfgs;
pub(crate) mod pair_treatment;
pub(crate) mod smooth_rows;
pub(crate) mod sqp;
pub(crate) mod tolerances;
