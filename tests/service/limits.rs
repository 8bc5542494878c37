//! Limits: what is past one is refused or stopped, says so, and leaves what is stored; readers and ended jobs cost the
//! others nothing.

use crate::common::process::PATIENCE;
use crate::common::server::{TestServer, settings};
use crate::common::service::{in_short_steps, indices, request, scene, without_elapsed};
use crate::common::solver::MadeUp;
use arcslip::service::jobs::{Limits, PathSolver, Settings};
use arcslip::service::store::{self, Batch, Keep};
use reqwest::{Method, Response};
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};

fn limited(limits: Limits) -> Settings {
    Settings { limits, ..settings() }
}

async fn refusal(answer: Response, status: u16, kind: &str) -> Value {
    assert_eq!(answer.status(), status);
    let problem: Value = answer.json().await.expect("a problem");
    assert_eq!(problem["type"], format!("/problems/{kind}"), "{problem}");
    problem
}

#[tokio::test]
async fn the_queue_is_bounded_and_says_when_to_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let solver = MadeUp::holding_at(0);
    let settings = Settings { workers: 1, ..limited(Limits { queued: 3, ..Limits::default() }) };
    let server = TestServer::start_with(&database, solver.clone(), settings).await;
    let running = server.submit(&request("running", 2)).await;
    server.until(&running, |job| job["status"] == "running").await;
    let keyed = |key: &'static str, name: &str| {
        server.ask(Method::POST, "/v1/jobs").header("idempotency-key", key).json(&request(name, 2)).send()
    };
    assert_eq!(keyed("one", "one").await.expect("an answer").status(), 202);
    server.submit(&request("two", 2)).await;
    server.submit(&request("three", 2)).await;
    let answer = server.post("/v1/jobs", &request("four", 2)).await;
    let seconds = answer.headers()["retry-after"].to_str().expect("text").parse::<u64>();
    assert!(seconds.is_ok_and(|seconds| seconds > 0));
    let problem = refusal(answer, 429, "queue-full").await;
    assert!(problem["detail"].as_str().expect("text").contains("at most 3 jobs may wait"), "{problem}");
    refusal(keyed("four", "four").await.expect("an answer"), 429, "queue-full").await;
    refusal(server.post("/v1/studies", &scene("klarbring")).await, 429, "queue-full").await;
    // What is queued already is answered, and a check queues nothing.
    assert_eq!(keyed("one", "one").await.expect("an answer").status(), 202);
    assert_eq!(server.post("/v1/jobs?validate=true", &request("four", 2)).await.status(), 200);
    solver.let_go();
    server.ended(&running).await;
    let began = Instant::now();
    while keyed("four", "four").await.expect("an answer").status() != 202 {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

#[tokio::test]
async fn a_job_that_would_follow_another_waits_for_room_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let id = server.submit(&scene("klarbring")).await;
    server.ended(&id).await;
    assert!(server.stop().await);
    let settings = Settings { workers: 0, ..limited(Limits { queued: 1, increments: 500, ..Limits::default() }) };
    let server = TestServer::start_with(&database, PathSolver, settings).await;
    let place = format!("/v1/jobs/{id}/follow");
    let body = json!({"increment": 7, "direction": 0});
    let too_many = json!({"increment": 7, "direction": 0, "max_increments": 501});
    let problem = refusal(server.post(&place, &too_many).await, 422, "invalid-model").await;
    assert_eq!(problem["errors"][0]["pointer"], "/max_increments");
    let queued = server.post(&place, &body).await;
    assert_eq!(queued.status(), 202);
    let queued: Value = queued.json().await.expect("a job");
    assert_eq!(queued["progress"]["max_increments"], 500, "no more than this service takes");
    refusal(server.post(&place, &body).await, 429, "queue-full").await;
}

#[tokio::test]
async fn what_is_too_large_is_refused_with_its_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let limits = Limits { body_bytes: 4096, nodes: 5, elements: 3, contacts: 1, increments: 700, ..Limits::default() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, limited(limits)).await;
    for place in ["/v1/jobs", "/v1/jobs?validate=true", "/v1/studies"] {
        let mut request = scene("three-snapping-bars");
        request["analysis"]["max_increments"] = json!(701);
        let problem = refusal(server.post(place, &request).await, 422, "invalid-model").await;
        let found: Vec<(&str, &str)> = problem["errors"]
            .as_array()
            .expect("errors")
            .iter()
            .map(|error| (error["pointer"].as_str().expect("text"), error["detail"].as_str().expect("text")))
            .collect();
        let expected = [
            ("/model/nodes", "found 6 nodes; this service takes at most 5"),
            ("/model/elements", "found 5 elements; this service takes at most 3"),
            ("/model/contacts", "found 3 contacts; this service takes at most 1"),
            ("/analysis/max_increments", "found 701; this service takes at most 700"),
        ];
        assert_eq!(found, expected, "{place}");
    }
    let mut large = scene("one-bar-truss");
    large["model"]["name"] = json!("x".repeat(5000));
    let problem = refusal(server.post("/v1/jobs", &large).await, 413, "body-too-large").await;
    assert!(problem["detail"].as_str().expect("text").contains("4096"), "{problem}");
    let described = server.get("/openapi.json").await.text().await.expect("a body");
    for told in ["| nodes | 5 |", "| bytes of a body | 4096 |", "| `max_increments` | 700 |", "time_limit"] {
        assert!(described.contains(told), "{told}");
    }
}

