//! PostgreSQL, 14 or newer: one server that processes on many machines share.
//!
//! Claims skip rows that others have locked, and all times are taken from the server, so that the clocks of the machines do
//! not matter. A process has at most [`CONNECTIONS`] connections for its calls and one to [listen](listen) on. A call whose
//! connection fails may have been carried out: see [`Store::append`](crate::service::store::contract::interface::Store::append) and [`SqlStore`]. Connections are not encrypted (`sslmode=require` is refused): use a
//! private network, a tunnel or a proxy.

pub(crate) mod connect;
pub(crate) mod dialect;
pub(crate) mod listen;

use crate::service::store::contract::announcements::Announcements;
use crate::service::store::contract::error::{Result, Source};
use crate::service::store::contract::location::Url;
use crate::service::store::contract::signals::Signals;
use crate::service::store::sql::engine::Engine;
use crate::service::store::sql::jobs;
use crate::service::store::sql::store::SqlStore;
use crate::service::store::{NewJob, StoreError, Submitted};
use async_trait::async_trait;
use sqlx::Connection;
use sqlx::postgres::{PgPool, PgPoolOptions, Postgres};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::timeout;
use tokio_util::task::AbortOnDropHandle;

/// Connections of a process for calls. A server accepts 100 by default.
const CONNECTIONS: u32 = 8;
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(15);
/// A connection that has been idle for longer is tested before it is used, as the server may have closed it.
const TRUSTED: Duration = Duration::from_secs(1);
/// A connection that does not answer within this time is given up.
const TO_ANSWER: Duration = Duration::from_secs(5);

pub struct PostgresEngine {
    pool: PgPool,
    signals: Arc<Signals>,
    /// Ends with the store.
    _talk: [AbortOnDropHandle<()>; 2],
    announcements: Arc<Announcements>,
}

impl PostgresEngine {
    pub async fn open(url: &Url) -> Result<SqlStore<Self>> {
        let options = connect::options(url)?;
        connect::prepare(&options).await?;
        let pool = PgPoolOptions::new()
            .max_connections(CONNECTIONS)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .test_before_acquire(false)
            .before_acquire(|connection, about| {
                Box::pin(async move {
                    Ok(about.idle_for < TRUSTED || matches!(timeout(TO_ANSWER, connection.ping()).await, Ok(Ok(()))))
                })
            })
            // The rest of the answer to a cancelled call is read first, which may take for ever on a failed connection.
            .after_release(|connection, _| {
                Box::pin(async move {
                    timeout(TO_ANSWER, connection.ping()).await.map_err(|late| sqlx::Error::Io(late.into()))??;
                    Ok(true)
                })
            })
            .connect_lazy_with(options.clone());
        let announcements = Arc::new(Announcements::new());
        let signals = Arc::new(Signals::announced(Arc::clone(&announcements)));
        let talk = [
            tokio::spawn(listen::tell(pool.clone(), Arc::clone(&announcements))),
            tokio::spawn(listen::listen(options, Arc::clone(&signals), Arc::clone(&announcements))),
        ];
        let talk = talk.map(AbortOnDropHandle::new);
        Ok(SqlStore::over(Self { pool, signals, _talk: talk, announcements }))
    }
}

/// Classifies an SQLSTATE.
pub(super) fn fault(code: &str) -> fn(Source) -> StoreError {
    match code {
        "53100" => StoreError::Full,
        // data corrupted, index corrupted
        "XX001" | "XX002" => StoreError::Damaged,
        // lock not available, cancelled by a timeout, idle in a transaction, read-only (a standby), input/output, serialisation,
        // deadlock
        "55P03" | "57014" | "25P03" | "25006" | "58030" | "40001" | "40P01" => StoreError::Unavailable,
        // connections lost or refused; a role, a password or rights that do not hold now, a database that is closed or not there;
        // the server going down or coming up; out of memory, or of connections
        "3D000" | "42501" | "55000" => StoreError::Unavailable,
        _ if ["08", "28", "57P", "53"].iter().any(|class| code.starts_with(class)) => StoreError::Unavailable,
        _ => StoreError::Refused,
    }
}

#[async_trait]
impl Engine for PostgresEngine {
    type Dialect = Postgres;
    const PATIENCE: Option<Duration> = Some(Duration::from_secs(30));

    fn readers(&self) -> &PgPool {
        &self.pool
    }

    fn writers(&self) -> &PgPool {
        &self.pool
    }

    fn signals(&self) -> &Signals {
        &self.signals
    }

    fn allow(&self) -> Result<()> {
        Ok(())
    }

    async fn submit(&self, job: NewJob) -> Result<Submitted> {
        let mut transaction = self.pool.begin().await?;
        let submitted = jobs::insert::<Postgres>(&mut transaction, &job).await?;
        transaction.commit().await?;
        Ok(submitted)
    }

    /// The server returns free space by itself.
    async fn shrink(&self) -> Result<bool> {
        Ok(false)
    }

    /// The server checks every page that it reads, if it was set up with checksums.
    async fn check(&self) -> Result<()> {
        let failures: Option<i64> = sqlx::query_scalar(
            "SELECT sum(checksum_failures)::bigint FROM pg_stat_database WHERE datname = current_database()",
        )
        .fetch_one(&self.pool)
        .await?;
        match failures {
            None | Some(0) => Ok(()),
            Some(pages) => Err(StoreError::Damaged(
                format!("the server has met {pages} damaged pages (once they are repaired: SELECT pg_stat_reset())")
                    .into(),
            )),
        }
    }

    async fn close(&self) {
        // Wakes the other processes before their next poll.
        let _ = timeout(TO_ANSWER, listen::send(&self.pool, self.announcements.take())).await;
        self.pool.close().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A job whose increments cannot be stored for one of these reasons does not fail.
    #[test]
    fn what_keeps_a_process_out_for_a_while_passes() {
        for code in ["08006", "28000", "28P01", "3D000", "42501", "53300", "55000", "57P01", "57P03"] {
            assert!(fault(code)("refused".into()).is_passing(), "{code}");
        }
        for code in ["22021", "23505", "42P01", "53100", "XX001"] {
            assert!(!fault(code)("refused".into()).is_passing(), "{code}");
        }
    }
}
