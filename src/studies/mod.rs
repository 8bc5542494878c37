//! Many paths of one model: error against run time, and limit loads against what is varied.

pub mod critical_curves;
pub mod error_against_time;
#[cfg(feature = "server")]
pub mod picture;
pub mod sweeps;
