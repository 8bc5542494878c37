//! Sweeps over HTTP: many jobs in one request, their rows as they end, table and picture, cancel and delete.

use crate::common::server::{TestServer, settings};
use crate::common::service::scene;
use crate::common::solver::MadeUp;
use arcslip::service::jobs::{Limits, PathSolver, Settings};
use reqwest::Method;
use serde_json::{Value, json};
use std::time::Duration;

const FRICTION: &str = "/model/contacts/0/friction";

fn sweep(replace: Value) -> Value {
    let mut request = scene("one-bar-truss");
    request["sweep"] = json!({ "replace": replace });
    request
}

async fn submitted(server: &TestServer, request: &Value) -> String {
    let answer = server.post("/v1/sweeps", request).await;
    assert_eq!(answer.status(), 202);
    let place = answer.headers()["location"].to_str().expect("text").to_owned();
    let sweep: Value = answer.json().await.expect("a sweep");
    assert_eq!(sweep["links"]["self"], place.as_str());
    place
}

async fn ended(server: &TestServer, place: &str) -> Value {
    for _ in 0..1000 {
        let sweep = server.get_json(place).await;
        if !sweep["ended_at"].is_null() {
            return sweep;
        }
        assert_eq!(sweep["status"], "running", "{sweep}");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    panic!("the sweep does not end");
}

async fn text(server: &TestServer, place: &str) -> String {
    let answer = server.get(place).await;
    assert_eq!(answer.status(), 200, "{place}");
    answer.text().await.expect("text")
}

/// A friction that is rather an angle is told at its place among the values, with the plan and with the sweep.
#[tokio::test(flavor = "multi_thread")]
async fn what_may_be_a_mistake_in_the_runs_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let told = |found: &Value| found["warnings"].as_array().map_or(0, Vec::len);
    for (values, warnings) in [(json!([0.1, 0.3]), 0), (json!([0.1, 30]), 1)] {
        let request = sweep(json!({ FRICTION: values }));
        let plan: Value = server.post("/v1/sweeps?validate=true", &request).await.json().await.expect("a plan");
        let place = submitted(&server, &request).await;
        let whole = ended(&server, &place).await;
        assert_eq!((told(&plan), told(&whole)), (warnings, warnings), "{plan}");
        if warnings == 1 {
            assert_eq!(plan["warnings"], whole["warnings"]);
            assert_eq!(plan["warnings"][0]["pointer"], "/sweep/replace/~1model~1contacts~10~1friction/1");
        }
    }
}

