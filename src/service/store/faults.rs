//! Classifies errors of the database by the error codes of its engine.

use crate::service::store::contract::error::{Source, StoreError};
use crate::service::store::{postgres, sqlite};

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        let kind: fn(Source) -> Self = match (error.as_database_error(), &error) {
            (Some(found), _) => {
                let code = found.code().unwrap_or_default();
                if found.try_downcast_ref::<sqlx::postgres::PgDatabaseError>().is_some() {
                    postgres::fault(&code)
                } else {
                    sqlite::fault(&code)
                }
            }
            // A connection that was closed, perhaps in the middle of an answer.
            (
                None,
                sqlx::Error::PoolTimedOut
                | sqlx::Error::PoolClosed
                | sqlx::Error::WorkerCrashed
                | sqlx::Error::Io(_)
                | sqlx::Error::Protocol(_),
            ) => Self::Unavailable,
            (None, sqlx::Error::ColumnDecode { .. } | sqlx::Error::Decode(_)) => Self::Damaged,
            (None, _) => Self::Refused,
        };
        kind(Box::new(error))
    }
}
