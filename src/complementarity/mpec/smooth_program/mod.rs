//! The smooth program that stands for the one with complementarity constraints, and sequential quadratic programming on it.
//!
//! | file | what it does |
//! |---|---|
//! | `pattern` | how each pair is treated |
//! | `relaxation` | the rows of the relaxed program and their linearisation |
//! | `cone_rows` | the rows of cone pairs |
//! | `secant` | a positive definite stand-in for the Hessian |
//! | `sqp` | sequential quadratic programming |

pub(crate) mod cone_rows;
pub(crate) mod pattern;
pub(crate) mod relaxation;
pub(crate) mod secant;
pub(crate) mod sqp;
