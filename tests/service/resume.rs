//! A job that was put down goes on from its checkpoint: nothing is computed twice, and nothing shows that it was put down.

use crate::common::server::{TestServer, settings};
use crate::common::service::{in_short_steps, scene, without_elapsed};
use crate::common::watched::Watched;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use std::path::Path;

/// Increments, where alternatives are followed from, a job that follows one of the last directions, and the report, without
/// times.
#[derive(Debug, PartialEq)]
struct Stored {
    lines: Vec<String>,
    alternatives: Vec<(i64, String)>,
    followed: Vec<String>,
    report: Value,
}

async fn stored(server: &TestServer, database: &Path, id: &str) -> Stored {
    let mut job = server.ended(id).await;
    assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(database)).await.expect("a pool");
    let alternatives: Vec<(i64, String)> = sqlx::query_as(
        "SELECT increment_index, alternatives FROM branches WHERE job = ? AND alternatives IS NOT NULL \
         ORDER BY increment_index",
    )
    .bind(id.parse::<uuid::Uuid>().expect("an id"))
    .fetch_all(&pool)
    .await
    .expect("branches");
    pool.close().await;
    job["report"]["elapsed_s"].take();
    let lines: Vec<String> = server.lines(id).await.iter().map(|line| without_elapsed(line)).collect();
    let followed = match last_other_direction(&lines) {
        Some(body) => {
            let answer = server.post(&format!("/v1/jobs/{id}/follow"), &body).await;
            let child: Value = answer.json().await.expect("JSON");
            let child = child["id"].as_str().unwrap_or_else(|| panic!("{child}")).to_owned();
            server.ended(&child).await;
            let event = format!("of job {id}");
            server.lines(&child).await.iter().map(|line| without_elapsed(line).replace(&event, "")).collect()
        }
        None => Vec::new(),
    };
    Stored { lines, alternatives, followed, report: job["report"].take() }
}

/// What follows a direction of the last increment but some that has another than the one taken.
fn last_other_direction(lines: &[String]) -> Option<Value> {
    let increments = lines.iter().map(|line| serde_json::from_str::<Value>(&line.replace(":?", ":0")).expect("JSON"));
    let found = increments.filter_map(|one| {
        let directions = one["directions"].as_array()?;
        let is_other = |one: &Value| one["taken"] == false && one["retrace"] != true && one["mechanism"] != true;
        let other = directions.iter().position(is_other)?;
        Some(json!({"increment": one["index"], "direction": other, "max_increments": 40}))
    });
    let found: Vec<Value> = found.collect();
    found.len().checked_sub(4).map(|place| found[place].clone())
}

