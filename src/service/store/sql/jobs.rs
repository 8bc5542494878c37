//! The operations of clients on jobs: submit, read, list, cancel, delete.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Cells, Dialect, Value, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, reader, writer};
use crate::service::store::sql::leases;
use crate::service::store::sql::rows::{self, job_columns, listed_columns};
use crate::service::store::sql::turns::{self, Class, next_turn};
use crate::service::store::{JobRecord, Keep, ListFilter, Listed, NewJob, Retried, Standing, Status, Submitted};
use tokio_stream::StreamExt;
use uuid::Uuid;

/// The most ended jobs that are deleted at a time.
const DROPPED_AT_ONCE: u32 = 10;

/// The number of waiting jobs. Concurrent submissions do not see each other, so that the limit may be exceeded by their number.
macro_rules! waiting {
    () => {
        "(SELECT sum(jobs) FROM tallies WHERE status = 'queued')"
    };
}
pub(super) use waiting;

/// Queues a job as part of a transaction, unless its key is known or the queue is full.
pub(crate) async fn insert<D: Dialect>(connection: &mut D::Connection, job: &NewJob) -> Result<Submitted> {
    let id = Uuid::now_v7();
    let key = owned_key(job.owner.as_deref(), job.idempotency_key.as_deref());
    let class = Class::of(job.task);
    let inserted = D::first(
        connection,
        concat!(
            "INSERT INTO jobs (id, name, status, priority, request, idempotency_key, plan, max_increments, max_attempts, \
             created_at, updated_at, family, task, owner, summary, class, turn) \
             SELECT $2, $3, 'queued', $4, $5, $6, $7, $8, $9, {now}, {now}, $10, $11, $12, $13, $14, ",
            next_turn!("$4", "$12"),
            " WHERE ",
            waiting!(),
            " < $1 ON CONFLICT (idempotency_key) DO NOTHING RETURNING ",
            job_columns!(),
        ),
        values![
            job.most_queued,
            id,
            &job.name,
            i64::from(job.priority),
            &job.request,
            &key,
            &job.plan,
            job.max_increments,
            job.max_attempts,
            job.explore.map(|_| id),
            job.task.name(),
            &job.owner,
            &job.summary,
            class.number(),
        ],
    )
    .await?;
    if let Some(row) = inserted {
        turns::put_between::<D>(connection, id, class, job.priority.into(), job.owner.as_deref()).await?;
        let Some(explore) = job.explore else { return Ok(Submitted::Created(rows::job(&row)?)) };
        let insert = "INSERT INTO families (id, depth, max_jobs) VALUES ($1, $2, $3)";
        D::run(connection, insert, values![id, explore.depth, explore.max_jobs]).await?;
        return Ok(Submitted::Created(record::<D>(connection, id).await?));
    }
    let select = concat!("SELECT request, ", job_columns!(), " FROM jobs WHERE idempotency_key = $1");
    let row = D::first(connection, select, values![&key]).await?;
    let Some(row) = row else { return Ok(Submitted::QueueFull { most: job.most_queued }) };
    let record = rows::job(&row)?;
    // A job that follows another has the same request, but is another job.
    let same = record.task == job.task && record.parent.is_none() && rows::text(&row, "request")? == job.request;
    Ok(if same { Submitted::Repeated(record) } else { Submitted::KeyReused })
}

/// The stored key, which contains the owner: keys of different owners are distinct, as neither contains a line break.
pub(super) fn owned_key(owner: Option<&str>, key: Option<&str>) -> Option<String> {
    key.map(|key| owner.map_or_else(|| key.to_owned(), |owner| format!("{owner}\n{key}")))
}

/// Whether at least this many jobs wait.
pub(super) async fn is_full<D: Dialect>(connection: &mut D::Connection, most: u64) -> Result<bool> {
    let select = concat!("SELECT CAST(CASE WHEN ", waiting!(), " >= $1 THEN 1 ELSE 0 END AS BIGINT) AS is_full");
    let row = D::first(connection, select, values![most]).await?;
    row.map_or(Ok(false), |row| rows::flag(&row, "is_full"))
}

