//! The path as it leaves the solver: every increment with what the measure says of it, the report with the maxima.
//!
//! Solver and measure meet here and nowhere else: [`continuation`](crate::continuation) does not know that it is judged, and
//! [`measure`](crate::check::measure) reads increments as anybody may. Whatever prints, stores or streams increments takes them
//! from a [`JudgedPath`].
//!
//! | file | what it does |
//! |---|---|
//! | `continuation` | step by step, or as an iterator of what is recorded: traces, judges, goes on from a checkpoint |
//! | `increment`, `report` | what it gives |
//! | `record` | what of an increment is kept, after it has been judged |
//! | `alternatives` | which directions are new at an increment |
//! | `checkpoint` | a path put down together with the judge's memory of it |
//! | `schema` | their JSON Schema |

pub mod alternatives;
pub mod checkpoint;
pub mod increment;
pub mod path;
pub(crate) mod record;
pub mod report;
#[cfg(feature = "server")]
pub(crate) mod schema;

pub use alternatives::Alternatives;
pub use checkpoint::{JudgedCheckpoint, JudgedCheckpointError};
pub use increment::JudgedIncrement;
pub use path::{JudgedPath, Step};
pub use report::{JudgedReport, MeasureReport, OFF_MEASURE};
