//! The rate problem: all rays of a piecewise linear system, complete and without trying every combination.
//!
//! The unknowns are weights `w ∈ R^p` (velocities of the contacts that can change, and the coordinate along the held
//! structure's own direction). Motions and reaction rates are linear in them. Each *entity* (a contact, or a node that
//! faces several obstacles) takes exactly one of its *options*: linear forms that are zero and others that are not
//! negative. A one-sided direction of the path is a ray `w` under one option of every entity:
//!
//! ```text
//! F_z w = 0  (z zero in the option),     σ F_i w >= 0  (i not negative in it),     ‖(u̇, ṡ)‖ = 1
//! ```
//!
//! For contacts on the cone this is a linear complementarity problem in the velocities with the load rate as parameter
//! (A. Klarbring, Ing. Arch. 60 (1990) 529, doi:10.1007/BF00541909; R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear
//! Complementarity Problem*, SIAM 2009, doi:10.1137/1.9780898719000).
//!
//! | file | what it does |
//! |---|---|
//! | `problem` | forms, entities, options |
//! | `line` | the exact ray of one combination of options, and whether its inequalities hold |
//! | `dictionary` | the cone that is left when some entities are decided: is there anything but zero in it? |
//! | `certificate` | a cheap sufficient test that each sign of the load rate has exactly one ray, and those rays |
//! | `parametric` | the same where one pair stands in the way: all rays, found along a function of one variable |
//! | `near` | combinations that a known vector of weights points to |
//! | `sweeps` | a likely combination for each sign of the load rate |
//! | `lemke` | solutions by complementary pivoting, where the search was cut |
//! | `branch`, `examine`, `certified` | branch and bound over the entities; one combination; where no branching is needed |
//!
//! Knows linear forms only: nothing of structures, contacts or states.

mod branch;
mod certificate;
mod certified;
mod dictionary;
mod examine;
mod lemke;
mod line;
mod near;
mod parametric;
mod problem;
mod sweeps;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(super) use tests::{Random, every_combination};

pub use branch::{Effort, Ray, explore};
pub use certificate::is_definite;
pub use line::IN_DOUBT;
pub use near::near;
pub use parametric::slip_or_stick;
pub use problem::{Choice, Entity, RateProblem, Signed, Touching};
pub use sweeps::{Local, own_column, rising, sweeps};