/// As the command line does it, over a restart and by two processes at a time.
#[tokio::test(flavor = "multi_thread")]
async fn a_sweep_is_refined_where_its_response_jumps() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let mut request = sweep(json!({FRICTION: [0.1, 0.3, 0.5]}));
    request["sweep"]["responses"] = json!({"tip": {"value": "tip.x", "at": {"value": "load_factor", "reaches": 0.25}}});
    request["sweep"]["refine"] = json!(8);
    let server = TestServer::start(&database, PathSolver).await;
    let place = submitted(&server, &request).await;
    assert!(server.stop().await);
    let server = TestServer::start(&database, PathSolver).await;
    let _other = TestServer::start(&database, PathSolver).await;
    let whole = ended(&server, &place).await;
    assert_eq!((&whole["status"], &whole["progress"]), (&json!("completed"), &json!({"ended": 11, "of": 11})));
    assert_eq!(whole["refine"], 8);
    let file = folder.path().join("sweep.json");
    std::fs::write(&file, request.to_string()).expect("written");
    let told = std::process::Command::new(env!("CARGO_BIN_EXE_arcslip"))
        .args(["sweep", "--format", "json"])
        .arg(file)
        .output()
        .expect("the program runs");
    let told: Value = serde_json::from_slice(&told.stdout).expect("JSON");
    assert_eq!(whole["parameters"], told["parameters"]);
    let rows = server.get_json(&format!("{place}/rows")).await;
    let mut rows: Vec<Value> = rows["rows"].as_array().expect("rows").clone();
    rows.sort_by_key(|row| row["run"].as_u64());
    for (one, other) in rows.iter().zip(told["rows"].as_array().expect("rows")) {
        assert_eq!((&one["values"], &one["responses"]), (&other["values"], &other["responses"]));
    }
    // A value between two that the model cannot have ends the refinement with what was found.
    let mut request = sweep(json!({"/analysis/max_increments": [10, 21]}));
    request["sweep"]["refine"] = json!(3);
    let whole = ended(&server, &submitted(&server, &request).await).await;
    assert_eq!((&whole["status"], &whole["progress"]), (&json!("completed"), &json!({"ended": 2, "of": 2})));
    request["sweep"]["replace"]["/analysis/max_modes"] = json!([8, 9]);
    let refused: Value = server.post("/v1/sweeps", &request).await.json().await.expect("a problem");
    assert_eq!(refused["errors"][0]["pointer"], "/sweep/refine", "{refused}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_sweep_finds_the_limit_loads_of_its_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let mut request = sweep(json!({FRICTION: [0.1, 0.3, 1.0], "/analysis/method": ["auto", "mpec"]}));
    request["sweep"]["responses"] = json!({"limit": {"at": "first_limit"}, "tip": {"value": "tip.x", "at": "end"}});
    let plan: Value = server.post("/v1/sweeps?validate=true", &request).await.json().await.expect("a plan");
    assert_eq!(plan["runs"], 6);
    let place = submitted(&server, &request).await;
    let stream = server.ask(Method::GET, &format!("{place}/stream")).header("accept", "application/x-ndjson");
    let streamed = stream.send().await.expect("a stream").text().await.expect("whole");
    let streamed: Vec<Value> = streamed.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let (last, rows) = streamed.split_last().expect("lines");
    let whole = ended(&server, &place).await;
    assert_eq!(*last, whole, "the stream ends with the sweep");
    assert_eq!((&whole["status"], &whole["progress"]), (&json!("completed"), &json!({"ended": 6, "of": 6})));
    let stored = server.get_json(&format!("{place}/rows")).await;
    assert_eq!(stored["rows"], json!(rows));
    let rest = server.ask(Method::GET, &format!("{place}/stream")).header("accept", "application/x-ndjson");
    let rest = rest.header("last-event-id", "3").send().await.expect("a stream").text().await.expect("whole");
    assert_eq!(rest.lines().count(), 3, "two rows and the end");

    let mut runs: Vec<u64> = rows.iter().map(|row| row["run"].as_u64().expect("a number")).collect();
    runs.sort_unstable();
    assert_eq!(runs, [0, 1, 2, 3, 4, 5]);
    for row in rows {
        assert!(row["status"] == "completed" || row["stop_reason"] == "mechanism", "{row}");
        let job = server.get_json(&format!("/v1/jobs/{}", row["job"].as_str().expect("an id"))).await;
        assert_eq!(job["sweep"], json!({"sweep": whole["id"], "run": row["run"]}));
        let run = row["run"].as_u64().expect("a number") as usize;
        let (friction, method) = ([0.1, 0.3, 1.0][run / 2], ["auto", "mpec"][run % 2]);
        assert_eq!(row["values"], json!([friction, method]));
        // What its own path says.
        let path = server.lines(row["job"].as_str().expect("an id")).await;
        let increments = path.iter().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
        let first = increments.into_iter().find(|one| one["point"]["kind"] == "smooth_limit").expect("a limit point");
        assert_eq!(row["first_limit"]["load_factor"], first["load_factor"]);
        assert_eq!(row["first_limit"]["increment"], first["index"]);
        let end: Value = serde_json::from_str(path.last().expect("an end")).expect("JSON");
        let told = json!({"limit": first["load_factor"], "tip": end["displacements"]["tip"][0]});
        assert_eq!(row["responses"], told);
        assert_eq!(row["last_index"], json!(path.len() - 1));
    }
    let listed = server.get_json(&format!("/v1/jobs?sweep={}", whole["id"].as_str().expect("an id"))).await;
    assert_eq!(listed["jobs"].as_array().expect("jobs").len(), 6);
    assert_eq!(server.get_json("/v1/sweeps").await["sweeps"][0]["id"], whole["id"]);

    // The same as on the command line, but for the jobs' ids.
    let table = text(&server, &format!("{place}/table.csv")).await;
    let file = folder.path().join("sweep.json");
    std::fs::write(&file, request.to_string()).expect("written");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_arcslip"));
    let local = command.args(["sweep", "--format", "csv"]).arg(&file).output().expect("it runs");
    assert!(local.status.success(), "{local:?}");
    let without_job = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.remove(1);
        cells.join(",")
    };
    let alike = |table: &str| table.lines().map(without_job).collect::<Vec<_>>();
    assert_eq!(alike(&table), alike(&String::from_utf8(local.stdout).expect("text")));
    assert!(text(&server, &format!("{place}/table.txt")).await.contains("model.contacts[0].friction"));
    let picture = text(&server, &format!("{place}/picture.svg")).await;
    assert!(picture.starts_with("<svg") && picture.lines().any(|line| line.trim() == "limit"));

    assert_eq!(server.ask(Method::DELETE, &place).send().await.expect("an answer").status(), 204);
    assert_eq!(server.get(&place).await.status(), 404);
    assert!(server.get_json("/v1/jobs").await["jobs"].as_array().expect("jobs").is_empty());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_sweep_is_queued_whole_or_not_at_all_and_once_a_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let limits = Limits { queued: 5, ..Limits::default() };
    let settings = Settings { workers: 0, limits, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, settings).await;
    let three = sweep(json!({FRICTION: [0.1, 0.2, 0.3]}));
    let keyed = || server.ask(Method::POST, "/v1/sweeps").header("idempotency-key", "one").json(&three);
    let first: Value = keyed().send().await.expect("an answer").json().await.expect("a sweep");
    let again: Value = keyed().send().await.expect("an answer").json().await.expect("a sweep");
    assert_eq!(first["id"], again["id"]);
    let jobs = async || server.get_json("/v1/jobs").await["jobs"].as_array().expect("jobs").len();
    assert_eq!(jobs().await, 3);
    let refused = server.post("/v1/sweeps", &three).await;
    assert_eq!(refused.status(), 429);
    assert!(refused.headers().contains_key("retry-after"));
    assert_eq!(jobs().await, 3);
    for (request, pointer) in [
        (sweep(json!({FRICTION: [0.1, -0.2]})), "/sweep/replace/~1model~1contacts~10~1friction/1"),
        (sweep(json!({FRICTION: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]})), "/sweep/replace"),
        (sweep(json!({"/model/contacts/9/friction": [0.1]})), "/sweep/replace/~1model~1contacts~19~1friction"),
        (sweep(json!({"/analysis/explore": [{"depth": 1}]})), "/sweep/replace/~1analysis~1explore/0"),
        (scene("one-bar-truss"), ""),
    ] {
        let problem: Value = server.post("/v1/sweeps", &request).await.json().await.expect("a problem");
        assert_eq!((&problem["status"], &problem["errors"][0]["pointer"]), (&json!(422), &json!(pointer)), "{problem}");
    }
    assert_eq!(server.get("/v1/sweeps/00000000-0000-7000-8000-000000000000").await.status(), 404);
    let as_job = server.get(&format!("/v1/jobs/{}", first["id"].as_str().expect("an id"))).await;
    assert_eq!(as_job.status(), 404, "a sweep is none");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cancelled_sweep_keeps_what_it_has_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(4);
    let one = Settings { workers: 1, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), solver.clone(), one).await;
    let place = submitted(&server, &sweep(json!({FRICTION: [0.1, 0.2, 0.3, 0.4]}))).await;
    let of_sweep = async || server.get_json("/v1/jobs").await["jobs"].as_array().expect("jobs").clone();
    // One at work, one that is deleted, two that wait.
    while !of_sweep().await.iter().any(|job| job["progress"]["increments"] == 3) {
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    let waiting = of_sweep().await.into_iter().find(|job| job["status"] == "queued").expect("one that waits");
    let gone = format!("/v1/jobs/{}", waiting["id"].as_str().expect("an id"));
    assert_eq!(server.ask(Method::DELETE, &gone).send().await.expect("an answer").status(), 204);
    assert_eq!(server.get_json(&place).await["progress"], json!({"ended": 1, "of": 4}));
    let cancelled = server.ask(Method::POST, &format!("{place}/cancel")).send().await.expect("an answer");
    assert_eq!(cancelled.status(), 202);
    solver.let_go();
    let whole = ended(&server, &place).await;
    assert_eq!((&whole["status"], &whole["progress"]["ended"]), (&json!("cancelled"), &json!(4)));
    let rows = server.get_json(&format!("{place}/rows")).await;
    let statuses: Vec<&str> =
        rows["rows"].as_array().expect("rows").iter().filter_map(|row| row["status"].as_str()).collect();
    assert_eq!(statuses.iter().filter(|status| **status == "cancelled").count(), 4, "{statuses:?}");
    assert_eq!(rows["rows"][0]["error"], "it was deleted");
    let metrics = text(&server, "/metrics").await;
    assert!(metrics.contains("jobs{status=\"running\"} 0"), "a sweep is none that is worked on");
}
