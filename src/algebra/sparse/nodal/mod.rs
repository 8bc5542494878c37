//! Nodes whose unknowns border rows hold: closed contacts.
//!
//! | file | what it holds |
//! |---|---|
//! | `holdings` | which rows hold which unknowns |
//! | `held_node` | the matrices of one held node |
//! | `last_nodes` | those of the last factorisation, for the next |

pub(crate) mod held_node;
pub(crate) mod holdings;
pub(crate) mod last_nodes;
