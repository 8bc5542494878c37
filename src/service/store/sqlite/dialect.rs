//! SQLite's dialect of SQL.

use crate::service::store::Line;
use crate::service::store::sql::dialect::{Dialect, Runs, alternatives, speaks, values};
use sqlx::QueryBuilder;
use sqlx::sqlite::{Sqlite, SqliteConnection, SqliteRow};
use uuid::Uuid;

/// Rows of one INSERT: at most five values each, far below SQLite's bound of 32,766 parameters.
const ROWS_A_STATEMENT: usize = 500;

speaks!(SqliteRow);

impl Dialect for Sqlite {
    // Rounded to a millisecond, as the fraction from SQLite is not exact.
    const NOW: &'static str = "CAST(round(unixepoch('now', 'subsec') * 1000) AS INTEGER)";
    const CLOCK: &'static str = Self::NOW;
    const WAITING: &'static str = "INDEXED BY jobs_waiting";
    // SQLite has one writer at a time.
    const FREE: &'static str = "";
    const THERE: &'static str = "";
    const UNSYNCED: &'static str = "";
    const IN_TURN: Option<&'static str> = None;
    // Rows are read ahead, so that their bytes are summed up first, from their lengths alone.
    const PAGE: &'static str = "SELECT increment_index, body FROM increments WHERE job = $1 AND increment_index > $2 \
                                AND increment_index <= (SELECT max(increment_index) FROM (SELECT increment_index, \
                                sum(bytes) OVER (ORDER BY increment_index ROWS UNBOUNDED PRECEDING) - bytes AS before \
                                FROM (SELECT increment_index, octet_length(body) AS bytes FROM increments WHERE job = $1 \
                                AND increment_index > $2 ORDER BY increment_index LIMIT $3)) WHERE before < $4) \
                                ORDER BY increment_index LIMIT $3";
    // Writers take turns, so that changes appear in the order of their numbers.
    const SETTLED: &'static str = "SELECT latest + 1 AS settled FROM change_count";
    /// Deletions are told for a day.
    const SWEEP: Option<&'static str> =
        Some("DELETE FROM deletions WHERE deleted_at < CAST(unixepoch('now', 'subsec') * 1000 AS INTEGER) - 86400000");

    speaks!();

    async fn insert_lines(connection: &mut SqliteConnection, job: Uuid, lines: &[Line]) -> sqlx::Result<()> {
        for lines in lines.chunks(ROWS_A_STATEMENT) {
            let mut insert = QueryBuilder::<Self>::new("INSERT INTO increments (job, increment_index, body) ");
            insert.push_values(lines, |mut row, line| {
                row.push_bind(job).push_bind(line.index as i64).push_bind(line.body.as_str());
            });
            insert.build().execute(&mut *connection).await?;
            let mut branches = Vec::new();
            for line in lines {
                if let Some(branch) = &line.branch {
                    branches.push((line.index, branch, alternatives(&branch.alternatives)?));
                }
            }
            if branches.is_empty() {
                continue;
            }
            let mut insert =
                QueryBuilder::<Self>::new("INSERT INTO branches (job, increment_index, body, trail, alternatives) ");
            insert.push_values(branches, |mut row, (index, branch, alternatives)| {
                row.push_bind(job).push_bind(index as i64).push_bind(branch.body.as_str());
                row.push_bind(branch.trail.as_deref()).push_bind(alternatives);
            });
            insert.build().execute(&mut *connection).await?;
        }
        Ok(())
    }

    async fn insert_runs(connection: &mut SqliteConnection, runs: &Runs<'_>) -> sqlx::Result<()> {
        let insert = "INSERT INTO jobs (id, name, status, priority, request, plan, max_increments, max_attempts, created_at, updated_at, \
             task, owner, sweep, sweep_run, sweep_values, class, turn, asked) \
             VALUES ($1, $2, 'queued', $3, $4, $5, $6, $7, {now}, {now}, 'path', $8, $9, $10, $11, 2, $12, $13)";
        for (number, run) in (0_u64..).zip(runs.runs) {
            Self::run(
                connection,
                insert,
                values![
                    Uuid::now_v7(),
                    &run.name,
                    runs.priority,
                    &run.request,
                    &run.plan,
                    run.max_increments,
                    runs.max_attempts,
                    runs.owner,
                    runs.sweep,
                    runs.first + number,
                    &run.values,
                    runs.turn + number,
                    &run.asked,
                ],
            )
            .await?;
        }
        Ok(())
    }
}
