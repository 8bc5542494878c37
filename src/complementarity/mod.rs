//! Complementarity problems: the mathematical programs of increments ([`mpec`]) and the rate problems of directions ([`rates`],
//! [`rate_search`]).
//!
//! Uses vectors, matrices and linear forms only, and is independent of structures, contacts and paths.

pub mod mpec;
pub mod rate_search;
pub mod rates;
