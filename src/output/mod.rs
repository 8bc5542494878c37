//! Increments as text: the JSON line and the CSV table.
//!
//! The one place where an increment is written, so that `arcslip solve`, the store and every stream show the same bytes.
//! Called by `jobs`, `http` and `command`; knows only `judged` and `path::increment`.

pub mod line;
pub mod table;

pub use line::json_line;
pub use table::Table;
