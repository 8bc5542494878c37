//! Reads records from rows.

use crate::model::request::Explore;
use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::Cells;
use crate::service::store::{JobRecord, Membership, Origin, Parent, RunOf, Status, StoreError, Task};
use jiff::Timestamp;
use std::time::Duration;
use uuid::Uuid;

/// The columns that [`job`] reads.
macro_rules! job_columns {
    () => {
        $crate::service::store::sql::rows::job_columns!("name, plan, report, error")
    };
    // The columns that can be large, in the given form.
    ($large:literal) => {
        concat!($large, ", id, task, owner, status, stop_reason, max_increments, last_index, attempt, max_attempts, losses, counted_losses, \
         cancel_requested, created_at, started_at, ended_at, sweep, sweep_run, parent, parent_increment, parent_direction, \
         (SELECT count(*) FROM jobs AS child WHERE child.parent = jobs.id AND child.owner IS NOT DISTINCT FROM jobs.owner) \
         AS children, family, generation, explored, not_queued, \
         (SELECT depth FROM families WHERE families.id = jobs.family) AS depth, \
         (SELECT max_jobs FROM families WHERE families.id = jobs.family) AS max_jobs, \
         (SELECT queued FROM families WHERE families.id = jobs.family) AS family_queued, \
         (SELECT CAST(sum(not_queued) AS BIGINT) FROM jobs AS member WHERE member.family = jobs.family) AS family_not_queued")
    };
}
pub(super) use job_columns;

/// The same columns for lists, each of bounded size, without those that lists do not show. Sweeps stored by versions without
/// summaries show their plan if it is short.
macro_rules! listed_columns {
    () => {
        $crate::service::store::sql::rows::job_columns!(
            "substr(name, 1, 200) AS name, substr(error, 1, 1000) AS error, CASE WHEN task = 'path' THEN report END AS report, \
             coalesce(summary, CASE WHEN task <> 'sweep' OR octet_length(plan) <= 16384 THEN plan END, '{}') AS plan"
        )
    };
}
pub(super) use listed_columns;

pub(super) fn job(row: &impl Cells) -> Result<JobRecord> {
    Ok(JobRecord {
        id: id(row, "id")?,
        task: task(row)?,
        owner: row.text("owner")?,
        name: row.text("name")?,
        status: status(row)?,
        plan: text(row, "plan")?,
        report: row.text("report")?,
        stop_reason: row.text("stop_reason")?,
        error: row.text("error")?,
        max_increments: number(row, "max_increments")?,
        last_index: last_index(row)?,
        attempt: count(row, "attempt")?,
        max_attempts: count(row, "max_attempts")?,
        losses: count(row, "losses")?,
        counted_losses: count(row, "counted_losses")?,
        cancel_requested: flag(row, "cancel_requested")?,
        created_at: time(there(row.number("created_at")?, "created_at")?)?,
        started_at: row.number("started_at")?.map(time).transpose()?,
        ended_at: row.number("ended_at")?.map(time).transpose()?,
        run: run(row)?,
        parent: parent(row)?,
        children: number(row, "children")?,
        membership: membership(row)?,
    })
}

/// Reads the column `status` of a row.
pub(super) fn status(row: &impl Cells) -> Result<Status> {
    let name = text(row, "status")?;
    Status::from_name(&name).ok_or_else(|| damaged(format!("status {name:?}")))
}

/// Reads the column `last_index` of a row.
pub(super) fn last_index(row: &impl Cells) -> Result<Option<u64>> {
    row.number("last_index")?.map(unsigned).transpose()
}

/// Reads the column `task` of a row.
pub(super) fn task(row: &impl Cells) -> Result<Task> {
    let name = text(row, "task")?;
    Task::from_name(&name).ok_or_else(|| damaged(format!("task {name:?}")))
}

/// Reads a row with the columns `parent`, `parent_increment` and `parent_direction`.
pub(super) fn parent(row: &impl Cells) -> Result<Option<Parent>> {
    let Some(job) = row.id("parent")? else { return Ok(None) };
    let increment = number(row, "parent_increment")?;
    Ok(Some(Parent { job, increment, direction: number(row, "parent_direction")? }))
}

/// Reads a row with the columns `body` and `trail`.
pub(super) fn origin(row: &impl Cells) -> Result<Origin> {
    Ok(Origin { body: text(row, "body")?, trail: row.text("trail")?.unwrap_or_default() })
}

fn run(row: &impl Cells) -> Result<Option<RunOf>> {
    let Some(sweep) = row.id("sweep")? else { return Ok(None) };
    Ok(Some(RunOf { sweep, run: number(row, "sweep_run")? }))
}

fn membership(row: &impl Cells) -> Result<Option<Membership>> {
    let Some(family) = row.id("family")? else { return Ok(None) };
    Ok(Some(Membership {
        family,
        generation: number(row, "generation")?,
        explore: Explore { depth: number(row, "depth")?, max_jobs: number(row, "max_jobs")? },
        explored: flag(row, "explored")?,
        not_queued: number(row, "not_queued")?,
        family_queued: number(row, "family_queued")?,
        family_not_queued: number(row, "family_not_queued")?,
    }))
}

pub(super) fn id(row: &impl Cells, column: &str) -> Result<Uuid> {
    there(row.id(column)?, column)
}

pub(super) fn text(row: &impl Cells, column: &str) -> Result<String> {
    there(row.text(column)?, column)
}

pub(super) fn number(row: &impl Cells, column: &str) -> Result<u64> {
    unsigned(there(row.number(column)?, column)?)
}

pub(super) fn signed(row: &impl Cells, column: &str) -> Result<i64> {
    there(row.number(column)?, column)
}

pub(super) fn count(row: &impl Cells, column: &str) -> Result<u32> {
    let number = number(row, column)?;
    u32::try_from(number).map_err(|error| damaged(format!("{column} {number}: {error}")))
}

pub(super) fn flag(row: &impl Cells, column: &str) -> Result<bool> {
    Ok(there(row.number(column)?, column)? != 0)
}

pub(super) fn milliseconds(row: &impl Cells, column: &str) -> Result<Duration> {
    Ok(Duration::from_millis(number(row, column)?))
}

fn there<T>(value: Option<T>, column: &str) -> Result<T> {
    value.ok_or_else(|| damaged(format!("{column} is missing")))
}

fn unsigned(number: i64) -> Result<u64> {
    u64::try_from(number).map_err(|error| damaged(format!("{number}: {error}")))
}

fn time(milliseconds: i64) -> Result<Timestamp> {
    Timestamp::from_millisecond(milliseconds).map_err(|error| StoreError::Damaged(Box::new(error)))
}

pub(super) fn damaged(what: String) -> StoreError {
    StoreError::Damaged(what.into())
}