/// A job that has just been stored.
pub(super) async fn record<D: Dialect>(connection: &mut D::Connection, id: Uuid) -> Result<JobRecord> {
    let row = D::first(connection, concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = $1"), values![id]).await?;
    rows::job(&row.ok_or(sqlx::Error::RowNotFound)?)
}

pub(super) async fn get<E: Engine>(engine: &E, id: Uuid) -> Result<Option<JobRecord>> {
    let select = concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = $1");
    let row = Of::<E>::first(&mut *reader(engine).await?, select, values![id]).await?;
    row.as_ref().map(rows::job).transpose()
}

pub(super) async fn standing<E: Engine>(engine: &E, id: Uuid) -> Result<Option<Standing>> {
    let select = "SELECT task, owner, status, last_index FROM jobs WHERE id = $1";
    let row = Of::<E>::first(&mut *reader(engine).await?, select, values![id]).await?;
    let Some(row) = row else { return Ok(None) };
    let (task, status, last_index) = (rows::task(&row)?, rows::status(&row)?, rows::last_index(&row)?);
    Ok(Some(Standing { task, owner: row.text("owner")?, status, last_index }))
}

pub(super) async fn list<E: Engine>(engine: &E, filter: ListFilter) -> Result<Listed> {
    // Only the requested conditions, so that the statement can use an index.
    let mut select = concat!("SELECT ", listed_columns!(), " FROM jobs WHERE task = $1").to_owned();
    let mut values = vec![Value::from(filter.task.name())];
    let mut add = |condition: &str, value| {
        values.push(value);
        select += &format!("{condition}${}", values.len());
    };
    if let Some(parent) = filter.parent {
        add(" AND parent = ", Value::from(parent));
    }
    if let Some(sweep) = filter.sweep {
        add(" AND sweep = ", Value::from(sweep));
    }
    if let Some(status) = filter.status {
        add(" AND status = ", Value::from(status.name()));
    }
    if let Some(owner) = &filter.owner {
        add(" AND owner = ", Value::from(owner));
    }
    if let Some(before) = filter.before {
        add(" AND id < ", Value::from(before));
    }
    // One row more than requested shows whether there are further ones.
    add(" ORDER BY id DESC LIMIT ", Value::from(filter.page.rows.saturating_add(1)));
    let mut connection = reader(engine).await?;
    let mut stream = Of::<E>::stream(&mut connection, &select, &values);
    let (mut jobs, mut bytes): (Vec<JobRecord>, usize) = (Vec::new(), 0);
    while let Some(row) = stream.next().await {
        if jobs.len() >= filter.page.rows as usize || bytes >= filter.page.bytes {
            return Ok(Listed { jobs, more: true });
        }
        let job = rows::job(&row?)?;
        bytes += job.bytes();
        jobs.push(job);
    }
    Ok(Listed { jobs, more: false })
}

pub(super) async fn tally<E: Engine>(engine: &E) -> Result<Vec<(Status, u64)>> {
    let select = "SELECT status, CAST(sum(jobs) AS BIGINT) AS jobs FROM tallies GROUP BY status";
    let tallies = Of::<E>::rows(&mut *reader(engine).await?, select, values![]).await?;
    tallies.iter().map(|row| Ok((rows::status(row)?, rows::number(row, "jobs")?))).collect()
}

pub(super) async fn request_cancel<E: Engine>(engine: &E, id: Uuid) -> Result<Option<JobRecord>> {
    let row = Of::<E>::first(
        &mut *writer(engine).await?,
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now}, \
         stop_reason = CASE status WHEN 'queued' THEN 'cancelled' ELSE stop_reason END, \
         ended_at = CASE status WHEN 'queued' THEN {now} ELSE ended_at END, \
         status = CASE status WHEN 'queued' THEN 'cancelled' ELSE status END \
         WHERE id = $1 AND status IN ('queued', 'running') RETURNING sweep",
        values![id],
    )
    .await?;
    engine.signals().job_changed(id);
    leases::tell_sweep(engine, row.as_ref())?;
    get(engine, id).await
}

