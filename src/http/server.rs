//! Listening, and going down in good order.
//!
//! Going down: nothing new is accepted, streams end by themselves (a graceful shutdown would wait for them for ever),
//! solves stop and their jobs go back to the queue, then the database is closed; all of it within a bound.

use super::{Service, router};
use crate::jobs::{Crew, Jobs, Settings, Solver};
use crate::store::Store;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// Answers and solves under way get so long to end.
const DRAIN: Duration = Duration::from_secs(8);
/// Closing the database after that.
const CLOSE: Duration = Duration::from_secs(2);

#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    #[error("cannot listen on {address}: {source}")]
    Listen { address: SocketAddr, source: std::io::Error },
    #[error("the interface's description cannot be written: {0}")]
    Description(#[from] serde_json::Error),
}

/// A service that listens and works.
pub struct Server {
    address: SocketAddr,
    jobs: Jobs,
    crew: Crew,
    listening: JoinHandle<std::io::Result<()>>,
    shutdown: CancellationToken,
}

impl Server {
    /// Port 0 takes any free one.
    pub async fn start(
        listen: SocketAddr,
        store: Arc<dyn Store>,
        solver: Arc<dyn Solver>,
        settings: Settings,
    ) -> Result<Self, ServerError> {
        let refused = |source| ServerError::Listen { address: listen, source };
        let listener = TcpListener::bind(listen).await.map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let shutdown = CancellationToken::new();
        let jobs = Jobs::new(store, solver, settings);
        let crew = Crew::start(&jobs, &shutdown);
        let service = Service { jobs: jobs.clone(), attendance: crew.attendance(), shutdown: shutdown.clone() };
        let serve = axum::serve(listener, router(service)?).with_graceful_shutdown(shutdown.clone().cancelled_owned());
        Ok(Self { address, jobs, crew, listening: tokio::spawn(async move { serve.await }), shutdown })
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    pub fn jobs(&self) -> &Jobs {
        &self.jobs
    }

    /// Ends everything; answers whether it all ended within the bound.
    pub async fn stop(self) -> bool {
        self.shutdown.cancel();
        let ended = timeout(DRAIN, async { tokio::join!(self.listening, self.crew.stopped()) }).await;
        if ended.is_err() {
            tracing::warn!(seconds = DRAIN.as_secs(), "not everything ended in time; its jobs run again later");
        }
        let closed = timeout(CLOSE, self.jobs.store().close()).await;
        ended.is_ok() && closed.is_ok()
    }
}
