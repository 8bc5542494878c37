//! Studies over HTTP: posted, streamed, resumed after a restart, cancelled, told apart from jobs.

use crate::common::process::PATIENCE;
use crate::common::server::{EventStream, TestServer, settings};
use arcslip::model::decode;
use arcslip::resources::cancel::CancelFlag;
use arcslip::service::jobs::{PathSolver, Settings};
use arcslip::studies::error_against_time;
use reqwest::{Method, StatusCode};
use roxmltree::Document;
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

fn study(scene: &str, varied: Value) -> Value {
    let mut request: Value =
        serde_json::from_str(arcslip::check::scenes::find(scene).expect("a scene").request).expect("JSON");
    request["study"] = varied;
    request
}

async fn submit(server: &TestServer, request: &Value) -> String {
    let answer = server.post("/v1/studies", request).await;
    let (status, location) = (answer.status(), answer.headers().get("location").cloned());
    let study: Value = answer.json().await.expect("JSON");
    assert_eq!(status, StatusCode::ACCEPTED, "{study}");
    let id = study["id"].as_str().expect("an id").to_owned();
    assert_eq!(location.expect("a place").to_str().expect("text"), format!("/v1/studies/{id}"));
    id
}

async fn until(server: &TestServer, id: &str, condition: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let study = server.get_json(&format!("/v1/studies/{id}")).await;
        if condition(&study) {
            return study;
        }
        assert!(began.elapsed() < PATIENCE, "still {study}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

async fn ended(server: &TestServer, id: &str) -> Value {
    until(server, id, |study| !matches!(study["status"].as_str(), Some("queued" | "running"))).await
}

/// The lines of a study's stream.
async fn lines(server: &TestServer, id: &str) -> Vec<Value> {
    let ask = server.ask(Method::GET, &format!("/v1/studies/{id}/stream")).header("accept", "application/x-ndjson");
    let text = ask.send().await.expect("an answer").text().await.expect("a whole body");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// What is the same in every run.
fn timeless(rows: &Value) -> Vec<Value> {
    let without_time = |row: &Value| {
        let mut row = row.clone();
        row["time"] = Value::Null;
        row
    };
    rows.as_array().expect("rows").iter().map(without_time).collect()
}

/// The rows of the same study, run here.
fn rows_of(request: &Value) -> Value {
    let request = decode::study(request.to_string().as_bytes()).expect("a study");
    let report =
        error_against_time::run(&request, Vec::new(), &CancelFlag::default(), &mut |_| ControlFlow::Continue(()));
    serde_json::to_value(report.expect("a study").expect("a report").rows).expect("JSON")
}

#[tokio::test]
async fn a_study_is_posted_streamed_and_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let request = study("klarbring", json!({"arc_lengths": [0.2, 0.1], "repeats": 2}));
    let id = submit(&server, &request).await;
    let response = server.ask(Method::GET, &format!("/v1/studies/{id}/stream")).send().await.expect("an answer");
    let events = EventStream::of(response).rest().await;
    assert_eq!(events.len(), 19, "six rows three times, and the end");
    for (index, event) in events[..18].iter().enumerate() {
        assert_eq!((event.event.as_str(), event.id.as_str()), ("row", index.to_string().as_str()));
        let run: Value = serde_json::from_str(&event.data).expect("a run");
        assert_eq!((run["index"].as_u64(), run["row"]["row"].as_u64()), (Some(index as u64), Some(index as u64 % 6)));
        assert_eq!(run["row"]["time"]["repeats"].as_u64().unwrap_or(0), index as u64 / 6);
        assert_eq!(run["reference"]["kind"], "exact");
    }
    assert_eq!(events[18].event, "end");
    let end: Value = serde_json::from_str(&events[18].data).expect("a study");
    let read = server.get_json(&format!("/v1/studies/{id}")).await;
    assert_eq!(end, read);
    assert_eq!((&read["status"], &read["progress"]), (&json!("completed"), &json!({"runs": 18, "of": 18})));
    assert_eq!(read["report"]["complete"], true);
    assert_eq!(timeless(&read["report"]["rows"]), timeless(&rows_of(&request)));
    let lines = lines(&server, &id).await;
    assert_eq!((lines.len(), &lines[18]), (19, &read));
    // A client that comes back goes on after what it has.
    let resumed = server.ask(Method::GET, &format!("/v1/studies/{id}/stream")).header("last-event-id", "16");
    let rest = EventStream::of(resumed.send().await.expect("an answer")).rest().await;
    assert_eq!(rest, events[17..]);

    let csv = server.get(&format!("/v1/studies/{id}/table.csv")).await.text().await.expect("a table");
    assert_eq!(csv.lines().count(), 7);
    let text = server.get(&format!("/v1/studies/{id}/table.txt")).await.text().await.expect("a table");
    assert!(text.contains("order of regularised"), "{text}");
    let picture = server.get(&format!("/v1/studies/{id}/picture.svg")).await;
    assert_eq!(picture.headers()["content-type"], "image/svg+xml");
    assert!(Document::parse(&picture.text().await.expect("a picture")).is_ok());
}

#[tokio::test]
async fn studies_and_jobs_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let idle = Settings { workers: 0, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, idle).await;
    let request = study("klarbring", json!({"repeats": 0}));
    let id = submit(&server, &request).await;
    let job = server.submit(&study_less(&request)).await;
    let listed = |list: &Value, of: &str| -> Vec<String> {
        list[of].as_array().expect("a list").iter().map(|one| one["id"].as_str().expect("an id").to_owned()).collect()
    };
    assert_eq!(listed(&server.get_json("/v1/studies").await, "studies"), [id.as_str()]);
    assert_eq!(listed(&server.get_json("/v1/studies?status=queued").await, "studies"), [id.as_str()]);
    assert_eq!(listed(&server.get_json("/v1/jobs").await, "jobs"), [job.as_str()]);
    assert_eq!(listed(&server.get_json("/v1/jobs?status=queued").await, "jobs"), [job.as_str()]);
    for wrong in ["", "/increments", "/stream", "/path.csv"] {
        assert_eq!(server.get(&format!("/v1/jobs/{id}{wrong}")).await.status(), StatusCode::NOT_FOUND, "{wrong}");
    }
    for wrong in ["", "/stream", "/table.csv", "/picture.svg"] {
        assert_eq!(server.get(&format!("/v1/studies/{job}{wrong}")).await.status(), StatusCode::NOT_FOUND, "{wrong}");
    }
    let cancel = server.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).await;
    assert_eq!(cancel.status(), StatusCode::NOT_FOUND);
    let follow = server.post(&format!("/v1/jobs/{id}/follow"), &json!({"increment": 0, "direction": 0})).await;
    assert_eq!(follow.status(), StatusCode::NOT_FOUND);
    // Nothing has been found yet.
    assert_eq!(server.get_json(&format!("/v1/studies/{id}")).await["report"], Value::Null);
    for nothing in ["table.csv", "table.txt", "picture.svg"] {
        assert_eq!(server.get(&format!("/v1/studies/{id}/{nothing}")).await.status(), StatusCode::NOT_FOUND);
    }
    let cancelled: Value =
        server.post(&format!("/v1/studies/{id}/cancel"), &json!({})).await.json().await.expect("JSON");
    assert_eq!(cancelled["status"], "cancelled");
    let gone = server.ask(Method::DELETE, &format!("/v1/studies/{id}")).send().await.expect("an answer");
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    assert_eq!(server.get(&format!("/v1/studies/{id}")).await.status(), StatusCode::NOT_FOUND);
    assert_eq!(server.get_json(&format!("/v1/jobs/{job}")).await["status"], "queued");
}

