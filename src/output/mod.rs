//! Increments as text: the JSON line and the CSV table.
//!
//! The one place where an increment is written, so that `arcslip solve`, the store and every stream show the same bytes.
//! [`csv`] writes rows of any table, [`columns`] text for a reader. Called by `jobs`, `http`, `studies`, `sweeps` and `command`; knows only `judged`, `measure` and
//! `path::increment`.

pub mod columns;
pub mod csv;
pub mod line;
#[cfg(feature = "server")]
pub mod picture;
pub mod table;

pub use line::json_line;
pub use table::Table;
