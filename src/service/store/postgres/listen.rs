//! NOTIFY and LISTEN: changes in a process wake readers in other processes.
//!
//! Announcements are sent after the changes have been stored, in transactions of their own, and several at a time: a
//! transaction that notifies holds a lock on the whole database until its commit is on the disk, which would serialise the
//! commits of all workers. A transaction that only notifies writes nothing and ends at once. An announcement is lost if the
//! process ends after the change or its connection fails; readers therefore poll the store from time to time.

use crate::service::store::contract::announcements::{Announced, Announcements};
use crate::service::store::contract::signals::Signals;
use sqlx::postgres::{PgConnectOptions, PgListener, PgPool, PgPoolOptions};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{sleep, timeout};

const CHANNEL: &str = "arcslip";
/// Changes within this time are announced together.
const GATHERED: Duration = Duration::from_millis(5);
/// The pause after a failed connection attempt.
const PAUSE: Duration = Duration::from_secs(1);
/// A connection without messages for this time is tested ...
const SILENCE: Duration = Duration::from_secs(10);
/// ... and is given up if it does not answer within this time.
const TO_ANSWER: Duration = Duration::from_secs(5);

/// Announces the changes of this process to the others; does not end.
pub(super) async fn tell(pool: PgPool, announcements: Arc<Announcements>) {
    loop {
        let messages = announcements.next().await;
        if let Err(error) = send(&pool, messages).await {
            tracing::debug!(%error, "a change was not announced to other processes; they poll the store");
            sleep(PAUSE).await;
        }
        sleep(GATHERED).await;
    }
}

pub(super) async fn send(pool: &PgPool, messages: Vec<String>) -> sqlx::Result<()> {
    if messages.is_empty() {
        return Ok(());
    }
    let notify = "SELECT count(pg_notify($1, message)) FROM unnest($2::text[]) AS message";
    let sent = sqlx::query(notify).bind(CHANNEL).bind(messages).execute(pool);
    timeout(TO_ANSWER, sent).await.map_err(|late| sqlx::Error::Io(late.into()))??;
    Ok(())
}

/// Receives the announcements of other processes; does not end.
pub(super) async fn listen(options: PgConnectOptions, signals: Arc<Signals>, announcements: Arc<Announcements>) {
    loop {
        let ended = hear(&options, &signals, &announcements).await;
        if let Err(error) = ended {
            tracing::debug!(%error, "announcements of other processes are not received; the store is polled");
            sleep(PAUSE).await;
        }
    }
}

/// Receives announcements until the connection is lost.
async fn hear(options: &PgConnectOptions, signals: &Signals, announcements: &Announcements) -> sqlx::Result<()> {
    // A pool of its own, which ends with this call: the listener keeps its connection.
    let line = PgPoolOptions::new().max_connections(1).acquire_timeout(TO_ANSWER).max_lifetime(None).idle_timeout(None);
    let line = line.connect_lazy_with(options.clone());
    let mut listener = PgListener::connect_with(&line).await?;
    listener.eager_reconnect(false);
    listener.listen(CHANNEL).await?;
    // Announcements before this were not received.
    signals.all_changed_elsewhere();
    loop {
        match timeout(SILENCE, listener.try_recv()).await {
            Ok(Ok(Some(notification))) => {
                for announced in announcements.read(notification.payload()) {
                    match announced {
                        Announced::Queue => signals.queue_changed_elsewhere(),
                        Announced::Job(id) => signals.job_changed_elsewhere(id),
                    }
                }
            }
            Ok(Ok(None)) => return Ok(()),
            Ok(Err(error)) => return Err(error),
            Err(_) => {
                let answer = timeout(TO_ANSWER, sqlx::query("SELECT 1").execute(&mut listener)).await;
                answer.map_err(|late| sqlx::Error::Io(late.into()))??;
            }
        }
    }
}
