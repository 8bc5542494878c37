//! Reads bodies within a bound on the memory of all bodies: each reserves room for the bytes received, not for the announced
//! length.

use crate::service::http::answer::problem::{Kind, Problem};
use axum::body::{Body, HttpBody};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, timeout_at};
use tokio_stream::StreamExt;

/// A body has to be received within this time.
const WHOLE: Duration = Duration::from_secs(60);
/// Bytes of a unit of room.
const UNIT: usize = 4096;
/// Units of room for all bodies: 256 MiB.
const UNITS: usize = 65_536;

/// The room for all bodies of a service.
#[derive(Debug, Clone)]
pub struct Bodies {
    room: Arc<Semaphore>,
    /// One body may exceed the room, so that bodies which together hold all of it do not wait for each other.
    past: Arc<Semaphore>,
}

/// A body and its room, which is released on drop.
#[derive(Debug, Default)]
pub struct Read {
    pub text: Vec<u8>,
    pub taken: HeldRoom,
}

/// Reserved room.
#[derive(Debug, Default)]
pub struct HeldRoom {
    room: Option<OwnedSemaphorePermit>,
    past: Option<OwnedSemaphorePermit>,
}

impl Default for Bodies {
    fn default() -> Self {
        Self { room: Arc::new(Semaphore::new(UNITS)), past: Arc::new(Semaphore::new(1)) }
    }
}

impl Bodies {
    /// Reads a body of at most `most` bytes.
    ///
    /// # Errors
    /// The body is larger, is incomplete, or is not received in time. Waiting for room counts, so that a slow client does not
    /// hold room for longer than that.
    pub async fn read(&self, body: Body, most: usize) -> Result<Read, Problem> {
        let too_large = || Problem::new(Kind::BodyTooLarge, format!("at most {most} bytes are accepted"));
        // A body that is announced as too large is refused before it is sent.
        if body.size_hint().lower() > most as u64 {
            return Err(too_large());
        }
        let end = Instant::now() + WHOLE;
        let (mut stream, mut read) = (body.into_data_stream(), Read::default());
        loop {
            let chunk = timeout_at(end, stream.next()).await.map_err(|_| late())?;
            let Some(chunk) = chunk else { return Ok(read) };
            let chunk = chunk.map_err(|_| Problem::new(Kind::RequestFailed, "the body is incomplete"))?;
            let bytes = read.text.len().saturating_add(chunk.len());
            if bytes > most {
                return Err(too_large());
            }
            timeout_at(end, self.make_room(&mut read.taken, bytes)).await.map_err(|_| late())??;
            read.text.extend_from_slice(&chunk);
        }
    }

    /// Reserves room until there is enough for `bytes`.
    async fn make_room(&self, taken: &mut HeldRoom, bytes: usize) -> Result<(), Problem> {
        let held = taken.room.as_ref().map_or(0, OwnedSemaphorePermit::num_permits);
        let lacking = bytes.div_ceil(UNIT).saturating_sub(held);
        if lacking == 0 || taken.past.is_some() {
            return Ok(());
        }
        let lacking = u32::try_from(lacking).unwrap_or(u32::MAX);
        tokio::select! {
            biased;
            room = Arc::clone(&self.room).acquire_many_owned(lacking) => {
                let room = room.map_err(|_| gone_down())?;
                match &mut taken.room {
                    Some(held) => held.merge(room),
                    none => *none = Some(room),
                }
            }
            past = Arc::clone(&self.past).acquire_owned() => taken.past = Some(past.map_err(|_| gone_down())?),
        }
        Ok(())
    }
}

fn late() -> Problem {
    Problem::new(Kind::RequestFailed, format!("the body was not received within {} s", WHOLE.as_secs()))
}

fn gone_down() -> Problem {
    Problem::new(Kind::Unavailable, "the service is shutting down")
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Bytes;
    use tokio::sync::mpsc;
    use tokio_stream::wrappers::UnboundedReceiverStream;

    type Sender = mpsc::UnboundedSender<Result<Bytes, std::io::Error>>;

    fn body() -> (Sender, Body) {
        let (sender, receiver) = mpsc::unbounded_channel();
        (sender, Body::from_stream(UnboundedReceiverStream::new(receiver)))
    }

    /// Two bodies that together need more than there is come to their ends, one after the other.
    #[tokio::test]
    async fn bodies_that_hold_all_the_room_do_not_wait_for_each_other() {
        let bodies = Bodies { room: Arc::new(Semaphore::new(4)), ..Bodies::default() };
        let mut readers = Vec::new();
        for _ in 0..3 {
            let (sender, body) = body();
            let of_a_reader = bodies.clone();
            let read = async move { of_a_reader.read(body, 1 << 20).await.map(|read| read.text.len()) };
            readers.push((sender, tokio::spawn(read)));
        }
        for _ in 0..4 {
            for (sender, _) in &readers {
                sender.send(Ok(Bytes::from(vec![b' '; UNIT]))).expect("it listens");
                tokio::task::yield_now().await;
            }
        }
        let mut ends = Vec::new();
        for (sender, reader) in readers {
            drop(sender);
            ends.push(reader);
        }
        for end in ends {
            assert_eq!(end.await.expect("it ends").expect("read"), 4 * UNIT);
        }
        assert_eq!((bodies.room.available_permits(), bodies.past.available_permits()), (4, 1));
    }

    #[tokio::test]
    async fn what_is_announced_takes_no_room() {
        let bodies = Bodies::default();
        let (sender, body) = body();
        let of_the_reader = bodies.clone();
        let reader = tokio::spawn(async move { of_the_reader.read(body, 1 << 24).await });
        sender.send(Ok(Bytes::from_static(b"{"))).expect("it listens");
        while bodies.room.available_permits() == UNITS {
            tokio::task::yield_now().await;
        }
        assert_eq!(bodies.room.available_permits(), UNITS - 1);
        reader.abort();
        assert!(reader.await.is_err());
        assert_eq!(bodies.room.available_permits(), UNITS);
    }
}
