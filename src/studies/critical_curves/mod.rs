//! Curves of limit points and others over a parameter of a model, judged point by point.
//!
//! | file | what it does |
//! |---|---|
//! | `row` | a point, and the end of a curve |
//! | `run` | follows the curve and judges its points |
//! | `table` | the findings as text |
//!
//! The model and its parameter are read by [`model::curves`](crate::model::curves).

pub(crate) mod row;
pub(crate) mod run;
pub mod table;

pub use row::{CurveFound, CurveRow, CurveSummary};
pub use run::run;
