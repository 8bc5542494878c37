//! A path for ParaView and VTK: a file `.vtu` an increment, and a file `.pvd` that lists them by arc length.
//!
//! The formats are those of "VTK XML Formats" (<https://docs.vtk.org/en/latest/vtk_file_formats>). Points are the nodes
//! where the model has them; the vector `displacement` moves them. [`grid`] holds what all increments share, [`piece`]
//! writes one of them, [`collection`] the list.

pub mod arrays;
pub mod collection;
mod contact_areas;
pub mod grid;
pub mod piece;
mod strains;

pub use collection::Collection;
pub use grid::Grid;
