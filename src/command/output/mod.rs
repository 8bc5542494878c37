//! What commands print and write, and how they end.

pub(crate) mod findings;
pub(crate) mod outcome;
pub(crate) mod written;
