//! Smooth bifurcations: where an eigenvalue of the equations of a mode is zero.
//!
//! | room or file | what it does |
//! |---|---|
//! | `singularity` | signs that change at such a point, null vectors, and equations bordered to be regular there |
//! | `locate` | the point itself, by dense or by sparse matrices, and folded singularities of slip |
//! | `branch_directions` | the branches that leave it |
//! | `common_limit` | limit points that uncoupled parts have in common |
//! | `stage_end` | an end of the stage at or beside such a point |

pub(crate) mod branch_directions;
pub(crate) mod common_limit;
pub(crate) mod locate;
pub(crate) mod singularity;
pub(crate) mod stage_end;
