//! Paths: traced, and written in other formats.

pub mod export;
pub mod solve;
