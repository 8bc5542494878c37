//! Solids: patches, homogeneous states, exact solutions and contact with rigid obstacles.

mod arch;
mod bad_models;
mod blocks;
mod homogeneous;
mod invariance;
mod known_contacts;
pub mod meshes;
mod pressure;
mod random_quadratic;
mod rivlin;