fn study_less(request: &Value) -> Value {
    let mut job = request.clone();
    job.as_object_mut().expect("an object").remove("study");
    job
}

#[tokio::test]
async fn requests_are_checked_and_repeated_ones_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let idle = Settings { workers: 0, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, idle).await;
    let bad = server.post("/v1/studies", &study("klarbring", json!({"arc_lengths": [0.1, 0.2]}))).await;
    assert_eq!(bad.status(), StatusCode::UNPROCESSABLE_ENTITY);
    let problem: Value = bad.json().await.expect("a problem");
    assert_eq!(problem["errors"][0]["pointer"], "/study/arc_lengths/1");
    let empty = server.ask(Method::POST, "/v1/studies").header("content-type", "application/json").body("");
    let empty: Value = empty.send().await.expect("an answer").json().await.expect("a problem");
    assert!(empty["detail"].as_str().is_some_and(|detail| detail.contains("a study")), "{empty}");
    let good = study("arch-type-truss", json!({"repeats": 1}));
    let plan: Value = server.post("/v1/studies?validate=true", &good).await.json().await.expect("a plan");
    assert_eq!((&plan["rows"], &plan["runs"], &plan["reference"]), (&json!(12), &json!(24), &json!("self_converged")));
    assert_eq!(server.get_json("/v1/studies").await["studies"], json!([]));
    let keyed = async |path: &str, body: &Value| {
        server.ask(Method::POST, path).header("idempotency-key", "k").json(body).send().await.expect("an answer")
    };
    let first: Value = keyed("/v1/studies", &good).await.json().await.expect("a study");
    let again: Value = keyed("/v1/studies", &good).await.json().await.expect("a study");
    assert_eq!(first["id"], again["id"]);
    let job = study_less(&good);
    assert_eq!(keyed("/v1/jobs", &job).await.status(), StatusCode::UNPROCESSABLE_ENTITY);
}

