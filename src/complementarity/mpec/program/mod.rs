//! The statement of a mathematical program with complementarity constraints: functions, pairs, cones, and their values
//! at a point.
//!
//! | file | what it does |
//! |---|---|
//! | `problem` | the interface of a program |
//! | `evaluation` | functions and derivatives at a point, and the violation of its constraints |
//! | `cone` | the second-order cone and complementarity on it |
//! | `activity` | which member of each pair is zero |
//! | `sparse_rows` | a matrix stored by the entries of its rows |
//! | `solve_statistics` | counts of work, and the iterates of a solve |

pub(crate) mod activity;
pub mod cone;
pub(crate) mod evaluation;
pub mod problem;
pub(crate) mod solve_statistics;
pub(crate) mod sparse_rows;
