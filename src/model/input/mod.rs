//! What comes in: text, numbers, names, mistakes, and the limits of what is taken.

pub mod error;
pub mod json;
pub mod limits;
pub(crate) mod mistakes;
pub(crate) mod names;
