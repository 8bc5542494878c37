//! The real program with its clock stopped: a process that holds a job is halted (SIGSTOP) for longer than its lease, another
//! one takes the job up and ends it, and the first goes on (SIGCONT) as if no time had passed. It must write nothing.

use crate::common::process::{Process, client, get, has_ended, lines, solved, submit, until};
use crate::common::reader::{Format, Reader, Said};
use crate::common::service::{in_short_steps, without_elapsed};
use serde_json::json;
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqlitePool};
use std::path::Path;
use std::time::Duration;

const ARGUMENTS: [&str; 6] = ["--workers", "1", "--lease", "600ms", "--max-attempts", "50"];
/// Moments at which the clock is stopped: with nothing stored yet, soon after, and further on.
const MOMENTS: [u64; 4] = [1, 40, 700, 3000];

/// A process that is stopped in the middle of a write keeps the database's lock, and nobody else can write until it goes on:
/// it is let go, and stopped a moment later.
async fn stop_between_writes(process: &Process, database: &Path) {
    let options = SqliteConnectOptions::new().filename(database).busy_timeout(Duration::from_millis(20));
    let mut connection = SqliteConnection::connect_with(&options).await.expect("a connection");
    loop {
        process.stop();
        if sqlx::query("BEGIN IMMEDIATE").execute(&mut connection).await.is_ok() {
            sqlx::query("ROLLBACK").execute(&mut connection).await.expect("rolled back");
            return;
        }
        process.go_on();
        tokio::time::sleep(Duration::from_millis(3)).await;
    }
}

/// Everything that a late write could change, as the database has it.
async fn rows(database: &Path) -> Vec<String> {
    let options = SqliteConnectOptions::new().filename(database).read_only(true);
    let pool = SqlitePool::connect_with(options).await.expect("a pool");
    let rows = sqlx::query_scalar(
        "SELECT 'job ' || hex(id) || status || attempt || losses || last_index || stored_bytes || ran_ms || updated_at \
         || coalesce(report, '') || coalesce(error, '') FROM jobs \
         UNION ALL SELECT 'increment ' || hex(job) || increment_index || body FROM increments \
         UNION ALL SELECT 'branch ' || hex(job) || increment_index || body FROM branches \
         UNION ALL SELECT 'checkpoint ' || hex(job) || increment_index FROM checkpoints",
    )
    .fetch_all(&pool)
    .await
    .expect("rows");
    pool.close().await;
    rows
}

#[tokio::test(flavor = "multi_thread")]
async fn a_process_that_was_stopped_for_longer_than_its_lease_writes_nothing_and_goes_on_serving() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let request = in_short_steps("one-bar-truss", 5000, 1700);
    let strip = |lines: &[String]| lines.iter().map(|line| without_elapsed(line)).collect::<Vec<_>>();
    let expected = strip(&solved(&request));
    let client = client();
    let mut stopped_in_the_middle = 0;
    for moment in MOMENTS {
        let first = Process::serve(&database, &ARGUMENTS);
        let id = submit(&client, &first.url, "/v1/jobs", &request).await;
        let place = format!("/v1/jobs/{id}");
        let reader = Reader::open(&client, &first.url, &id, Format::Events, None).await;
        until(&client, &first.url, &place, |job| job["progress"]["increments"].as_u64() >= Some(moment)).await;
        stop_between_writes(&first, &database).await;
        let second = Process::serve(&database, &ARGUMENTS);
        let at_stop = get(&client, &second.url, &place).await.expect("the job");
        stopped_in_the_middle += u32::from(!has_ended(&at_stop));
        let job = until(&client, &second.url, &place, has_ended).await;
        assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
        let written = rows(&database).await;

        first.go_on();
        // Long enough for a heartbeat, a sweep, and whatever it had under way.
        tokio::time::sleep(Duration::from_millis(1200)).await;
        assert_eq!(rows(&database).await, written, "stopped after {moment}: written late");
        let found = strip(&lines(&client, &second.url, &id).await);
        assert_eq!(found, expected, "stopped after {moment}");
        assert_eq!(get(&client, &first.url, &place).await, get(&client, &second.url, &place).await);

        // The stream that was open at the first goes on to the end, each increment once.
        assert_eq!(strip(&read_to_the_end(reader).await), expected, "a stream of the process that was stopped");
        assert_eq!(get(&client, &first.url, "/readyz").await.expect("an answer")["workers"], 1);
        second.kill();
        let next = submit(&client, &first.url, "/v1/jobs", &request).await;
        let job = until(&client, &first.url, &format!("/v1/jobs/{next}"), has_ended).await;
        assert_eq!((&job["attempt"], &job["losses"]), (&json!(1), &json!(0)), "{job}");
        assert_eq!(strip(&lines(&client, &first.url, &next).await), expected, "the first takes jobs as before");
        first.kill();
    }
    assert!(stopped_in_the_middle >= 2, "the stops hit nothing");
}

async fn read_to_the_end(mut reader: Reader) -> Vec<String> {
    let mut lines = Vec::new();
    loop {
        match reader.next().await {
            Said::Increment(index, body) => {
                assert_eq!(index, lines.len() as u64);
                lines.push(body);
            }
            Said::End => return lines,
            Said::BrokenOff => panic!("it broke off after {}", lines.len()),
        }
    }
}
