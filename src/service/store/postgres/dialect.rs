//! PostgreSQL's dialect of SQL.

use crate::service::store::Line;
use crate::service::store::sql::dialect::{Dialect, Runs, alternatives, speaks};
use sqlx::postgres::{PgConnection, PgRow, Postgres};
use uuid::Uuid;

/// Rows of an INSERT of jobs, whose requests are sent together.
const ROWS_A_STATEMENT: usize = 500;

speaks!(PgRow);

impl Dialect for Postgres {
    const NOW: &'static str = "CAST(extract(epoch FROM statement_timestamp()) * 1000 AS BIGINT)";
    const CLOCK: &'static str = "CAST(extract(epoch FROM clock_timestamp()) * 1000 AS BIGINT)";
    const WAITING: &'static str = "";
    const FREE: &'static str = "FOR NO KEY UPDATE SKIP LOCKED";
    const THERE: &'static str = "FOR KEY SHARE";
    // Until the end of the transaction, which is the statement.
    const UNSYNCED: &'static str = ", set_config('synchronous_commit', 'off', true) AS unsynced";
    /// Until the end of the transaction; the number is this program's own.
    const IN_TURN: Option<&'static str> = Some("SELECT pg_advisory_xact_lock(6099041150377221921)");
    // The server sends all that it is asked for, so the bytes are counted there; what has not been sent costs it no reading.
    const PAGE: &'static str = "SELECT increment_index, body FROM (SELECT increment_index, body, \
                                sum(octet_length(body)) OVER (ORDER BY increment_index) - octet_length(body) AS before \
                                FROM increments WHERE job = $1 AND increment_index > $2 ORDER BY increment_index LIMIT $3) \
                                AS page WHERE before < $4 ORDER BY increment_index";
    const SETTLED: &'static str = "SELECT txid_snapshot_xmin(txid_current_snapshot()) AS settled";
    /// Sums up the tallies, except for rows that another process sums up at the moment; deletions are told for a day.
    const SWEEP: Option<&'static str> = Some(
        "WITH old AS (DELETE FROM deletions WHERE deleted_at < \
         CAST(extract(epoch FROM statement_timestamp()) * 1000 AS BIGINT) - 86400000), \
         told AS (DELETE FROM tallies WHERE (SELECT count(*) FROM tallies) > 100 RETURNING status, jobs) \
         INSERT INTO tallies (status, jobs) SELECT status, sum(jobs) FROM told GROUP BY status",
    );

    speaks!();

    async fn insert_lines(connection: &mut PgConnection, job: Uuid, lines: &[Line]) -> sqlx::Result<()> {
        let index = |line: &Line| line.index as i64;
        if !lines.is_empty() {
            sqlx::query(
                "INSERT INTO increments (job, increment_index, body) \
                 SELECT $1, given.* FROM unnest($2::bigint[], $3::text[]) AS given",
            )
            .bind(job)
            .bind(lines.iter().map(index).collect::<Vec<_>>())
            .bind(lines.iter().map(|line| line.body.as_str()).collect::<Vec<_>>())
            .execute(&mut *connection)
            .await?;
        }
        let at: Vec<_> = lines.iter().filter(|line| line.branch.is_some()).map(index).collect();
        if at.is_empty() {
            return Ok(());
        }
        let branches: Vec<_> = lines.iter().filter_map(|line| line.branch.as_ref()).collect();
        let others: Vec<_> =
            branches.iter().map(|branch| alternatives(&branch.alternatives)).collect::<sqlx::Result<_>>()?;
        sqlx::query(
            "INSERT INTO branches (job, increment_index, body, trail, alternatives) \
             SELECT $1, given.* FROM unnest($2::bigint[], $3::text[], $4::text[], $5::text[]) AS given",
        )
        .bind(job)
        .bind(at)
        .bind(branches.iter().map(|branch| branch.body.as_str()).collect::<Vec<_>>())
        .bind(branches.iter().map(|branch| branch.trail.as_deref()).collect::<Vec<_>>())
        .bind(others)
        .execute(connection)
        .await?;
        Ok(())
    }

    async fn insert_runs(connection: &mut PgConnection, runs: &Runs<'_>) -> sqlx::Result<()> {
        let insert = "INSERT INTO jobs (id, name, status, priority, request, plan, max_increments, max_attempts, \
                      created_at, updated_at, task, owner, sweep, sweep_run, sweep_values, class, turn, asked) \
                      SELECT given.id, given.name, 'queued', $1, given.request, given.plan, given.increments, $2, \
                      {now}, {now}, 'path', $3, $4, given.number, given.chosen, 2, $12 + given.number - $14, given.asked \
                      FROM unnest($5::uuid[], $6::text[], $7::text[], $8::text[], $9::bigint[], $10::bigint[], $11::text[], $13::text[]) \
                      AS given (id, name, request, plan, increments, number, chosen, asked)";
        for (chunk, new) in (0_i64..).zip(runs.runs.chunks(ROWS_A_STATEMENT)) {
            let before = i64::try_from(runs.first).unwrap_or(i64::MAX / 2);
            let first = before + chunk * ROWS_A_STATEMENT as i64;
            sqlx::query(Self::said(insert))
                .bind(runs.priority)
                .bind(runs.max_attempts)
                .bind(runs.owner)
                .bind(runs.sweep)
                .bind(new.iter().map(|_| Uuid::now_v7()).collect::<Vec<_>>())
                .bind(new.iter().map(|run| run.name.as_deref()).collect::<Vec<_>>())
                .bind(new.iter().map(|run| run.request.as_str()).collect::<Vec<_>>())
                .bind(new.iter().map(|run| run.plan.as_str()).collect::<Vec<_>>())
                .bind(new.iter().map(|run| run.max_increments as i64).collect::<Vec<_>>())
                .bind((first..).take(new.len()).collect::<Vec<_>>())
                .bind(new.iter().map(|run| run.values.as_str()).collect::<Vec<_>>())
                .bind(i64::try_from(runs.turn).unwrap_or(i64::MAX / 2))
                .bind(new.iter().map(|run| run.asked.as_deref()).collect::<Vec<_>>())
                .bind(before)
                .execute(&mut *connection)
                .await?;
        }
        Ok(())
    }
}
