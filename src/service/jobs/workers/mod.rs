//! The background tasks of the service: workers that run queued jobs, and the upkeep of the store.

pub mod batch;
pub mod explore;
pub(crate) mod refinement;
pub mod responses;
pub mod retention;
pub mod worker;
pub mod worker_pool;
