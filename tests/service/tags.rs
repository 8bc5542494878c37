//! What is finished has a tag, and is not sent to those who have it.

use crate::common::server::TestServer;
use crate::common::service::{request, scene};
use crate::common::solver::MadeUp;
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, Response};
use serde_json::{Value, json};

async fn again(server: &TestServer, place: &str, tag: &str) -> Response {
    server.ask(Method::GET, place).header("if-none-match", tag).send().await.expect("an answer")
}

/// The answer has a tag, is sent once, and is the same for who does not have it.
async fn is_tagged(server: &TestServer, place: &str) -> String {
    let first = server.get(place).await;
    assert_eq!(first.status(), 200, "{place}");
    let tag = first.headers()["etag"].to_str().expect("text").to_owned();
    assert_eq!(first.headers()["cache-control"], "private, no-cache", "{place}");
    let text = first.text().await.expect("a body");
    let known = again(server, place, &tag).await;
    assert_eq!(known.status(), 304, "{place}");
    assert_eq!(known.headers()["etag"], *tag, "{place}");
    assert!(known.bytes().await.expect("a body").is_empty());
    let other = again(server, place, "\"other\"").await;
    assert_eq!(other.headers()["etag"], *tag, "{place}");
    assert_eq!(other.text().await.expect("a body"), text);
    tag
}

#[tokio::test]
async fn a_finished_job_is_sent_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(3);
    let server = TestServer::start(&folder.path().join("jobs.db"), solver.clone()).await;
    let id = server.submit(&request("held", 6)).await;
    server.until(&id, |job| job["progress"]["increments"] == 2).await;
    let files = ["/path.csv", "/results.pvd", "/results.parquet", "/picture.svg", "/picture.png"];
    let parts = [&["", "/increments", "/increments?after=2&limit=2"], &files[..]].concat();
    let places: Vec<String> = parts.iter().map(|part| format!("/v1/jobs/{id}{part}")).collect();
    for place in &places[..3] {
        let answer = server.get(place).await;
        assert!(!answer.headers().contains_key("etag"), "{place}: what still grows has no tag");
        assert_eq!(answer.headers()["cache-control"], "no-store");
    }
    solver.let_go();
    server.ended(&id).await;
    let mut tags = Vec::new();
    for place in &places {
        tags.push(is_tagged(&server, place).await);
    }
    tags.sort();
    tags.dedup();
    assert_eq!(tags.len(), places.len());
    // A deleted one is gone, whatever the client has.
    assert_eq!(server.ask(Method::DELETE, &places[0]).send().await.expect("an answer").status(), 204);
    assert_eq!(again(&server, &places[0], "*").await.status(), 404);
}

#[tokio::test]
async fn the_tag_of_a_job_changes_with_what_is_told_of_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let id = server.submit(&scene("klarbring")).await;
    server.ended(&id).await;
    let place = format!("/v1/jobs/{id}");
    let before = is_tagged(&server, &place).await;
    let follow = json!({"increment": 7, "direction": 0, "max_increments": 2});
    assert_eq!(server.post(&format!("{place}/follow"), &follow).await.status(), 202);
    assert_eq!(again(&server, &place, &before).await.status(), 200, "it has a follower now");
}

#[tokio::test]
async fn a_finished_study_is_sent_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let mut study = scene("klarbring");
    study["study"] = json!({"methods": ["auto"], "arc_lengths": [0.5, 0.25], "repeats": 1});
    let answer: Value = server.post("/v1/studies", &study).await.json().await.expect("a study");
    let place = format!("/v1/studies/{}", answer["id"].as_str().expect("an id"));
    while server.get_json(&place).await["status"] != "completed" {
        tokio::time::sleep(std::time::Duration::from_millis(20)).await;
    }
    for part in ["", "/table.csv", "/table.txt", "/picture.svg"] {
        is_tagged(&server, &format!("{place}{part}")).await;
    }
}
