//! From a request to a running solve: the queue and the workers behind it.
//!
//! [`configuration`] has the limits and settings of the service, [`queue`] the operations on jobs (submit, read, cancel,
//! delete), [`solving`] a single solve and what it hands to the store, [`workers`] the tasks that take jobs from the queue
//! and run them. Called by `http` and `command`; uses `store`, `judged`, `studies`, `continuation`, `model` and, for what
//! is counted and timed, `metrics`.

pub mod configuration;
pub mod queue;
pub mod solving;
pub mod workers;

pub use configuration::limits::Limits;
pub use configuration::settings::Settings;
pub use queue::caller::Caller;
pub use queue::checks::Posted;
pub use queue::error::JobsError;
pub use queue::fair_semaphore::Client;
pub use queue::jobs::Jobs;
pub use solving::solver::{PathSolver, Solver, solve_scene};
pub use workers::worker_pool::WorkerPool;
