//! The solids of a model and their surfaces in the terms of mechanics.

pub(crate) mod closed_surfaces;
pub(crate) mod contact_surfaces;
pub(crate) mod data;
pub(crate) mod faces;
pub(crate) mod middle_nodes;