pub(super) async fn retry<E: Engine>(engine: &E, id: Uuid, most: u64) -> Result<Option<Retried>> {
    let mut transaction = begin(engine).await?;
    // The exploration has to process the job again.
    let again = concat!(
        "UPDATE jobs AS job SET status = 'queued', losses = 0, counted_losses = 0, cancel_requested = 0, stop_reason = NULL, \
         report = NULL, error = NULL, ended_at = NULL, explored = 0, updated_at = {now}, turn = ",
        next_turn!("job.priority", "job.owner"),
        " WHERE job.id = $1 AND job.status = 'failed' AND job.sweep IS NULL AND ",
        waiting!(),
        " < $2 RETURNING priority, owner, class"
    );
    let Some(row) = Of::<E>::first(&mut transaction, again, values![id, most]).await? else {
        give_up(transaction).await;
        let Some(job) = get(engine, id).await? else { return Ok(None) };
        let may = job.status == Status::Failed && job.run.is_none();
        return Ok(Some(if may { Retried::QueueFull { most } } else { Retried::NotRetryable(job) }));
    };
    let class = Class::numbered(rows::number(&row, "class")?);
    let (priority, owner) = (rows::signed(&row, "priority")?, row.text("owner")?);
    turns::put_between::<Of<E>>(&mut transaction, id, class, priority, owner.as_deref()).await?;
    let job = record::<Of<E>>(&mut transaction, id).await?;
    transaction.commit().await?;
    engine.signals().job_changed(id);
    engine.signals().queue_changed();
    Ok(Some(Retried::Queued(job)))
}

pub(super) async fn delete<E: Engine>(engine: &E, id: Uuid) -> Result<bool> {
    let mut transaction = begin(engine).await?;
    // Locks the family before the job, in the order of all transactions.
    let hold = "UPDATE families SET queued = queued WHERE id = (SELECT family FROM jobs WHERE id = $1)";
    Of::<E>::run(&mut transaction, hold, values![id]).await?;
    // A run of a sweep that is deleted before its end counts as cancelled, and the sweep gets a row for it.
    let end = "UPDATE jobs SET status = 'cancelled', error = 'it was deleted', ended_at = {now}, updated_at = {now}, \
               worker = NULL, lease_until = NULL WHERE id = $1 AND sweep IS NOT NULL AND status IN ('queued', 'running') \
               RETURNING sweep";
    let ended = Of::<E>::first(&mut transaction, end, values![id]).await?;
    // Of a sweep: the runs before the sweep, in the same order as at their end.
    Of::<E>::run(&mut transaction, "DELETE FROM jobs WHERE sweep = $1", values![id]).await?;
    let delete = "DELETE FROM jobs WHERE id = $1 RETURNING family";
    let deleted = Of::<E>::first(&mut transaction, delete, values![id]).await?;
    if let Some(row) = &deleted
        && let Some(family) = row.id("family")?
    {
        // The family is deleted with its last job.
        let last = "DELETE FROM families WHERE id = $1 AND NOT EXISTS (SELECT 1 FROM jobs WHERE family = $1)";
        Of::<E>::run(&mut transaction, last, values![family]).await?;
    }
    transaction.commit().await?;
    engine.signals().job_changed(id);
    leases::tell_sweep(engine, ended.as_ref())?;
    Ok(deleted.is_some())
}

pub(super) async fn retire<E: Engine>(engine: &E, keep: Keep) -> Result<u64> {
    let (select, bound) = match keep {
        Keep::For(length) => (
            "SELECT id FROM jobs WHERE ended_at < {now} - $1 AND (family IS NULL OR explored = 1) \
             ORDER BY ended_at LIMIT $2",
            leases::milliseconds(length),
        ),
        Keep::Newest(count) => (
            "SELECT id FROM jobs WHERE ended_at IS NOT NULL AND (family IS NULL OR explored = 1) \
             ORDER BY ended_at DESC LIMIT $2 OFFSET $1",
            Value::from(count),
        ),
    };
    let found = Of::<E>::rows(&mut *reader(engine).await?, select, &[bound, Value::from(DROPPED_AT_ONCE)]).await?;
    let mut dropped = 0;
    for row in found {
        dropped += u64::from(delete(engine, rows::id(&row, "id")?).await?);
    }
    Ok(dropped)
}

pub(super) async fn probe<E: Engine>(engine: &E) -> Result<()> {
    let beat = "INSERT INTO heartbeat (id, beat_at) VALUES (1, {now}) ON CONFLICT (id) DO UPDATE SET beat_at = excluded.beat_at";
    Of::<E>::run(&mut *writer(engine).await?, beat, values![]).await?;
    Ok(())
}
