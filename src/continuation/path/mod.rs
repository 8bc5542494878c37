//! The loop of an increment.
//!
//! | file | what it does |
//! |---|---|
//! | `iterator` | the path as an iterator of increments |
//! | `stages` | how a stage begins, ends and hands over to the next |
//! | `step_control` | how far a step goes |
//! | `step_attempt` | one try of a step |
//! | `acceptance` | a point reached becomes the present one and a row |
//! | `classification` | what kind of point it is, and how the path goes on from it |
//! | `mpec_verification` | whether the program of an increment names the same mode |
//! | `mpec_increments` | increments found by their program alone |
//! | `checkpoint`, `branch_switching` | a path put down and taken up again; along another direction |
//!
//! All of them work on one [`PathTrace`](crate::continuation::path_state::trace::PathTrace), which owns the state.

pub(crate) mod acceptance;
pub(crate) mod branch_switching;
pub mod checkpoint;
pub(crate) mod classification;
pub mod iterator;
pub(crate) mod mpec_increments;
pub(crate) mod mpec_verification;
pub(crate) mod stages;
pub(crate) mod step_attempt;
pub(crate) mod step_control;
