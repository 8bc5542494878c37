//! Path following: from a checked scene to a sequence of increments.
//!
//! [`path::iterator::Path`] is an iterator; its caller (command line, worker, test) decides what to do with each
//! increment.
//!
//! | module or file | contents |
//! |---|---|
//! | [`scene`] | a request made dimensionless, and the plan: features the scene does not need |
//! | `path_state` | the state of a path: present point, contacts in reach, totals, history; rows for the user |
//! | [`contact_changes`] | contact changes that are predicted, treated together, or reached in one straight step |
//! | `increment` | one increment along a contact mode: stages, step control, trial, acceptance, classification |
//! | `jump` | the motion from a state where the path cannot go on to the next state at rest |
//! | `critical_curve` | limit points, bifurcation points and contact changes followed in a parameter |
//! | [`path`] | the increments of a path one after the other, checkpoints, other branches |
//! | [`penalty`] | the conventional method with penalties, for comparison |
//! | [`method_dispatch`] | path tracing by the method that the analysis names |

pub mod contact_changes;
pub(crate) mod critical_curve;
pub(crate) mod increment;
pub(crate) mod jump;
pub mod method_dispatch;
pub mod path;
pub(crate) mod path_state;
pub mod penalty;
pub mod scene;
#[cfg(test)]
mod tests_of_exhaustive;
#[cfg(test)]
mod tests_of_growth;
#[cfg(test)]
mod tests_of_lattice;
