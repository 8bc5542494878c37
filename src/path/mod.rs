//! Tracing the path: from a checked scene to a sequence of increments.
//!
//! [`Path`] is an iterator; whoever drives it (command line, worker, test) decides what to do with each increment.
//!
//! | file | what it does |
//! |---|---|
//! | `scene`, `plan` | a request made dimensionless; what it needs and what is left out |
//! | `state`, `mode_system` | a point; the equations of one contact mode and Newton's method on them |
//! | `watch`, `root`, `advance` | what ends a mode; one step, ended exactly at the first event |
//! | `standing`, `directions`, `condensed`, `decide` | which contacts can change; every direction; which one is taken |
//! | `rates` | all rays of a rate problem, complete: linear forms only |
//! | `program`, `naming` | the MPEC of an increment; where it names the mode |
//! | `energy`, `record`, `increment`, `report`, `stop` | balances, rows, totals, reasons |
//! | `tracer`, `stepping`, `arrival` | the iterator; how far a step goes; what a point turned out to be |

mod advance;
mod arrival;
mod condensed;
mod decide;
mod directions;
mod energy;
#[cfg(test)]
mod exhaustive;
pub mod increment;
mod mode_system;
mod name_event;
mod naming;
pub mod plan;
mod program;
mod rates;
mod record;
pub mod report;
mod root;
pub mod scene;
mod standing;
mod state;
mod stepping;
pub mod stop;
pub mod tracer;
mod watch;

pub use increment::Increment;
pub use plan::Plan;
pub use report::Report;
pub use scene::Scene;
pub use stop::{Outcome, StopReason};
pub use tracer::Path;
