//! Streams: every index once, whoever reads, however often the line drops.

use crate::common::server::{TestServer, settings, short_leases};
use crate::common::service::{indices, request};
use crate::common::solver::MadeUp;
use arcslip::service::jobs::Settings;
use reqwest::Method;
use serde_json::Value;
use std::time::Duration;

#[tokio::test]
async fn a_client_that_drops_and_resumes_sees_every_index_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::pausing(Duration::from_micros(300))).await;
    let id = server.submit(&request("streamed", 900)).await;
    let mut seen: Vec<u64> = Vec::new();
    let mut last = None;
    // Drops after 1, 2, 3, ... events until the end comes.
    'connections: for patience in 1.. {
        let mut stream = server.stream(&id, last.as_deref()).await;
        for _ in 0..patience * 7 {
            let event = stream.next().await.expect("an event");
            if event.event == "end" {
                let job: Value = serde_json::from_str(&event.data).expect("a job");
                assert_eq!(job["status"], "completed");
                assert_eq!(stream.next().await, None);
                break 'connections;
            }
            assert_eq!(event.event, "increment");
            seen.extend(indices([event.data.as_str()]));
            assert_eq!(seen.last().map(u64::to_string).as_ref(), Some(&event.id));
            last = Some(event.id);
        }
    }
    assert_eq!(seen, (0..900).collect::<Vec<_>>());
}

#[tokio::test]
async fn increments_arrive_while_the_job_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(2);
    let server = TestServer::start(&folder.path().join("jobs.db"), solver.clone()).await;
    let id = server.submit(&request("held", 4)).await;
    let mut stream = server.stream(&id, None).await;
    assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some("0"));
    assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some("1"));
    solver.let_go();
    let rest = stream.rest().await;
    let names: Vec<&str> = rest.iter().map(|event| event.event.as_str()).collect();
    assert_eq!(names, ["increment", "increment", "end"]);
}

#[tokio::test]
async fn two_clients_see_the_same_bytes_as_every_other_way_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::pausing(Duration::from_micros(500))).await;
    let id = server.submit(&request("shared", 300)).await;
    let (one, two) = (server.stream(&id, None).await, server.stream(&id, None).await);
    let (one, two) = tokio::join!(one.rest(), two.rest());
    assert_eq!(one, two);
    assert_eq!(one.len(), 301);
    let data: Vec<&str> = one[..300].iter().map(|event| event.data.as_str()).collect();
    assert_eq!(server.lines(&id).await, data);
    let page = server.get(&format!("/v1/jobs/{id}/increments")).await.text().await.expect("a body");
    assert_eq!(page, format!("{{\"increments\":[{}],\"next_after\":299}}", data.join(",")));
}

#[tokio::test]
async fn lines_resume_too_and_hold_increments_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("lines", 10)).await;
    let answer = server
        .ask(Method::GET, &format!("/v1/jobs/{id}/stream"))
        .header("accept", "application/x-ndjson")
        .header("last-event-id", "6")
        .send()
        .await
        .expect("an answer");
    assert_eq!(answer.headers()["content-type"], "application/x-ndjson");
    let text = answer.text().await.expect("a body");
    assert!(text.ends_with("}\n"));
    assert_eq!(indices(text.lines()), [7, 8, 9]);
}

#[tokio::test]
async fn deleting_a_job_ends_its_streams() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::holding_at(1)).await;
    let id = server.submit(&request("held", 4)).await;
    let mut stream = server.stream(&id, None).await;
    assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some("0"));
    server.ask(Method::DELETE, &format!("/v1/jobs/{id}")).send().await.expect("an answer");
    let names: Vec<String> = stream.rest().await.into_iter().map(|event| event.event).collect();
    assert_eq!(names, ["deleted"]);
}

#[tokio::test]
async fn a_server_without_workers_streams_and_cancels_what_another_process_solves() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let idle = Settings { workers: 0, ..settings() };
    let front = TestServer::start_with(&database, MadeUp::default(), idle).await;
    // A cancel is seen there when the lease is prolonged.
    let back = TestServer::start_with(&database, MadeUp::holding_at(3), short_leases()).await;
    let id = front.submit(&request("elsewhere", 10)).await;
    let mut stream = front.stream(&id, None).await;
    for index in ["0", "1", "2"] {
        assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some(index));
    }
    front.post(&format!("/v1/jobs/{id}/cancel"), &Value::Null).await;
    let rest = stream.rest().await;
    assert_eq!(rest.len(), 1);
    let job: Value = serde_json::from_str(&rest[0].data).expect("a job");
    assert_eq!(job["status"], "cancelled");
    assert!(back.stop().await && front.stop().await);
}