/// Puts a job down after some increments and lets another process go on with it; `tamper` sees the database between.
async fn put_down_and_go_on(
    folder: &Path,
    request: &Value,
    after: u64,
    tamper: &[&'static str],
) -> (Watched, TestServer, std::path::PathBuf, String) {
    let database = folder.join(format!("{after}.db"));
    // At a row.
    let after = after.next_multiple_of(request["analysis"]["record"]["every"].as_u64().unwrap_or(1));
    let solver = Watched::holding_after(after);
    let server = TestServer::start(&database, solver.clone()).await;
    let id = server.submit(request).await;
    server.until(&id, |job| job["progress"]["last_index"].as_u64() >= Some(after)).await;
    assert!(server.stop().await);
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(&database)).await.expect("a pool");
    for statement in tamper {
        sqlx::query(*statement).execute(&pool).await.expect("done");
    }
    pool.close().await;
    solver.let_go();
    let server = TestServer::start(&database, solver.clone()).await;
    (solver, server, database, id)
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_stored_is_what_an_undisturbed_run_stores() {
    let folder = tempfile::tempdir().expect("a folder");
    let exploring = |name: &str| {
        let mut request = in_short_steps(name, 200, 60);
        request["analysis"]["explore"] = json!({"depth": 1, "max_jobs": 3});
        request
    };
    let mut sparse = in_short_steps("two-snapping-bars", 600, 200);
    sparse["analysis"]["record"] = json!({"every": 5, "nodes": ["tip0"]});
    for (request, cuts) in [
        (exploring("one-bar-truss"), vec![0.0, 0.2, 0.6, 0.95]),
        (exploring("klarbring"), vec![0.05, 0.5]),
        (sparse, vec![0.1, 0.7]),
        (scene("three-snapping-bars"), vec![0.01, 0.3, 0.6, 0.9]),
        (scene("curving-slip"), vec![0.5]),
        (scene("turning-drag"), vec![0.6]),
        (scene("closed-loop"), vec![0.4]),
    ] {
        let name = request["model"]["name"].clone();
        let database = folder.path().join("undisturbed.db");
        let server = TestServer::start(&database, Watched::default()).await;
        let id = server.submit(&request).await;
        let expected = stored(&server, &database, &id).await;
        assert!(server.stop().await);
        for share in cuts {
            let last = serde_json::from_str::<Value>(
                expected.lines.last().expect("a line").as_str().replace(":?", ":0").as_str(),
            );
            let after = (share * last.expect("JSON")["index"].as_f64().expect("an index")) as u64;
            let (solver, server, database, id) = put_down_and_go_on(folder.path(), &request, after, &[]).await;
            server.ended(&id).await;
            let last_stored =
                expected.lines.len() as u64 * request["analysis"]["record"]["every"].as_u64().unwrap_or(1);
            {
                let seen = solver.seen();
                let at = *seen.resumed.first().expect("taken up");
                // On a machine that is busy elsewhere the last checkpoint may be some way back.
                assert!(at <= last_stored, "{name}: taken up at {at}, past {last_stored}");
                let twice = seen.computed.iter().any(|index| *index <= at);
                // Of a family others run too.
                assert!(!twice || !request["analysis"]["explore"].is_null(), "{name}: computed twice");
            }
            let found = stored(&server, &database, &id).await;
            let lines = expected.lines.len();
            assert!(found == expected, "{name}, put down after {after}; {lines} lines");
            assert!(server.stop().await);
            std::fs::remove_file(database).expect("removed");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_another_version_put_down_is_traced_from_the_start_and_not_stored_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let request = scene("three-snapping-bars");
    for (after, tamper) in [
        (40, "UPDATE checkpoints SET body = replace(body, '\"path\":{\"version\":', '\"path\":{\"version\":9')"),
        (41, "UPDATE checkpoints SET body = '{\"of\":\"a later version\"}'"),
        (42, "INSERT INTO checkpoint_trails SELECT job, 0, 'what is this' FROM checkpoints"),
        // None that was stored in time.
        (43, "DELETE FROM checkpoints"),
    ] {
        let (solver, server, database, id) = put_down_and_go_on(folder.path(), &request, after, &[tamper]).await;
        server.ended(&id).await;
        assert_eq!(solver.starts(), (1, 0), "{tamper}");
        let found = stored(&server, &database, &id).await;
        let undisturbed = server.submit(&request).await;
        assert!(found == stored(&server, &database, &undisturbed).await, "{tamper}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_path_that_comes_out_otherwise_is_not_patched_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let tamper = [
        "DELETE FROM checkpoints",
        "UPDATE increments SET body = replace(body, '\"arc_length\":', '\"arc_length\":1') WHERE increment_index = 20",
    ];
    let (_, server, _, id) = put_down_and_go_on(folder.path(), &scene("three-snapping-bars"), 20, &tamper).await;
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["progress"]["last_index"]), (&json!("failed"), &json!(20)), "{job}");
    let error = job["error"].as_str().expect("a text");
    assert!(error.contains("increment 20") && error.contains("post the job anew"), "{error}");
    assert_eq!(server.lines(&id).await.len(), 21, "what is stored stands");
}

/// Between two rows there may be days.
#[tokio::test(flavor = "multi_thread")]
async fn a_path_of_which_little_is_recorded_is_put_down_between_its_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut request = in_short_steps("one-bar-truss", 200, 60);
    request["analysis"]["record"] = json!({"every": 1_000_000});
    let expected = {
        let database = folder.path().join("undisturbed.db");
        let server = TestServer::start(&database, Watched::default()).await;
        let id = server.submit(&request).await;
        stored(&server, &database, &id).await
    };
    let rows: Vec<u64> = expected
        .lines
        .iter()
        .map(|line| serde_json::from_str::<Value>(&line.replace(":?", ":0")).expect("JSON")["index"].as_u64())
        .collect::<Option<_>>()
        .expect("indices");
    let between = rows.windows(2).map(|pair| (pair[0], pair[1])).find(|(one, next)| next - one > 8);
    let (before, next) = between.expect("a long way between two rows");

    let database = folder.path().join("jobs.db");
    let solver = Watched::holding_after(before + 5);
    let server = TestServer::start(&database, solver.clone()).await;
    let id = server.submit(&request).await;
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(&database)).await.expect("a pool");
    loop {
        let at: Option<i64> = sqlx::query_scalar("SELECT max(increment_index) FROM checkpoints")
            .fetch_one(&pool)
            .await
            .expect("an index");
        if at >= Some(before as i64 + 5) {
            break;
        }
        tokio::time::sleep(std::time::Duration::from_millis(10)).await;
    }
    pool.close().await;
    assert_eq!(server.get_json(&format!("/v1/jobs/{id}")).await["progress"]["last_index"], before);
    assert!(server.stop().await);
    solver.let_go();
    let server = TestServer::start(&database, solver.clone()).await;
    assert!(stored(&server, &database, &id).await == expected);
    let at = solver.seen().resumed[0];
    assert!((before + 5..next).contains(&at), "taken up at {at}, the rows being {before} and {next}");
}