#[tokio::test]
async fn a_job_past_its_time_is_stopped_and_what_it_stored_stands() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let settings = || limited(Limits { wall_time: Duration::from_millis(600), ..Limits::default() });
    let solver = MadeUp::pausing(Duration::from_millis(2));
    let server = TestServer::start_with(&database, solver, settings()).await;
    let id = server.submit(&request("long", 100_000)).await;
    // Its time goes on where it is taken up again.
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert!(server.stop().await);
    tokio::time::sleep(Duration::from_millis(500)).await;
    let server = TestServer::start_with(&database, MadeUp::pausing(Duration::from_millis(2)), settings()).await;
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["stop_reason"]), (&json!("stopped"), &json!("time_limit")), "{job}");
    assert!(job["error"].as_str().expect("a text").contains("0.600 s"), "{job}");
    let lines = server.lines(&id).await;
    assert_eq!(json!(lines.len() - 1), job["progress"]["increments"]);
    assert_eq!(indices(lines.iter().map(String::as_str)), (0..lines.len() as u64).collect::<Vec<_>>());
    assert!(!lines.is_empty() && lines.len() < 100_000, "{}", lines.len());
    // One in the middle of an increment is stopped too, and the worker is free again.
    let stuck = TestServer::start_with(&folder.path().join("other.db"), MadeUp::holding_at(3), settings()).await;
    let id = stuck.submit(&request("stuck", 10)).await;
    let job = stuck.ended(&id).await;
    assert_eq!((&job["stop_reason"], &job["progress"]["increments"]), (&json!("time_limit"), &json!(2)), "{job}");
    let events = stuck.stream(&id, None).await.rest().await;
    assert_eq!(events.last().map(|event| event.event.as_str()), Some("end"));
}

#[tokio::test]
async fn a_study_past_its_time_is_stopped_with_what_it_has_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = limited(Limits { wall_time: Duration::from_millis(1500), ..Limits::default() });
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, settings).await;
    let mut study = scene("klarbring");
    study["study"] = json!({"methods": ["auto"], "arc_lengths": [0.02, 0.01], "repeats": 100});
    study["analysis"]["arc_length"] = json!({"initial": 0.001, "max": 0.001, "min": 1e-6});
    study["analysis"]["max_increments"] = json!(100_000);
    study["study"]["arc_lengths"] = json!([0.01, 0.001]);
    let answer = server.post("/v1/studies", &study).await;
    let id = answer.json::<Value>().await.expect("a study")["id"].as_str().expect("an id").to_owned();
    let began = Instant::now();
    let study = loop {
        let study = server.get_json(&format!("/v1/studies/{id}")).await;
        if !matches!(study["status"].as_str(), Some("queued" | "running")) {
            break study;
        }
        assert!(began.elapsed() < PATIENCE, "{study}");
        tokio::time::sleep(Duration::from_millis(20)).await;
    };
    assert_eq!(study["status"], "stopped", "{study}");
    assert!(study["error"].as_str().expect("a text").contains("1.500 s"), "{study}");
    assert!(study["progress"]["runs"].as_u64() < study["progress"]["of"].as_u64());
}

#[tokio::test]
async fn a_job_that_would_store_too_much_is_stopped_within_the_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let request = in_short_steps("one-bar-truss", 400, 400);
    let server = TestServer::start(&folder.path().join("whole.db"), PathSolver).await;
    let whole = server.submit(&request).await;
    server.ended(&whole).await;
    let whole: Vec<String> = server.lines(&whole).await.iter().map(|line| without_elapsed(line)).collect();
    let most = 100_000;
    let settings = limited(Limits { stored_bytes: most, ..Limits::default() });
    let database = folder.path().join("jobs.db");
    let server = TestServer::start_with(&database, PathSolver, settings).await;
    let id = server.submit(&request).await;
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["stop_reason"]), (&json!("stopped"), &json!("storage_limit")), "{job}");
    assert!(job["error"].as_str().expect("a text").contains("100000 bytes"), "{job}");
    let lines: Vec<String> = server.lines(&id).await.iter().map(|line| without_elapsed(line)).collect();
    assert!(lines.len() > 20 && lines.len() < 400 && lines == whole[..lines.len()], "{}", lines.len());
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(&database)).await.expect("a pool");
    let bytes: i64 = sqlx::query_scalar(
        "SELECT (SELECT sum(length(body)) FROM increments) + \
         (SELECT coalesce(sum(length(body) + coalesce(length(trail), 0)), 0) FROM branches)",
    )
    .fetch_one(&pool)
    .await
    .expect("a sum");
    assert!(bytes as u64 <= most && bytes as u64 > most * 8 / 10, "{bytes}");
}

