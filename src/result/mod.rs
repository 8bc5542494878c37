//! What a path gives: plain data, in the user's units and names.
//!
//! | file | what it holds |
//! |---|---|
//! | `plan` | what a scene needs and what is left out |
//! | `increment` | one accepted point |
//! | `displacements` | displacements by node, the names shared by all rows |
//! | `program_iterate` | a point on the way to the end of an increment by its program |
//! | `stop_reason`, `report` | why a path ended, and its totals |

pub mod displacements;
pub mod increment;
pub mod plan;
pub mod program_iterate;
pub mod report;
pub mod stop_reason;
