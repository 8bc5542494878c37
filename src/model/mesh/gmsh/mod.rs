//! MeshData files of gmsh, versions 2.2 (with 2.0 and 2.1) and 4.1, text and binary in both orders of bytes.
//!
//! The format: C. Geuzaine and J.-F. Remacle, *Gmsh Reference Manual*, chapter "Gmsh file formats". `cursor` reads
//! numbers whatever their encoding, so that one reader serves a version's text and binary files; `legacy` reads nodes
//! and elements of 2.2, `blocks` those of 4.1; `groups` makes sets of physical groups.

mod binary;
mod blocks;
mod cursor;
mod element_record;
mod element_types;
mod entities;
mod found;
mod groups;
mod legacy;
mod sections;
mod text;

pub use sections::read;
