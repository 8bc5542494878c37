//! What every call can reach.

use crate::service::http::access::Access;
use crate::service::http::state::aside::Aside;
use crate::service::http::state::bodies::Bodies;
use crate::service::jobs::Jobs;
use crate::service::jobs::workers::crew::Attendance;
use std::sync::Arc;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

/// What every call can reach.
#[derive(Clone)]
pub struct Service {
    pub jobs: Jobs,
    pub attendance: Attendance,
    pub access: Access,
    /// Room for bodies that are being read.
    pub bodies: Bodies,
    /// Where large answers are made.
    pub aside: Aside,
    /// Streams that read the store at a time.
    pub stream_turns: Arc<Semaphore>,
    /// Cancelled when the service goes down; open streams end then.
    pub shutdown: CancellationToken,
}
