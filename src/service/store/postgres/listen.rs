//! NOTIFY and LISTEN: what changes in one process wakes those who wait in the others.
//!
//! Announcements are sent apart from what they announce, after it was stored and several at a time: a transaction that notifies
//! holds a lock of the whole database until its commit is on the disk, and those of all workers would follow one another. One
//! that only notifies writes nothing and is done at once. A process that ends between storing and telling tells nothing, as does
//! a connection that was lost: whoever waits looks from time to time by itself.

use crate::service::store::contract::announcements::{Announced, Announcements};
use crate::service::store::contract::signals::Signals;
use sqlx::postgres::{PgConnectOptions, PgListener, PgPool, PgPoolOptions};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{sleep, timeout};

const CHANNEL: &str = "arcslip";
/// Changes of so long are told together.
const GATHERED: Duration = Duration::from_millis(5);
/// After a connection that could not be had.
const PAUSE: Duration = Duration::from_secs(1);
/// A line on which nothing was heard for so long is looked at ...
const SILENCE: Duration = Duration::from_secs(10);
/// ... and is lost if it does not answer in this time.
const TO_ANSWER: Duration = Duration::from_secs(5);

/// Tells the others what has changed here, for ever.
pub(super) async fn tell(pool: PgPool, announcements: Arc<Announcements>) {
    loop {
        let messages = announcements.next().await;
        if let Err(error) = send(&pool, messages).await {
            tracing::debug!(%error, "other processes were not told of a change; they look for themselves");
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

/// Hears what others have changed, for ever.
pub(super) async fn listen(options: PgConnectOptions, signals: Arc<Signals>, announcements: Arc<Announcements>) {
    loop {
        let ended = hear(&options, &signals, &announcements).await;
        if let Err(error) = ended {
            tracing::debug!(%error, "changes of other processes are not heard of; they are looked for");
            sleep(PAUSE).await;
        }
    }
}

/// Until the connection is lost.
async fn hear(options: &PgConnectOptions, signals: &Signals, announcements: &Announcements) -> sqlx::Result<()> {
    // A pool of its own, which ends with this call: the listener keeps its connection.
    let line = PgPoolOptions::new().max_connections(1).acquire_timeout(TO_ANSWER).max_lifetime(None).idle_timeout(None);
    let line = line.connect_lazy_with(options.clone());
    let mut listener = PgListener::connect_with(&line).await?;
    listener.eager_reconnect(false);
    listener.listen(CHANNEL).await?;
    // What was told before this was not heard.
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
