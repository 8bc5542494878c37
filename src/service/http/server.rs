//! Listening, and going down in good order.
//!
//! Going down: nothing new is accepted, streams end by themselves (a graceful shutdown would wait for them for ever),
//! solves stop and their jobs go back to the queue, then the database is closed; all of it within a bound.

use crate::service::http::access::Access;
use crate::service::http::listen::{Connections, bind, listen};
use crate::service::http::router::router;
use crate::service::http::state::aside::Aside;
use crate::service::http::state::bodies::Bodies;
use crate::service::http::state::service::Service;
use crate::service::http::tasks::stream::READING_AT_ONCE;
use crate::service::jobs::workers::crew::wound_up;
use crate::service::jobs::{Crew, Jobs, Settings, Solver};
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

/// How a service is reached.
#[derive(Debug, Clone)]
pub struct Front {
    /// Port 0 takes any free one.
    pub listen: SocketAddr,
    pub connections: Connections,
    pub access: Access,
}

/// A service that listens and works.
pub struct Server {
    address: SocketAddr,
    jobs: Jobs,
    crew: Crew,
    listening: JoinHandle<()>,
    shutdown: CancellationToken,
}

impl Server {
    pub async fn start(
        front: Front,
        store: Arc<dyn Store>,
        solver: Arc<dyn Solver>,
        settings: Settings,
    ) -> Result<Self, ServerError> {
        let Front { listen: place, connections, access } = front;
        let refused = |source| ServerError::Listen { address: place, source };
        let listener = bind(place, connections).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let shutdown = CancellationToken::new();
        let jobs = Jobs::new(store, solver, settings);
        let crew = Crew::start(&jobs, &shutdown);
        let service = Service {
            jobs: jobs.clone(),
            attendance: crew.attendance(),
            access,
            aside: Aside::default(),
            bodies: Bodies::default(),
            stream_turns: Arc::new(Semaphore::new(READING_AT_ONCE)),
            shutdown: shutdown.clone(),
        };
        let listening = tokio::spawn(listen(listener, router(service)?, connections, shutdown.clone()));
        Ok(Self { address, jobs, crew, listening, shutdown })
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
        wound_up(async { tokio::join!(self.listening, self.crew.stopped()) }, self.jobs.store()).await
    }
}
