//! Jobs that follow a direction of another job, and the checkpoints from which they begin.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Cells, Dialect, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, reader};
use crate::service::store::sql::jobs::{self, waiting};
use crate::service::store::sql::rows::{self, job_columns};
use crate::service::store::sql::turns::{self, Class, next_turn};
use crate::service::store::{NewFollower, Origin, Parent, Submitted};
use uuid::Uuid;

/// The position of a job in a family.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub family: Uuid,
    pub number: u64,
    pub generation: u64,
}

/// The trail up to increment `$2` of job `$1`; `$3` is a line break.
macro_rules! passed {
    () => {
        "(SELECT string_agg(trail, $3 ORDER BY increment_index) FROM branches WHERE job = $1 AND increment_index <= $2)"
    };
}

pub(super) async fn follow<E: Engine>(engine: &E, job: NewFollower) -> Result<Option<Submitted>> {
    let mut transaction = begin(engine).await?;
    if let Some(id) = insert::<Of<E>>(&mut transaction, &job, None).await? {
        let record = jobs::record::<Of<E>>(&mut transaction, id).await?;
        transaction.commit().await?;
        engine.signals().queue_changed();
        return Ok(Some(Submitted::Created(record)));
    }
    let known = Of::<E>::first(
        &mut transaction,
        concat!("SELECT ", job_columns!(), " FROM jobs WHERE idempotency_key = $1"),
        values![&jobs::owned_key(job.owner.as_deref(), job.idempotency_key.as_deref())],
    )
    .await?;
    let full = jobs::is_full::<Of<E>>(&mut transaction, job.most_queued).await?;
    give_up(transaction).await;
    let Some(known) = known else {
        return Ok(full.then_some(Submitted::QueueFull { most: job.most_queued }));
    };
    let record = rows::job(&known)?;
    let same_length = job.max_increments.is_none_or(|asked| asked == record.max_increments);
    let same = record.parent == Some(job.parent) && same_length;
    Ok(Some(if same { Submitted::Repeated(record) } else { Submitted::KeyReused }))
}

/// Queues a job that follows another, with a copy of the branch, so that the other job can be deleted. `None`: the key is
/// taken, there is no such branch, or the queue is full.
pub(super) async fn insert<D: Dialect>(
    connection: &mut D::Connection,
    job: &NewFollower,
    place: Option<Place>,
) -> Result<Option<Uuid>> {
    let Parent { job: parent, increment, direction } = job.parent;
    let (id, key) = (Uuid::now_v7(), jobs::owned_key(job.owner.as_deref(), job.idempotency_key.as_deref()));
    // Locks the parent, so that it is not deleted meanwhile.
    let class = if place.is_some() { Class::Many } else { Class::Single };
    let inserted = D::first(
        connection,
        concat!(
            "INSERT INTO jobs (id, name, status, priority, request, idempotency_key, plan, max_increments, max_attempts, \
             created_at, updated_at, parent, parent_increment, parent_direction, family, family_number, generation, owner, class, turn) \
             SELECT $2, name, 'queued', priority, request, $3, plan, coalesce($4, max_increments), max_attempts, \
             {now}, {now}, id, $5, $6, $7, $8, $9, coalesce($11, owner), $12, ",
            next_turn!("parent.priority", "coalesce($11, parent.owner)"),
            " FROM jobs AS parent WHERE id = $10 AND EXISTS (SELECT 1 FROM branches WHERE job = $10 AND increment_index <= $5) AND ",
            waiting!(),
            " < $1 {there} ON CONFLICT (idempotency_key) DO NOTHING RETURNING priority, owner",
        ),
        values![
            job.most_queued,
            id,
            &key,
            job.max_increments,
            increment,
            direction,
            place.map(|place| place.family),
            place.map_or(0, |place| place.number),
            place.map_or(0, |place| place.generation),
            parent,
            &job.owner,
            class.number(),
        ],
    )
    .await?;
    let Some(row) = inserted else { return Ok(None) };
    let (priority, owner) = (rows::signed(&row, "priority")?, row.text("owner")?);
    turns::put_between::<D>(connection, id, class, priority, owner.as_deref()).await?;
    let copied = concat!(
        "INSERT INTO origins (job, body, trail) SELECT $4, body, ",
        passed!(),
        " FROM branches WHERE job = $1 AND increment_index <= $2 ORDER BY increment_index DESC LIMIT 1"
    );
    D::run(connection, copied, values![parent, increment, "\n", id]).await?;
    Ok(Some(id))
}

pub(super) async fn request<E: Engine>(engine: &E, id: Uuid) -> Result<Option<String>> {
    let select = "SELECT request FROM jobs WHERE id = $1";
    let row = Of::<E>::first(&mut *reader(engine).await?, select, values![id]).await?;
    row.map(|row| rows::text(&row, "request")).transpose()
}

pub(super) async fn branch<E: Engine>(engine: &E, id: Uuid, increment: u64) -> Result<Option<Origin>> {
    let select = concat!(
        "SELECT body, ",
        passed!(),
        " AS trail FROM branches WHERE job = $1 AND increment_index <= $2 ORDER BY increment_index DESC LIMIT 1"
    );
    let row = Of::<E>::first(&mut *reader(engine).await?, select, values![id, increment, "\n"]).await?;
    row.map(|row| rows::origin(&row)).transpose()
}

pub(super) async fn origin<D: Dialect>(connection: &mut D::Connection, id: Uuid) -> Result<Origin> {
    let row = D::first(connection, "SELECT body, trail FROM origins WHERE job = $1", values![id]).await?;
    let row = row.ok_or_else(|| rows::damaged(format!("job {id} follows another, and where it begins is missing")))?;
    rows::origin(&row)
}
