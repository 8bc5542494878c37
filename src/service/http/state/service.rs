//! What every call can reach.

use crate::service::http::access::Access;
use crate::service::http::state::bodies::Bodies;
use crate::service::http::state::offload::Offload;
use crate::service::jobs::Jobs;
use crate::service::jobs::workers::worker_pool::WorkerCount;
use std::sync::Arc;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

/// The state of the service that every call can reach; cheap to clone.
#[derive(Clone)]
pub struct Service {
    pub jobs: Jobs,
    pub worker_count: WorkerCount,
    pub access: Access,
    /// Room for the bodies that are being read.
    pub bodies: Bodies,
    /// Runs the work on large answers.
    pub offload: Offload,
    /// Permits for streams to read the store.
    pub stream_turns: Arc<Semaphore>,
    /// Cancelled when the service shuts down; open streams end then.
    pub shutdown: CancellationToken,
}
