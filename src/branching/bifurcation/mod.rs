//! Smooth bifurcations: where an eigenvalue of the equations of a mode is zero.
//!
//! | module or file | contents |
//! |---|---|
//! | `singularity` | test functions that change sign there, null vectors, and bordered equations that are regular |
//! | `locate` | location of the point with dense or sparse matrices, and of folded singularities of slip |
//! | `branch_directions` | the branches that leave the point |
//! | `simultaneous_limit_points` | limit points shared by uncoupled parts |
//! | `stage_end_near_singular_point` | a bound of the stage at or near such a point |
//! | `step_end` | the end of a step, with what is known of it |

pub(crate) mod branch_directions;
pub(crate) mod locate;
pub(crate) mod simultaneous_limit_points;
pub(crate) mod singularity;
pub(crate) mod stage_end_near_singular_point;
pub(crate) mod step_end;
pub(crate) mod tolerances;
