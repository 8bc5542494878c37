//! The one-sided directions at a point, to first order.
//!
//! | file | contents |
//! |---|---|
//! | `candidate` | a direction of first order with the compatible contact modes |
//! | `feasible_direction` | a feasible direction, and the rules by which one is taken |
//! | `condensed_rate_problem` | the rate equations condensed on the velocities of the contacts that can change |
//! | `rate_basis` | the rates of the structure for each of these velocities, whole or at the contacts alone |
//! | `condensation_basis` | how they are found |
//! | `arrival_tangent` | the incoming tangent, and the directions that it determines |
//! | `trial_step` | a short step decides whether a direction of first order holds, and under which modes |

pub(crate) mod arrival_tangent;
pub(crate) mod candidate;
pub(crate) mod condensation_basis;
pub(crate) mod condensed_rate_problem;
pub(crate) mod feasible_direction;
pub(crate) mod rate_basis;
pub(crate) mod tolerances;
pub(crate) mod trial_step;
