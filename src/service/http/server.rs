//! Starts and stops the service.
//!
//! A shutdown accepts no new connections, ends the streams (a graceful shutdown of the server alone would wait for them
//! for ever), stops the solves and returns their jobs to the queue, then closes the database; all within a time limit.

use crate::service::http::access::Access;
use crate::service::http::listen::{Connections, bind, listen};
use crate::service::http::router::router;
use crate::service::http::state::bodies::Bodies;
use crate::service::http::state::offload::Offload;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::stream::READING_AT_ONCE;
use crate::service::jobs::workers::worker_pool::finish_shutdown;
use crate::service::jobs::{Jobs, Settings, Solver, WorkerPool};
use crate::service::store::contract::interface::Store;
use std::net::SocketAddr;
use std::sync::Arc;
use tokio::sync::Semaphore;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    #[error("cannot listen on {address}: {source}")]
    Listen { address: SocketAddr, source: std::io::Error },
    #[error("the interface's description cannot be written: {0}")]
    Description(#[from] serde_json::Error),
}

/// Where a service listens, and whom it admits.
#[derive(Debug, Clone)]
pub struct ListenOptions {
    /// Port 0 takes any free one.
    pub listen: SocketAddr,
    pub connections: Connections,
    pub access: Access,
}

/// A running service: its listener and its workers.
pub struct Server {
    address: SocketAddr,
    jobs: Jobs,
    workers: WorkerPool,
    listening: JoinHandle<()>,
    shutdown: CancellationToken,
}

impl Server {
    pub async fn start(
        front: ListenOptions,
        store: Arc<dyn Store>,
        solver: Arc<dyn Solver>,
        settings: Settings,
    ) -> Result<Self, ServerError> {
        let ListenOptions { listen: place, connections, access } = front;
        let refused = |source| ServerError::Listen { address: place, source };
        let listener = bind(place, connections).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let shutdown = CancellationToken::new();
        let jobs = Jobs::new(store, solver, settings);
        let workers = WorkerPool::start(&jobs, &shutdown);
        let service = Service {
            jobs: jobs.clone(),
            worker_count: workers.worker_count(),
            access,
            offload: Offload::default(),
            bodies: Bodies::default(),
            stream_turns: Arc::new(Semaphore::new(READING_AT_ONCE)),
            shutdown: shutdown.clone(),
        };
        let listening = tokio::spawn(listen(listener, router(service)?, connections, shutdown.clone()));
        Ok(Self { address, jobs, workers, listening, shutdown })
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    pub fn jobs(&self) -> &Jobs {
        &self.jobs
    }

    /// Stops the service; answers whether everything ended within the time limit.
    pub async fn stop(self) -> bool {
        self.shutdown.cancel();
        finish_shutdown(async { tokio::join!(self.listening, self.workers.stopped()) }, self.jobs.store()).await
    }
}
