//! The points by which a path comes to a critical point, and the critical point, at one value of the parameter.
//!
//! | file | contents |
//! |---|---|
//! | `traced_history` | the history of a path, traced for it |
//! | `contact_history` | the points of the history, each with what is zero there |
//! | `branch_point_location` | one of them, by Newton's method along the branch of its mode |
//! | `solved_history` | all of them at one value of the parameter, and the conditions of the path |
//! | `taken_directions` | whether the path takes the directions of the history at its points |
//! | `tolerances` | |

mod branch_point_location;
pub(crate) mod contact_history;
pub(crate) mod solved_history;
pub(crate) mod taken_directions;
pub(crate) mod tolerances;
pub(crate) mod traced_history;
