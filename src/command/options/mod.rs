//! Options that several commands share, and the settings of the service.

pub(crate) mod access;
pub(crate) mod bounds;
pub(crate) mod duration;
pub(crate) mod embedded_mesh;
pub(crate) mod input;
pub(crate) mod limits;
pub(crate) mod service;
pub(crate) mod settings;
pub(crate) mod size;
