//! Increments as text: the JSON line and the CSV table.
//!
//! The one place where an increment is written, so that `arcslip solve`, the store and every stream show the same bytes.
//! [`csv`] writes rows of any table, [`columns`] text for a reader. Called by `jobs`, `http`, `studies` and `command`; knows only `judged`, `measure` and
//! `result::increment`.

pub mod columns;
pub mod csv;
pub mod line;
pub mod table;

pub use line::json_line;
pub use table::Table;
