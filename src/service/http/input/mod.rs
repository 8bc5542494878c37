//! Reading requests: bodies, parameters and headers.

pub mod accept;
pub mod extract;
pub mod parameters;
