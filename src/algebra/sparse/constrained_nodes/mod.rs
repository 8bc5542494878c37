//! Nodes whose unknowns border rows hold: closed contacts.
//!
//! | file | what it holds |
//! |---|---|
//! | `nodal_constraints` | which rows hold which unknowns |
//! | `held_node` | the matrices of one held node |
//! | `node_cache` | those of the last factorisation, for the next |

pub(crate) mod held_node;
pub(crate) mod nodal_constraints;
pub(crate) mod node_cache;
