//! Taking connections: so many at a time, none that dawdles over its request, each told where it comes from.
//!
//! (axum's own loop has no bound on connections, and waits for ever for a request that does not come.)

use axum::Router;
use axum::body::Body;
use axum::extract::{ConnectInfo, Request};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt;

/// A request's head has to come within so long of the connection, or of the answer before.
const HEAD: Duration = Duration::from_secs(30);
/// When no connection can be taken, as when there are no more file descriptors.
const PAUSE: Duration = Duration::from_millis(200);

/// Takes connections until `shutdown`, then waits for those under way to end.
pub async fn listen(listener: TcpListener, router: Router, connections: usize, shutdown: CancellationToken) {
    let places = Arc::new(Semaphore::new(connections));
    let graceful = GracefulShutdown::new();
    let mut protocol = http1::Builder::new();
    protocol.timer(TokioTimer::new()).header_read_timeout(HEAD);
    while let Some((place, stream, address)) = next(&listener, &places, &shutdown).await {
        let router = router.clone();
        let service = service_fn(move |mut request: Request<Incoming>| {
            request.extensions_mut().insert(ConnectInfo::<SocketAddr>(address));
            router.clone().oneshot(request.map(Body::new))
        });
        let connection = graceful.watch(protocol.serve_connection(TokioIo::new(stream), service));
        tokio::spawn(async move {
            let _place = place;
            if let Err(error) = connection.await {
                tracing::debug!(%error, %address, "a connection broke off");
            }
        });
    }
    drop(listener);
    graceful.shutdown().await;
}

type Place = tokio::sync::OwnedSemaphorePermit;

/// The next connection, once there is a place for it; those past that wait to be taken. `None`: nothing more is taken.
async fn next(
    listener: &TcpListener,
    places: &Arc<Semaphore>,
    shutdown: &CancellationToken,
) -> Option<(Place, tokio::net::TcpStream, SocketAddr)> {
    let taken = async {
        let place = Arc::clone(places).acquire_owned().await.ok()?;
        loop {
            match listener.accept().await {
                Ok((stream, address)) => {
                    // Events are small and are to be seen when they happen.
                    let _ = stream.set_nodelay(true);
                    return Some((place, stream, address));
                }
                Err(error) => {
                    tracing::warn!(%error, "no connection could be taken");
                    tokio::time::sleep(PAUSE).await;
                }
            }
        }
    };
    tokio::select! {
        () = shutdown.cancelled() => None,
        taken = taken => taken,
    }
}
