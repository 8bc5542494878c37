//! Rows to records, and numbers to what SQLite can hold.

use crate::model::request::Explore;
use crate::store::{JobRecord, Membership, Parent, Result, Status, StoreError, Task};
use jiff::Timestamp;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// The columns [`job`] reads.
macro_rules! job_columns {
    () => {
        "id, task, owner, name, status, plan, report, stop_reason, error, max_increments, last_index, attempt, max_attempts, losses, \
         cancel_requested, created_at, started_at, ended_at, parent, parent_increment, parent_direction, \
         (SELECT count(*) FROM jobs AS child WHERE child.parent = jobs.id AND child.owner IS jobs.owner) AS children, \
         family, generation, explored, not_queued, \
         (SELECT depth FROM families WHERE families.id = jobs.family) AS depth, \
         (SELECT max_jobs FROM families WHERE families.id = jobs.family) AS max_jobs, \
         (SELECT queued FROM families WHERE families.id = jobs.family) AS family_queued, \
         (SELECT sum(not_queued) FROM jobs AS member WHERE member.family = jobs.family) AS family_not_queued"
    };
}
pub(super) use job_columns;

pub(super) fn job(row: &SqliteRow) -> Result<JobRecord> {
    Ok(JobRecord {
        id: row.try_get("id")?,
        task: task(row)?,
        owner: row.try_get("owner")?,
        name: row.try_get("name")?,
        status: status(row)?,
        plan: row.try_get("plan")?,
        report: row.try_get("report")?,
        stop_reason: row.try_get("stop_reason")?,
        error: row.try_get("error")?,
        max_increments: unsigned(row.try_get("max_increments")?)?,
        last_index: last_index(row)?,
        attempt: row.try_get("attempt")?,
        max_attempts: row.try_get("max_attempts")?,
        losses: row.try_get("losses")?,
        cancel_requested: row.try_get("cancel_requested")?,
        created_at: time(row.try_get("created_at")?)?,
        started_at: row.try_get::<Option<i64>, _>("started_at")?.map(time).transpose()?,
        ended_at: row.try_get::<Option<i64>, _>("ended_at")?.map(time).transpose()?,
        parent: parent(row)?,
        children: unsigned(row.try_get("children")?)?,
        membership: membership(row)?,
    })
}

/// Of a row with the column `status`.
pub(super) fn status(row: &SqliteRow) -> Result<Status> {
    let name: String = row.try_get("status")?;
    Status::from_name(&name).ok_or_else(|| damaged(format!("status {name:?}")))
}

/// Of a row with the column `last_index`.
pub(super) fn last_index(row: &SqliteRow) -> Result<Option<u64>> {
    row.try_get::<Option<i64>, _>("last_index")?.map(unsigned).transpose()
}

/// Of a row with the column `task`.
pub(super) fn task(row: &SqliteRow) -> Result<Task> {
    let name: String = row.try_get("task")?;
    Task::from_name(&name).ok_or_else(|| damaged(format!("task {name:?}")))
}

/// Of a row with the columns `parent`, `parent_increment` and `parent_direction`.
pub(super) fn parent(row: &SqliteRow) -> Result<Option<Parent>> {
    let Some(job) = row.try_get("parent")? else { return Ok(None) };
    let increment = unsigned(row.try_get("parent_increment")?)?;
    Ok(Some(Parent { job, increment, direction: unsigned(row.try_get("parent_direction")?)? }))
}

fn membership(row: &SqliteRow) -> Result<Option<Membership>> {
    let Some(family) = row.try_get("family")? else { return Ok(None) };
    let number = |column: &str| -> Result<u64> { unsigned(row.try_get(column)?) };
    Ok(Some(Membership {
        family,
        generation: number("generation")?,
        explore: Explore { depth: number("depth")?, max_jobs: number("max_jobs")? },
        explored: row.try_get("explored")?,
        not_queued: number("not_queued")?,
        family_queued: number("family_queued")?,
        family_not_queued: number("family_not_queued")?,
    }))
}

pub(super) fn unsigned(number: i64) -> Result<u64> {
    u64::try_from(number).map_err(|error| damaged(format!("{number}: {error}")))
}

/// Numbers past what SQLite holds only ever stand for "no bound" or "past the end", and so does the largest it holds.
pub(super) fn signed(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

fn time(milliseconds: i64) -> Result<Timestamp> {
    Timestamp::from_millisecond(milliseconds).map_err(|error| StoreError::Damaged(Box::new(error)))
}

pub(super) fn damaged(what: String) -> StoreError {
    StoreError::Damaged(what.into())
}
