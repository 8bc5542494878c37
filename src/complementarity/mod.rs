//! Complementarity problems: the mathematical programs of increments ([`mpec`]) and the rate problems of directions ([`rates`],
//! [`rate_search`]).
//!
//! Knows vectors, matrices and linear forms only: nothing of structures, contacts or paths.

pub mod mpec;
pub mod rate_search;
pub mod rates;
