//! Increments in the formats of files: the JSON line, the CSV table, Parquet, and VTK for ParaView.
//!
//! Increments are only written here, so that `arcslip solve`, the store and every stream have identical bytes.
//! [`csv`] writes rows of any table, [`columns`] aligned text. Called by `jobs`, `http`, `studies` and `command`; only uses
//! `model`, `judged`, `measure` and `result::increment`.

pub mod columns;
pub mod csv;
pub mod line;
#[cfg(feature = "server")]
pub mod parquet;
pub mod table;
#[cfg(feature = "server")]
pub mod vtk;

pub use line::json_line;
pub use table::Table;
