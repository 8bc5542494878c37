//! What can be set when the service is started: limits and settings.

pub mod limits;
pub mod settings;
