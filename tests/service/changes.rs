//! The feed of all changes: nothing is missed over broken connections and other processes, and nobody sees what is not theirs.

use crate::common::engines::Database;
use crate::common::server::{Event, EventStream, TestServer, settings};
use crate::common::service::request;
use crate::common::solver::MadeUp;
use crate::on_both_engines;
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Duration;

async fn feed(server: &TestServer, last: Option<&str>) -> EventStream {
    let mut asked = server.ask(Method::GET, "/v1/changes");
    if let Some(last) = last {
        asked = asked.header("last-event-id", last);
    }
    EventStream::of(asked.send().await.expect("an answer"))
}

fn data(event: &Event) -> Value {
    serde_json::from_str(&event.data).expect("JSON")
}

/// Reads until the condition holds of what a dashboard would show: the status of each job by its id.
async fn shown(
    feed: &mut EventStream,
    board: &mut BTreeMap<String, String>,
    condition: impl Fn(&BTreeMap<String, String>) -> bool,
) -> String {
    loop {
        let event = feed.next().await.expect("an event");
        let told = data(&event);
        let id = told["id"].as_str().unwrap_or_default().to_owned();
        match event.event.as_str() {
            "changed" => drop(board.insert(id, told["status"].as_str().expect("a status").to_owned())),
            "deleted" => drop(board.remove(&id)),
            other => assert_eq!(other, "begin"),
        }
        if condition(board) {
            return event.id;
        }
    }
}

on_both_engines! {
    a_dashboard_follows_all_jobs_over_broken_connections_and_two_processes,
}

async fn a_dashboard_follows_all_jobs_over_broken_connections_and_two_processes(database: Database) {
    let solver = MadeUp::holding_at(2);
    let server = TestServer::start_on(database.open().await, solver.clone(), settings()).await;
    let other = TestServer::start_on(database.open().await, MadeUp::default(), settings()).await;
    let mut open = feed(&server, None).await;
    let first = open.next().await.expect("an event");
    assert_eq!((first.event.as_str(), first.data.as_str()), ("begin", "{}"));
    let mut board = BTreeMap::new();
    let held = server.submit(&request("held", 4)).await;
    let last = shown(&mut open, &mut board, |board| board.contains_key(&held)).await;
    drop(open);
    // What happens meanwhile, by the other process too, is told after the last event that came.
    let mut others = Vec::new();
    for number in 0..30 {
        others.push(other.submit(&request(&format!("other {number}"), 3)).await);
    }
    let gone = others.pop().expect("a job");
    solver.let_go();
    for id in others.iter().chain([&held, &gone]) {
        server.ended(id).await;
    }
    let removed = other.ask(Method::DELETE, &format!("/v1/jobs/{gone}")).send().await.expect("an answer");
    assert_eq!(removed.status(), StatusCode::NO_CONTENT);
    let mut again = feed(&server, Some(&last)).await;
    let all_there = |board: &BTreeMap<String, String>| {
        board.len() == 30 && !board.contains_key(&gone) && board.values().all(|status| status == "completed")
    };
    let last = shown(&mut again, &mut board, all_there).await;
    // And goes on with what the other process does next.
    let more = other.submit(&request("more", 3)).await;
    shown(&mut again, &mut board, |board| board.get(&more).is_some_and(|status| status == "completed")).await;
    // Every change has its place: what came before is not told again.
    let mut third = feed(&other, Some(&last)).await;
    let mut next = third.next().await.expect("an event");
    if data(&next)["id"] == gone {
        next = third.next().await.expect("an event");
    }
    assert_eq!(data(&next)["id"], more, "{next:?}");
    assert_eq!(data(&next)["kind"], "job");
}

#[tokio::test]
async fn places_of_another_database_and_no_places_begin_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("first", 3)).await;
    server.ended(&id).await;
    let future = format!("{}-{}", i64::MAX, uuid::Uuid::nil().simple());
    for other in [future.as_str(), "", "7", "7-8", "x-00000000000000000000000000000000"] {
        let event = feed(&server, Some(other)).await.next().await.expect("an event");
        assert_eq!(event.event, "begin", "{other}");
    }
}

#[tokio::test]
async fn sweeps_and_their_runs_are_told_and_a_feed_ends_in_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = arcslip::service::jobs::Settings { workers: 1, ..settings() };
    let solver = MadeUp::pausing(Duration::from_millis(1));
    let server = TestServer::start_with(&folder.path().join("jobs.db"), solver, settings).await;
    let mut open = feed(&server, None).await;
    let mut body = request("swept", 3);
    body["sweep"] = json!({"replace": {"/model/contacts/0/friction": [0.1, 0.2, 0.3]}});
    let sweep: Value = server.post("/v1/sweeps", &body).await.json().await.expect("a sweep");
    let id = sweep["id"].as_str().expect("an id").to_owned();
    let mut board = BTreeMap::new();
    let all_there =
        |board: &BTreeMap<String, String>| board.len() == 4 && board.values().all(|status| status == "completed");
    shown(&mut open, &mut board, all_there).await;
    assert!(board.contains_key(&id), "the sweep and its runs");
    assert!(server.stop().await);
    let rest = open.rest().await;
    assert_eq!(rest.last().map(|event| event.retry.as_str()), Some("2000"), "{rest:?}");
}
