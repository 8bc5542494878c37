//! Accepts connections: with bounds on their number, with timeouts, and with the address of the client in each request.
//!
//! (The accept loop of axum has neither a bound on connections nor a timeout for requests.)

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

/// The head of a request has to come within this time after the connection or the previous answer.
const HEAD: Duration = Duration::from_secs(30);
/// A client that reads nothing of its answer for this time is disconnected; it can resume a stream.
const UNREAD: Duration = Duration::from_secs(60);
/// The pause after a failed accept, for example for lack of file descriptors.
const PAUSE: Duration = Duration::from_millis(200);

/// Bounds on the number of connections.
#[derive(Debug, Clone, Copy)]
pub struct Connections {
    /// Connections that are served at a time; further ones wait.
    pub all: usize,
    /// Connections that may wait, the backlog of the socket; the operating system may lower it, and refuses further ones.
    pub waiting: usize,
    /// Connections from one address; further ones are closed at once. Loopback addresses have no such bound.
    pub an_address: Option<NonZeroU32>,
}

/// Listens on an address.
///
/// # Errors
/// The address is in use, or does not belong to this machine.
pub fn bind(place: SocketAddr, connections: Connections) -> io::Result<TcpListener> {
    let socket = if place.is_ipv4() { TcpSocket::new_v4()? } else { TcpSocket::new_v6()? };
    // As the listener of the standard library does: the port can be bound again at once after the service has ended.
    socket.set_reuseaddr(true)?;
    socket.bind(place)?;
    socket.listen(u32::try_from(connections.waiting).unwrap_or(u32::MAX))
}

/// Accepts connections until `shutdown`, then waits for the open ones to end.
pub async fn listen(listener: TcpListener, router: Router, connections: Connections, shutdown: CancellationToken) {
    let (places, addresses) = (Arc::new(Semaphore::new(connections.all)), Addresses::default());
    let graceful = GracefulShutdown::new();
    let mut protocol = http1::Builder::new();
    protocol.timer(TokioTimer::new()).header_read_timeout(HEAD);
    while let Some((place, stream, address)) = next(&listener, &places, &shutdown).await {
        let Some(held) = addresses.take(address.ip(), connections.an_address) else {
            tracing::debug!(%address, "the address has too many connections");
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
                tracing::debug!(%error, %address, "the connection failed");
            }
        });
    }
    drop(listener);
    graceful.shutdown().await;
}

/// The number of connections of each connected address.
#[derive(Debug, Default, Clone)]
struct Addresses(Arc<Mutex<HashMap<IpAddr, u32>>>);

/// A counted connection; dropping it ends the count.
#[derive(Debug)]
struct Held {
    addresses: Addresses,
    address: IpAddr,
}

impl Addresses {
    /// Counts a connection; `None` if the address has the most that it may have.
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
        // The map is consistent wherever a thread that holds the lock could panic.
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

/// The next connection, accepted once there is a place for it. `None` after `shutdown`.
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
                    // Events are small and are sent without delay.
                    let _ = stream.set_nodelay(true);
                    return Some((place, stream, address));
                }
                Err(error) => {
                    tracing::warn!(%error, "no connection could be accepted");
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
