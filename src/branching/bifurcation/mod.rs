//! Smooth bifurcations: where an eigenvalue of the equations of a mode is zero.
//!
//! | room or file | what it does |
//! |---|---|
//! | `singularity` | signs that change at such a point, null vectors, and equations bordered to be regular there |
//! | `locate` | the point itself, by dense or by sparse matrices, and folded singularities of slip |
//! | `branch_directions` | the branches that leave it |
//! | `simultaneous_limit_points` | limit points that uncoupled parts have in common |
//! | `bound_at_singularity` | an end of the stage at or beside such a point |

pub(crate) mod bound_at_singularity;
pub(crate) mod branch_directions;
pub(crate) mod locate;
pub(crate) mod simultaneous_limit_points;
pub(crate) mod singularity;
