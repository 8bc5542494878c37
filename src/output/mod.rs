//! Increments as text: the JSON line and the CSV table.
//!
//! Increments are only written here, so that `arcslip solve`, the store and every stream have identical bytes.
//! [`csv`] writes rows of any table, [`columns`] aligned text. Called by `jobs`, `http`, `studies` and `command`; only uses
//! `judged`, `measure` and `result::increment`.

pub mod columns;
pub mod csv;
pub mod line;
pub mod table;

pub use line::json_line;
pub use table::Table;
