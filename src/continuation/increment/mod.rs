//! One increment along a contact mode, from one point of the path to the next.
//!
//! | file | contents |
//! |---|---|
//! | `stages` | the beginning and the end of a stage, and the transition to the next |
//! | `limit_point_start` | the motion that is free where a stage begins at a limit point |
//! | `step_control` | the length of a step |
//! | `step_attempt` | one attempt of a step |
//! | `acceptance` | acceptance of a point as the present one, and its row |
//! | `point_classification` | classification of a point, and the continuation of the path from it |
//! | `mpec_verification` | whether the program of an increment confirms the mode |
//! | `mpec_increments` | increments found by their program alone |
//!
//! All of them work on one `PathTrace` (`continuation::path_state::path_context`), which owns the state.

pub(crate) mod acceptance;
pub(crate) mod limit_point_start;
pub(crate) mod mpec_increments;
pub(crate) mod mpec_verification;
pub(crate) mod point_classification;
pub(crate) mod stages;
pub(crate) mod step_attempt;
pub(crate) mod step_control;
pub(crate) mod tolerances;