/// Readers that take nothing hold their own line up and nobody's work.
#[tokio::test(flavor = "multi_thread")]
async fn a_reader_that_does_not_read_holds_up_no_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let increments = 20_000;
    let id = server.submit(&request("watched", increments)).await;
    let place = server.address();
    let mut stuck = Vec::new();
    for _ in 0..8 {
        let mut reader = TcpStream::connect(place).expect("connected");
        write!(reader, "GET /v1/jobs/{id}/stream HTTP/1.1\r\nhost: {place}\r\nconnection: close\r\n\r\n")
            .expect("asked");
        stuck.push(reader);
    }
    // When it ends, more is waiting for them than the buffers of connections hold.
    assert_eq!(server.ended(&id).await["status"], "completed");
    // Whoever reads at last has everything.
    let mut last = stuck.pop().expect("a reader");
    let text = tokio::task::spawn_blocking(move || {
        let mut text = String::new();
        last.read_to_string(&mut text).map(|_| text)
    });
    let text = text.await.expect("read").expect("text");
    assert_eq!(text.matches("event: increment").count() as u64, increments);
    assert_eq!(text.matches("event: end").count(), 1);
}

async fn pages(database: &Path) -> i64 {
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(database)).await.expect("a pool");
    let pages = sqlx::query_scalar("PRAGMA page_count").fetch_one(&pool).await.expect("a number");
    pool.close().await;
    pages
}

#[tokio::test]
async fn ended_jobs_are_kept_as_told_and_room_is_given_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, MadeUp::default()).await;
    let mut ids = Vec::new();
    for number in 0..6 {
        let id = server.submit(&request(&format!("number {number}"), 2000)).await;
        server.ended(&id).await;
        ids.push(id);
    }
    assert!(server.stop().await);
    let before = pages(&database).await;
    let kept = async |server: &TestServer| -> Vec<bool> {
        let mut kept = Vec::new();
        for id in &ids {
            kept.push(server.get(&format!("/v1/jobs/{id}")).await.status() == 200);
        }
        kept
    };
    let quick = Duration::from_millis(100);
    let newest = Settings { keep: Some(Keep::Newest(2)), tidy_interval: quick, workers: 1, ..settings() };
    let solver = MadeUp::holding_at(1);
    let server = TestServer::start_with(&database, solver.clone(), newest).await;
    let running = server.submit(&request("runs", 4)).await;
    let began = Instant::now();
    while kept(&server).await != [false, false, false, false, true, true] || pages(&database).await > before / 2 {
        assert!(began.elapsed() < PATIENCE, "{:?} {before} {}", kept(&server).await, pages(&database).await);
        tokio::time::sleep(quick).await;
    }
    assert_eq!(server.lines(&ids[5]).await.len(), 2000, "what is kept is whole");
    assert_eq!(server.get_json(&format!("/v1/jobs/{running}")).await["status"], "running", "what runs stays");
    solver.let_go();
    server.ended(&running).await;
    assert!(server.stop().await);

    let recent = |length| Settings { keep: Some(Keep::For(length)), tidy_interval: quick, ..settings() };
    let server = TestServer::start_with(&database, MadeUp::default(), recent(Duration::from_secs(3600))).await;
    tokio::time::sleep(3 * quick).await;
    assert!(kept(&server).await[5]);
    assert!(server.stop().await);
    let server = TestServer::start_with(&database, MadeUp::default(), recent(Duration::from_millis(1))).await;
    while server.get_json("/v1/jobs").await["jobs"] != json!([]) {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(quick).await;
    }
}

/// A family is not dropped before its directions have been looked at.
#[tokio::test]
async fn what_an_exploration_has_still_to_look_at_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let server = TestServer::start_on(store.clone(), PathSolver, Settings { workers: 0, ..settings() }).await;
    let mut request = scene("klarbring");
    request["analysis"]["explore"] = json!({"depth": 1, "max_jobs": 3});
    let id = server.submit(&request).await;
    server.until(&id, |job| job["status"] == "queued").await;
    let claim = store.claim("worker", Duration::from_secs(60)).await.expect("a claim").expect("a job");
    let ended = arcslip::service::store::Ending::failed("ended");
    store.finish(&claim.lease, &Batch::default(), &ended).await.expect("ended");
    // Whichever comes first, the sweep or this: only a family that has been looked at goes.
    store.explore().await.expect("looked at");
    assert_eq!(store.retire(Keep::Newest(0)).await.expect("an answer"), 1);
    assert_eq!(server.get(&format!("/v1/jobs/{id}")).await.status(), 404);
}
