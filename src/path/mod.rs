//! Tracing the path: from a checked scene to a sequence of increments.
//!
//! [`Path`] is an iterator; whoever drives it (command line, worker, test) decides what to do with each increment.

pub mod increment;
pub mod plan;
pub mod report;
pub mod scene;
pub mod stop;
pub mod tracer;

pub use increment::Increment;
pub use plan::Plan;
pub use report::Report;
pub use scene::Scene;
pub use stop::{Outcome, StopReason};
pub use tracer::Path;
