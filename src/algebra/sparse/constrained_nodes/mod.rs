//! Nodes with unknowns constrained by border rows: closed contacts.
//!
//! | file | contents |
//! |---|---|
//! | `nodal_constraints` | which border rows constrain which unknowns |
//! | `constrained_node` | the matrices of one constrained node |
//! | `node_cache` | the constrained nodes of the last factorisations, for reuse |

pub(crate) mod constrained_node;
pub(crate) mod nodal_constraints;
pub(crate) mod node_cache;
