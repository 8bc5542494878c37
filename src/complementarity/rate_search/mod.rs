//! The search for all rays of a rate problem.
//!
//! | file | what it does |
//! |---|---|
//! | `branch_and_bound` | all rays, by branch and bound over the entities |
//! | `single_combination` | one combination of options |
//! | `unbranched` | the rays where a certificate makes branching needless |
//! | `slip_onset_direction` | slip that begins at a touch in space, whose direction is unknown |
//! | `simultaneous_slips` | such slips that begin at several nodes at once |

pub(crate) mod branch_and_bound;
pub(crate) mod simultaneous_slips;
pub(crate) mod single_combination;
pub(crate) mod slip_onset_direction;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod unbranched;
