//! Sweeps: one model with varied parameters, and what is found on each path.
//!
//! | file | what it does |
//! |---|---|
//! | `limit_load` | the load of a limit point |
//! | `responses` | values at places of a path, as a sweep asks for them |
//! | `refinement` | further values where a response changes most |
//! | `found` | the findings, row by row |
//! | `table` | the findings as text |
//! | `run` | all runs on the cores of this machine |
//!
//! The replacements are read by [`model::sweep`](crate::model::request::sweep). Called by `jobs`, `http`, `picture` and `command`;
//! knows `model`, `judged` and `continuation`.

pub(crate) mod found;
pub(crate) mod limit_load;
pub(crate) mod refinement;
pub(crate) mod responses;
pub(crate) mod run;
pub(crate) mod table;

pub use found::{Found, Row};
pub use limit_load::LimitLoad;
pub use refinement::further_values;
pub use responses::ResponseFinder;
pub use run::{check, run};
pub use table::shown;
