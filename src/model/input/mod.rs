//! Input: JSON text, names, mistakes and limits.

pub mod error;
pub mod json;
pub mod limits;
pub(crate) mod mistakes;
pub(crate) mod names;
