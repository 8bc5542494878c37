//! Convex quadratic programs with second-order cones.
//!
//! | file | what it does |
//! |---|---|
//! | `driver` | the program of one step, by the cheapest method that succeeds; the elastic program if infeasible |
//! | `interior_point` | Clarabel's interior-point method; no other file uses this library |
//! | `active_set` | the linear system of a working set |
//! | `active_cones` | the contribution of the cones to this system |
//! | `one_dimensional` | the program reduced to the line that its equalities leave |
//! | `linear_solve` | the linear systems of `active_set` and `one_dimensional` |

pub(crate) mod active_cones;
pub(crate) mod active_set;
pub(crate) mod driver;
pub mod interior_point;
pub(crate) mod linear_solve;
pub(crate) mod one_dimensional;
pub(crate) mod tolerances;
