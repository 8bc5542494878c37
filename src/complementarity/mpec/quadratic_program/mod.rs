//! Convex quadratic programs with second-order cones.
//!
//! | file | what it does |
//! |---|---|
//! | `driver` | the program of one step, by the cheapest way that works; the elastic program where it is infeasible |
//! | `interior_point` | Clarabel's interior-point method; no other file knows that solver |
//! | `active_set` | the linear system of a working set |
//! | `active_cones` | the part of it that the cones have |
//! | `one_dimensional` | the program condensed on the line that its equalities leave |
//! | `linear_solve` | linear systems of both |

pub(crate) mod active_cones;
pub(crate) mod active_set;
pub(crate) mod driver;
pub mod interior_point;
pub(crate) mod linear_solve;
pub(crate) mod one_dimensional;
