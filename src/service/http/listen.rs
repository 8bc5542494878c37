//! Taking connections: so many at a time, none that dawdles over its request, each told where it comes from.
//!
//! (axum's own loop has no bound on connections, and waits for ever for a request that does not come.)

use crate::service::http::access::rates::subscriber;
use axum::Router;
use axum::body::Body;
use axum::extract::{ConnectInfo, Request};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::num::NonZeroU32;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::net::{TcpListener, TcpSocket};
use tokio::sync::Semaphore;
use tokio_io_timeout::TimeoutStream;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt;

/// A request's head has to come within so long of the connection, or of the answer before.
const HEAD: Duration = Duration::from_secs(30);
/// A client that takes nothing of its answer for so long is gone; a stream can be resumed.
const UNREAD: Duration = Duration::from_secs(60);
/// When no connection can be taken, as when there are no more file descriptors.
const PAUSE: Duration = Duration::from_millis(200);

/// How many connections are served at a time.
#[derive(Debug, Clone, Copy)]
pub struct Connections {
    /// Those past that wait ...
    pub all: usize,
    /// ... up to so many, or as many as the system lets wait; those past that are asked to come back by the system.
    pub waiting: usize,
    /// Those past that are closed at once; this machine's own addresses have no such bound.
    pub an_address: Option<NonZeroU32>,
}

/// Listens there.
///
/// # Errors
/// The address is taken, or none of this machine's.
pub fn bind(place: SocketAddr, connections: Connections) -> io::Result<TcpListener> {
    let socket = if place.is_ipv4() { TcpSocket::new_v4()? } else { TcpSocket::new_v6()? };
    // As a listener that is bound by name does: the port is free again at once when the service has gone.
    socket.set_reuseaddr(true)?;
    socket.bind(place)?;
    socket.listen(u32::try_from(connections.waiting).unwrap_or(u32::MAX))
}

/// Takes connections until `shutdown`, then waits for those under way to end.
pub async fn listen(listener: TcpListener, router: Router, connections: Connections, shutdown: CancellationToken) {
    let (places, addresses) = (Arc::new(Semaphore::new(connections.all)), Addresses::default());
    let graceful = GracefulShutdown::new();
    let mut protocol = http1::Builder::new();
    protocol.timer(TokioTimer::new()).header_read_timeout(HEAD);
    while let Some((place, stream, address)) = next(&listener, &places, &shutdown).await {
        let Some(held) = addresses.take(address.ip(), connections.an_address) else {
            tracing::debug!(%address, "an address has as many connections as it may");
            continue;
        };
        let router = router.clone();
        let service = service_fn(move |mut request: Request<Incoming>| {
            request.extensions_mut().insert(ConnectInfo::<SocketAddr>(address));
            router.clone().oneshot(request.map(Body::new))
        });
        let mut stream = TimeoutStream::new(stream);
        stream.set_write_timeout(Some(UNREAD));
        let connection = graceful.watch(protocol.serve_connection(TokioIo::new(Box::pin(stream)), service));
        tokio::spawn(async move {
            let _place = (place, held);
            if let Err(error) = connection.await {
                tracing::debug!(%error, %address, "a connection broke off");
            }
        });
    }
    drop(listener);
    graceful.shutdown().await;
}

/// Connections of each address from which there are any.
#[derive(Debug, Default, Clone)]
struct Addresses(Arc<Mutex<HashMap<IpAddr, u32>>>);

/// One of them.
#[derive(Debug)]
struct Held {
    addresses: Addresses,
    address: IpAddr,
}

impl Addresses {
    /// `None`: there are enough.
    fn take(&self, address: IpAddr, most: Option<NonZeroU32>) -> Option<Held> {
        let address = subscriber(address);
        let mut all = self.all();
        let count = all.entry(address).or_default();
        if most.is_some_and(|most| *count >= most.get()) && !address.is_loopback() {
            return None;
        }
        *count += 1;
        Some(Held { addresses: self.clone(), address })
    }

    fn all(&self) -> MutexGuard<'_, HashMap<IpAddr, u32>> {
        // The map is whole at every point where its holder could panic.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let mut all = self.addresses.all();
        if let Entry::Occupied(mut count) = all.entry(self.address) {
            *count.get_mut() -= 1;
            if *count.get() == 0 {
                count.remove();
            }
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_so_many_connections_and_this_machine_any_number() {
        let addresses = Addresses::default();
        let take = |address: &str| addresses.take(address.parse().unwrap(), NonZeroU32::new(2));
        let mut held: Vec<Option<Held>> = (0..3).map(|_| take("192.0.2.1")).collect();
        assert_eq!(held.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false]);
        assert!(take("192.0.2.2").is_some() && addresses.all().len() == 1, "those that are gone are forgotten");
        held.remove(0);
        assert!(take("192.0.2.1").is_some());
        let own: Vec<_> = (0..10).map(|_| take("127.0.0.1")).collect();
        assert!(own.iter().all(Option::is_some));
        assert!(addresses.take("192.0.2.1".parse().unwrap(), None).is_some());
    }
}