/// Nobody can put this method's paths down: they are traced once more, and `elapsed_s` counts both times.
#[tokio::test(flavor = "multi_thread")]
async fn a_path_that_cannot_be_put_down_is_traced_once_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut request = scene("klarbring");
    request["analysis"]["method"] = json!("regularised");
    let (solver, server, database, id) = put_down_and_go_on(folder.path(), &request, 8, &[]).await;
    server.ended(&id).await;
    assert_eq!(solver.starts(), (1, 0));
    let found = stored(&server, &database, &id).await;
    let undisturbed = server.submit(&request).await;
    assert!(found == stored(&server, &database, &undisturbed).await);
    let times = server.lines(&id).await.into_iter().map(|line| {
        serde_json::from_str::<Value>(&line).expect("JSON")["diagnostics"]["elapsed_s"].as_f64().expect("a time")
    });
    assert!(times.is_sorted());
}

/// A model whose states are many: the trail is stored in parts, each once.
#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_is_put_down_again_and_again_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let request = scene("three-snapping-bars");
    let solver = Watched::holding_after(3);
    let server = TestServer::start(&database, solver.clone()).await;
    let undisturbed = {
        let elsewhere = folder.path().join("undisturbed.db");
        let server = TestServer::start(&elsewhere, Watched::default()).await;
        let id = server.submit(&request).await;
        stored(&server, &elsewhere, &id).await
    };
    let id = server.submit(&request).await;
    let mut server = Some(server);
    for after in (3..undisturbed.lines.len() as u64 - 2).step_by(16) {
        *solver.hold_after.lock().expect("a lock") = Some(after);
        let now = match server.take() {
            Some(server) => server,
            None => TestServer::start_with(&database, solver.clone(), settings()).await,
        };
        now.until(&id, |job| job["progress"]["last_index"].as_u64() >= Some(after)).await;
        assert!(now.stop().await);
    }
    solver.let_go();
    let server = TestServer::start(&database, solver.clone()).await;
    assert!(stored(&server, &database, &id).await == undisturbed);
    let job = server.ended(&id).await;
    assert_eq!((&job["attempt"], &job["losses"]), (&json!(1), &json!(0)));
}
