//! The differences between the SQL dialects of the engines, and the values of statements and rows.
//!
//! Statements are texts with `$1`, `$2`, ... for values and a few words in braces for what the engines say differently.

use crate::service::store::{Line, NewRun};
use sqlx::{Database, Row};
use std::future::Future;
use tokio_stream::Stream;
use uuid::Uuid;

/// A value of a statement.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Value<'a> {
    Id(Option<Uuid>),
    Text(Option<&'a str>),
    Number(Option<i64>),
}

impl From<Uuid> for Value<'_> {
    fn from(id: Uuid) -> Self {
        Self::Id(Some(id))
    }
}

impl From<Option<Uuid>> for Value<'_> {
    fn from(id: Option<Uuid>) -> Self {
        Self::Id(id)
    }
}

impl<'a> From<&'a str> for Value<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(Some(text))
    }
}

impl<'a> From<&'a String> for Value<'a> {
    fn from(text: &'a String) -> Self {
        Self::Text(Some(text))
    }
}

impl<'a> From<&'a Option<String>> for Value<'a> {
    fn from(text: &'a Option<String>) -> Self {
        Self::Text(text.as_deref())
    }
}

impl<'a> From<Option<&'a str>> for Value<'a> {
    fn from(text: Option<&'a str>) -> Self {
        Self::Text(text)
    }
}

impl From<i64> for Value<'_> {
    fn from(number: i64) -> Self {
        Self::Number(Some(number))
    }
}

impl From<u32> for Value<'_> {
    fn from(number: u32) -> Self {
        Self::Number(Some(number.into()))
    }
}

/// A number larger than an engine can hold means "no bound" or "past the end", as does the largest number that it can hold.
impl From<u64> for Value<'_> {
    fn from(number: u64) -> Self {
        Self::Number(Some(i64::try_from(number).unwrap_or(i64::MAX)))
    }
}

impl From<Option<u64>> for Value<'_> {
    fn from(number: Option<u64>) -> Self {
        number.map_or(Self::Number(None), Self::from)
    }
}

/// The runs of a sweep, as they are queued.
pub(crate) struct Runs<'r> {
    pub sweep: Uuid,
    pub priority: i64,
    pub max_attempts: i64,
    /// The first run's place in the sweep, and its number in the queue; the others have the following ones.
    pub first: u64,
    pub turn: u64,
    pub owner: Option<&'r str>,
    pub runs: &'r [NewRun],
}

/// The values of a statement, in order.
macro_rules! values {
    ($($value:expr),* $(,)?) => { &[$($crate::service::store::sql::dialect::Value::from($value)),*] };
}
pub(crate) use values;

/// The columns of a row, as they are stored: ids, texts and whole numbers.
pub(crate) trait Cells: Row {
    fn id(&self, column: &str) -> sqlx::Result<Option<Uuid>>;
    fn text(&self, column: &str) -> sqlx::Result<Option<String>>;
    fn number(&self, column: &str) -> sqlx::Result<Option<i64>>;
}

pub(crate) trait Dialect: Database<Row: Cells> {
    /// Milliseconds since 1970; the same throughout a statement.
    const NOW: &'static str;
    /// The same at the moment of evaluation, which may be later, as a statement can wait for a row.
    const CLOCK: &'static str;
    /// A hint after the name of a table: use the index of waiting jobs.
    const WAITING: &'static str;
    /// Suffix of a selection: locks the rows for changes and skips rows that others have locked.
    const FREE: &'static str;
    /// Suffix of a selection: locks the rows against deletion.
    const THERE: &'static str;
    /// Suffix of the returned columns: the commit does not wait for the disk. If the server crashes, the change may be lost, together
    /// with all later ones.
    const UNSYNCED: &'static str;
    /// Begins a transaction that excludes others of the same kind.
    const IN_TURN: Option<&'static str>;
    /// Increments of job `$1` past `$2`, in order: at most `$3`, and few past `$4` bytes.
    const PAGE: &'static str;
    /// The number, `settled`, below which no change can appear any more.
    const SETTLED: &'static str;
    /// The statements of the regular upkeep.
    const SWEEP: Option<&'static str>;

