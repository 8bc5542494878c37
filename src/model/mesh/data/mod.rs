//! A mesh as plain data: nodes, elements of the kinds that have stiffness, sets, surfaces.
//!
//! [`draft`] makes a [`MeshData`](mesh_data::MeshData) of what a reader found, the same way for every format.

pub mod draft;
pub mod element_shape;
pub mod error;
pub mod face_orientation;
pub mod label_index;
pub mod member_budget;
pub mod mesh_data;
pub mod node_lists;
pub mod unread;