/// The picture is there from the first path on, and the same where no path is timed at all.
#[tokio::test]
async fn a_study_has_a_picture_without_times() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let id = submit(&server, &study("klarbring", json!({"arc_lengths": [0.2, 0.1], "repeats": 0}))).await;
    assert_eq!(ended(&server, &id).await["status"], "completed");
    let picture = server.get(&format!("/v1/studies/{id}/picture.svg")).await;
    assert_eq!(picture.status(), StatusCode::OK);
    assert!(picture.text().await.expect("a picture").contains("not all paths are timed"));
    let stream = server.ask(Method::GET, &format!("/v1/studies/{id}/stream")).header("last-event-id", "x");
    let problem: Value = stream.send().await.expect("an answer").json().await.expect("a problem");
    assert_eq!(
        problem["detail"],
        "Last-Event-ID: the index of the last row received, 0 to 9223372036854775807, is expected"
    );
}

#[tokio::test]
async fn a_study_goes_on_after_a_restart_to_the_same_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let request = study("arch-type-truss", json!({"arc_lengths": [0.1, 0.05], "repeats": 12}));
    let id = submit(&server, &request).await;
    // In the middle of the timed rounds.
    let runs = |study: &Value| study["progress"]["runs"].as_u64().expect("a count");
    until(&server, &id, |study| runs(study) >= 9).await;
    assert!(server.stop().await, "everything ends within the bound");

    let idle = Settings { workers: 0, ..settings() };
    let server = TestServer::start_with(&database, PathSolver, idle).await;
    let waiting = server.get_json(&format!("/v1/studies/{id}")).await;
    let before = runs(&waiting) as usize;
    assert_eq!(waiting["status"], "queued");
    assert!((9..78).contains(&before), "{before}");
    let so_far = &waiting["report"];
    assert_eq!((so_far["complete"].clone(), so_far["rows"].as_array().map(Vec::len)), (json!(false), Some(6)));
    assert!(server.stop().await);

    let server = TestServer::start(&database, PathSolver).await;
    let study = ended(&server, &id).await;
    assert_eq!((&study["status"], &study["attempt"]), (&json!("completed"), &json!(1)), "{study}");
    let mut lines = lines(&server, &id).await;
    assert_eq!(lines.pop().expect("a closing line")["status"], "completed");
    let indices: Vec<u64> = lines.iter().map(|line| line["index"].as_u64().expect("an index")).collect();
    assert_eq!(indices, (0..78).collect::<Vec<_>>());
    // Times of both lives are in the medians.
    assert!(study["report"]["rows"].as_array().expect("rows").iter().all(|row| row["time"]["repeats"] == 12));
    assert_eq!(timeless(&study["report"]["rows"]), timeless(&rows_of(&request)));
}

#[tokio::test]
async fn a_running_study_is_cancelled_and_keeps_its_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let id = submit(&server, &study("arch-type-truss", json!({"repeats": 101}))).await;
    until(&server, &id, |study| study["progress"]["runs"].as_u64() >= Some(3)).await;
    let asked = server.post(&format!("/v1/studies/{id}/cancel"), &json!({})).await;
    assert_eq!(asked.status(), StatusCode::ACCEPTED);
    let study = ended(&server, &id).await;
    assert_eq!(study["status"], "cancelled");
    assert_eq!(study["report"]["complete"], false);
    let rows = study["report"]["rows"].as_array().expect("rows").len();
    assert!((3..=12).contains(&rows), "{rows}");
}