    /// Runs a statement and answers its rows.
    fn rows(
        connection: &mut Self::Connection,
        statement: &str,
        values: &[Value<'_>],
    ) -> impl Future<Output = sqlx::Result<Vec<Self::Row>>> + Send;

    /// Runs a statement and answers how many rows it changed.
    fn run(
        connection: &mut Self::Connection,
        statement: &str,
        values: &[Value<'_>],
    ) -> impl Future<Output = sqlx::Result<u64>> + Send;

    /// Runs a statement and answers its rows as they come.
    fn stream<'c>(
        connection: &'c mut Self::Connection,
        statement: &str,
        values: &[Value<'_>],
    ) -> impl Stream<Item = sqlx::Result<Self::Row>> + Send + Unpin + 'c;

    /// Adds increments, and the branches stored beside them; `alternatives` are as they are stored.
    fn insert_lines(
        connection: &mut Self::Connection,
        job: Uuid,
        lines: &[Line],
    ) -> impl Future<Output = sqlx::Result<()>> + Send;

    /// Queues the runs of a sweep, in order.
    fn insert_runs(connection: &mut Self::Connection, runs: &Runs<'_>)
    -> impl Future<Output = sqlx::Result<()>> + Send;

    /// Runs a statement and answers its first row.
    fn first(
        connection: &mut Self::Connection,
        statement: &str,
        values: &[Value<'_>],
    ) -> impl Future<Output = sqlx::Result<Option<Self::Row>>> + Send {
        async move { Ok(Self::rows(connection, statement, values).await?.into_iter().next()) }
    }

    /// The statement in the dialect of this engine.
    fn said(statement: &str) -> sqlx::AssertSqlSafe<String> {
        let words = [
            ("{now}", Self::NOW),
            ("{clock}", Self::CLOCK),
            ("{waiting}", Self::WAITING),
            ("{free}", Self::FREE),
            ("{there}", Self::THERE),
            ("{unsynced}", Self::UNSYNCED),
        ];
        let mut said = statement.to_owned();
        for (word, meaning) in words {
            if said.contains(word) {
                said = said.replace(word, meaning);
            }
        }
        // Statements are composed of constants only; external input is always passed as a value.
        sqlx::AssertSqlSafe(said)
    }
}

/// Implements the parts that only differ in the types of the engines.
macro_rules! speaks {
    ($row:ty) => {
        impl $crate::service::store::sql::dialect::Cells for $row {
            fn id(&self, column: &str) -> sqlx::Result<Option<uuid::Uuid>> {
                sqlx::Row::try_get(self, column)
            }

            fn text(&self, column: &str) -> sqlx::Result<Option<String>> {
                sqlx::Row::try_get(self, column)
            }

            fn number(&self, column: &str) -> sqlx::Result<Option<i64>> {
                sqlx::Row::try_get(self, column)
            }
        }
    };
    () => {
        async fn rows(
            connection: &mut Self::Connection,
            statement: &str,
            values: &[$crate::service::store::sql::dialect::Value<'_>],
        ) -> sqlx::Result<Vec<Self::Row>> {
            $crate::service::store::sql::dialect::bound!(Self::said(statement), values).fetch_all(connection).await
        }

        async fn run(
            connection: &mut Self::Connection,
            statement: &str,
            values: &[$crate::service::store::sql::dialect::Value<'_>],
        ) -> sqlx::Result<u64> {
            let done =
                $crate::service::store::sql::dialect::bound!(Self::said(statement), values).execute(connection).await?;
            Ok(done.rows_affected())
        }

        fn stream<'c>(
            connection: &'c mut Self::Connection,
            statement: &str,
            values: &[$crate::service::store::sql::dialect::Value<'_>],
        ) -> impl tokio_stream::Stream<Item = sqlx::Result<Self::Row>> + Send + Unpin + 'c {
            $crate::service::store::sql::dialect::bound!(Self::said(statement), values).fetch(connection)
        }
    };
}
pub(crate) use speaks;

/// A query with its values.
macro_rules! bound {
    ($statement:expr, $values:expr) => {{
        let mut query = sqlx::query::<Self>($statement);
        for value in $values {
            query = match *value {
                $crate::service::store::sql::dialect::Value::Id(id) => query.bind(id),
                $crate::service::store::sql::dialect::Value::Text(text) => query.bind(text),
                $crate::service::store::sql::dialect::Value::Number(number) => query.bind(number),
            };
        }
        query
    }};
}
pub(crate) use bound;

/// The stored form of the alternatives of a line.
pub(crate) fn alternatives(alternatives: &[u64]) -> sqlx::Result<Option<String>> {
    if alternatives.is_empty() {
        return Ok(None);
    }
    serde_json::to_string(alternatives).map(Some).map_err(|error| sqlx::Error::Encode(Box::new(error)))
}
