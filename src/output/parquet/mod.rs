//! A path as Parquet (<https://parquet.apache.org/docs/file-format>): four tables, of increments, nodes, elements and
//! contacts, each row with the `index` of its increment.
//!
//! [`sheet`] writes the rows of any table, [`tables`] says which columns they have and what a row holds.

pub mod sheet;
pub mod tables;

pub use sheet::{Cell, Sheet};
pub use tables::PathTable;
