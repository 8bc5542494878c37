//! Judged paths: every increment with its measure of error, and the report with the maxima.
//!
//! Solver and measure are only combined here: [`continuation`](crate::continuation) does not depend on the measure, and
//! [`measure`](crate::check::measure) only reads the published increments. All increments that are printed, stored or streamed
//! come from a [`JudgedPath`].
//!
//! | file | what it does |
//! |---|---|
//! | `path` | step by step, or as an iterator of what is recorded: traces, judges, goes on from a checkpoint |
//! | `increment`, `report` | what it gives |
//! | `record` | the parts of an increment that are kept after it has been judged |
//! | `alternatives` | which directions are new at an increment |
//! | `equilibrium_problem`, `equilibrium_path` | the same for programs that use the crate as a library |
//! | `checkpoint` | a checkpoint of the path with the history of its judge |
//! | `schema` | their JSON Schema |

#![warn(missing_docs)]

pub mod alternatives;
pub mod checkpoint;
pub mod equilibrium_path;
pub mod equilibrium_problem;
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
