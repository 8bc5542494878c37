//! The solids of a model in the terms of mechanics.

pub(crate) mod data;
pub(crate) mod faces;
