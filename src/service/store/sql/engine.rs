//! The interface of an SQL engine to the store.

use crate::service::store::contract::error::Result;
use crate::service::store::contract::signals::Signals;
use crate::service::store::sql::dialect::Dialect;
use crate::service::store::{NewJob, Submitted};
use async_trait::async_trait;
use sqlx::pool::PoolConnection;
use sqlx::{Pool, Transaction};
use std::time::Duration;

/// Connections of an engine, and its operations outside SQL.
#[async_trait]
pub(crate) trait Engine: Send + Sync + 'static {
    type Dialect: Dialect;

    /// The time limit of a call, after which the database counts as not answering; `None` without a limit.
    const PATIENCE: Option<Duration>;

    fn readers(&self) -> &Pool<Self::Dialect>;

    fn writers(&self) -> &Pool<Self::Dialect>;

    fn signals(&self) -> &Signals;

    /// # Errors
    /// Why nothing may be written.
    fn allow(&self) -> Result<()>;

    async fn submit(&self, job: NewJob) -> Result<Submitted>;

    async fn shrink(&self) -> Result<bool>;

    async fn check(&self) -> Result<()>;

    async fn close(&self);
}

pub(super) type Of<E> = <E as Engine>::Dialect;

pub(super) async fn reader<E: Engine>(engine: &E) -> sqlx::Result<PoolConnection<E::Dialect>> {
    engine.readers().acquire().await
}

pub(super) async fn writer<E: Engine>(engine: &E) -> sqlx::Result<PoolConnection<E::Dialect>> {
    engine.writers().acquire().await
}

pub(super) async fn begin<E: Engine>(engine: &E) -> sqlx::Result<Transaction<'static, E::Dialect>> {
    engine.writers().begin().await
}

/// Rolls back a transaction that has failed. An error of the rollback is only logged, as the transaction no longer exists
/// then: SQLite rolls back by itself on a full disk, and a lost connection ends its transaction.
pub(super) async fn give_up<D: Dialect>(transaction: Transaction<'static, D>) {
    if let Err(error) = transaction.rollback().await {
        tracing::debug!(%error, "there was no transaction to roll back");
    }
}
