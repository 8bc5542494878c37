//! The search for all rays of a rate problem.
//!
//! | file | what it does |
//! |---|---|
//! | `branch_and_bound` | all rays, by branch and bound over the entities |
//! | `single_combination` | the examination of one combination of options |
//! | `certified_rays` | the rays where a certificate makes branching unnecessary |
//! | `slip_onset_direction` | onset of slip at a touching contact in space, in an unknown direction |
//! | `simultaneous_slips` | onset of such slips at several nodes simultaneously |
//! | `friction_newton` | likely ones of these where the nodes are strongly coupled |

pub(crate) mod branch_and_bound;
pub(crate) mod certified_rays;
mod friction_newton;
pub(crate) mod simultaneous_slips;
pub(crate) mod single_combination;
pub(crate) mod slip_onset_direction;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod tolerances;
