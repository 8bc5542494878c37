//! Meshes from files.
pub mod data;
pub mod gmsh;
