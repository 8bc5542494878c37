//! Solids: patches, homogeneous states, exact solutions and contact with rigid obstacles.

mod arch;
mod blocks;
mod homogeneous;
mod known_contacts;
mod meshes;
mod rivlin;
