//! Every error is a problem document with a stable type, and tells nothing of the machine.

use crate::common::bad_documents::bad_documents;
use crate::common::server::TestServer;
use crate::common::service::request;
use crate::common::solver::MadeUp;
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, RequestBuilder};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Sends, and checks what holds for every error.
async fn problem(ask: RequestBuilder, status: u16, kind: &str) -> Value {
    let answer = ask.send().await.expect("an answer");
    assert_eq!(answer.status(), status, "{kind}");
    assert_eq!(answer.headers()["content-type"], "application/problem+json", "{kind}");
    assert!(answer.headers().contains_key("x-request-id"), "{kind}");
    let text = answer.text().await.expect("a body");
    for leak in [
        "deserialize",
        "invalid digit",
        "expected one of",
        "SELECT",
        "INSERT",
        "sqlx",
        "sqlite",
        "src/",
        ".rs",
        "/tmp",
        "panicked",
    ] {
        assert!(!text.contains(leak), "{text}");
    }
    let problem: Value = serde_json::from_str(&text).expect("a problem");
    assert_eq!(problem["type"], format!("/problems/{kind}"));
    assert_eq!(problem["status"], status);
    assert!(problem["title"].is_string() && problem["detail"].is_string(), "{problem}");
    problem
}

#[tokio::test]
async fn headers_say_one_thing_or_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("one", 3)).await;
    let post = || server.ask(Method::POST, "/v1/jobs").json(&request("two", 3));
    let twice = post().header("idempotency-key", "a").header("idempotency-key", "b");
    assert!(problem(twice, 400, "invalid-parameter").await["detail"].as_str().expect("a text").contains("twice"));
    problem(post().header("idempotency-key", "a\tb"), 400, "invalid-parameter").await;
    problem(post().header("content-encoding", "gzip"), 415, "unsupported-media-type").await;
    let stream = server.ask(Method::GET, &format!("/v1/jobs/{id}/stream"));
    problem(stream.header("last-event-id", "1").header("last-event-id", "2"), 400, "invalid-parameter").await;
    let mut bare = TcpStream::connect(server.address()).await.expect("a connection");
    bare.write_all(b"GET /healthz HTTP/1.1\r\nConnection: close\r\n\r\n").await.expect("sent");
    let mut answer = String::new();
    bare.read_to_string(&mut answer).await.expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 400 ") && answer.contains("one header Host"), "{answer}");
}

/// What somebody meant by a parameter that there is not would not be done.
#[tokio::test]
async fn parameters_that_a_call_does_not_have_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("one", 3)).await;
    let place = format!("/v1/jobs/{id}");
    for (method, path, told) in [
        (Method::DELETE, format!("{place}?dry_run=true"), "there is no parameter `dry_run`; this call has none"),
        (Method::POST, format!("{place}/follow?validate=true"), "there is no parameter `validate`"),
        (Method::POST, format!("{place}/cancel?x"), "there is no parameter `x`"),
        (Method::GET, format!("{place}/path.csv?limit=2"), "there is no parameter `limit`"),
        (Method::GET, format!("{place}/results.pvd?limit=2"), "there is no parameter `limit`"),
        (Method::GET, format!("{place}/increments?afer=2"), "did you mean `after`?"),
        (Method::GET, "/v1/scenes?foo=1".to_owned(), "there is no parameter `foo`"),
        (Method::GET, "/healthz?foo=1".to_owned(), "there is no parameter `foo`"),
        (Method::GET, "/v1/jobs?parent=nonsense".to_owned(), "parent: found `nonsense`"),
    ] {
        let answer = server.ask(method, &path).send().await.expect("an answer");
        assert_eq!(answer.status(), 400, "{path}");
        let problem: Value = answer.json().await.expect("a problem");
        assert_eq!(problem["type"], "/problems/invalid-parameter", "{path}");
        assert!(problem["detail"].as_str().expect("a text").contains(told), "{path}: {problem}");
    }
    assert_eq!(server.get(&place).await.status(), 200, "nothing was deleted");
    assert_eq!(server.get(&format!("{place}?")).await.status(), 200);
}

#[tokio::test]
async fn addresses_and_methods() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let unknown = "00000000-0000-7000-8000-000000000000";
    for path in ["/nothing", "/v1", "/v1/jobs/", "/docs/nothing", "/v1/scenes/nothing"] {
        problem(server.ask(Method::GET, path), 404, "not-found").await;
    }
    for path in
        ["", "/increments", "/stream", "/path.csv", "/results.pvd", "/results.parquet", "/picture.svg", "/picture.png"]
    {
        problem(server.ask(Method::GET, &format!("/v1/jobs/{unknown}{path}")), 404, "not-found").await;
    }
    problem(server.ask(Method::POST, &format!("/v1/jobs/{unknown}/cancel")), 404, "not-found").await;
    problem(server.ask(Method::DELETE, &format!("/v1/jobs/{unknown}")), 404, "not-found").await;
    problem(server.ask(Method::PUT, "/v1/jobs"), 405, "method-not-allowed").await;
    problem(server.ask(Method::POST, "/healthz"), 405, "method-not-allowed").await;
    let answer = server.ask(Method::PATCH, "/v1/jobs").send().await.expect("an answer");
    assert!(answer.headers()["allow"].to_str().expect("text").contains("POST"));
}

#[tokio::test]
async fn parameters_and_headers() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("errors", 1)).await;
    for query in ["limit=0", "limit=201", "limit=-1", "limit=x", "status=done", "cursor=1", "colour=red"] {
        problem(server.ask(Method::GET, &format!("/v1/jobs?{query}")), 400, "invalid-parameter").await;
    }
    for query in ["limit=0", "limit=10001", "after=-1", "after=x", "before=1"] {
        let path = format!("/v1/jobs/{id}/increments?{query}");
        problem(server.ask(Method::GET, &path), 400, "invalid-parameter").await;
    }
    for path in ["/v1/jobs/1", "/v1/jobs/x/stream", "/v1/jobs/x/increments", "/v1/jobs/x/path.csv"] {
        problem(server.ask(Method::GET, path), 400, "invalid-parameter").await;
    }
    for (query, told) in [
        ("limit=x", "limit: found `x`; a whole number from 1 to 200 is expected"),
        ("limit=2&status=done", "status: found `done`; `queued`, `running`"),
        ("cursor=%26", "cursor: found `&`; the `next_cursor`"),
        ("stauts=queued", "there is no parameter `stauts`; did you mean `status`?"),
        ("limit=1&limit=2", "limit: it stands twice"),
        ("=", "there is no parameter ``; known: `status`, `sweep`, `parent`, `cursor`, `limit`"),
    ] {
        let problem = problem(server.ask(Method::GET, &format!("/v1/jobs?{query}")), 400, "invalid-parameter").await;
        assert!(problem["detail"].as_str().expect("text").starts_with(told), "{query}: {problem}");
    }
    let stream = format!("/v1/jobs/{id}/stream");
    for last in ["x", "-1", "1.5"] {
        let ask = server.ask(Method::GET, &stream).header("last-event-id", last);
        problem(ask, 400, "invalid-parameter").await;
    }
    for refused in ["image/png", "*/*;q=0", "text/event-stream;q=0, application/x-ndjson;q=0.0"] {
        problem(server.ask(Method::GET, &stream).header("accept", refused), 406, "not-acceptable").await;
    }
    let lines = server.ask(Method::GET, &stream).header("accept", "text/event-stream;q=0, */*").send().await;
    assert_eq!(lines.expect("an answer").headers()["content-type"], "application/x-ndjson");
    let post = || server.ask(Method::POST, "/v1/jobs").json(&request("errors", 1));
    problem(post().header("idempotency-key", ""), 400, "invalid-parameter").await;
    problem(post().header("idempotency-key", "k".repeat(256)), 400, "invalid-parameter").await;
    problem(server.ask(Method::POST, "/v1/jobs?validate=perhaps").json(&json!({})), 400, "invalid-parameter").await;
}

#[tokio::test]
async fn bodies() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let post = |content_type: &str, body: Vec<u8>| {
        server.ask(Method::POST, "/v1/jobs").header("content-type", content_type).body(body)
    };
    let sound = request("errors", 1).to_string().into_bytes();
    for content_type in ["text/plain", "application/xml", "application/x-www-form-urlencoded", ""] {
        problem(post(content_type, sound.clone()), 415, "unsupported-media-type").await;
    }
    problem(server.ask(Method::POST, "/v1/jobs").body(sound), 415, "unsupported-media-type").await;
    for body in ["", "{", "nonsense", "{\"model\": }", "{} {}", "\u{1}"] {
        problem(post("application/json", body.as_bytes().to_vec()), 400, "invalid-json").await;
    }
    problem(post("application/json", vec![b'"', 0xff, b'"']), 400, "invalid-json").await;
    problem(post("application/json", "[".repeat(100_000).into_bytes()), 400, "invalid-json").await;
    for body in ["{}", "[]", "null", "7", "{\"model\": 1}", "{\"model\": {}, \"colour\": 1}"] {
        let problem = problem(post("application/json", body.as_bytes().to_vec()), 422, "invalid-model").await;
        let errors = problem["errors"].as_array().expect("errors");
        assert!(!errors.is_empty());
        assert!(errors.iter().all(|error| error["pointer"].is_string() && error["detail"].is_string()));
    }
    let too_large = vec![b' '; (16 << 20) + 1];
    problem(post("application/json; charset=utf-8", too_large), 413, "body-too-large").await;
    assert_eq!(server.get_json("/v1/jobs").await["jobs"], json!([]));
}

#[tokio::test]
async fn every_bad_document_is_refused_with_its_pointer() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    for document in bad_documents() {
        let post = server.ask(Method::POST, "/v1/jobs").header("content-type", "application/json");
        let answer = post.body(document.text).send().await.expect("an answer");
        let status = answer.status().as_u16();
        let problem: Value = answer.json().await.expect("a problem");
        let kind = problem["type"].as_str().expect("a type");
        match (status, kind) {
            (400, "/problems/invalid-json") | (422, "/problems/invalid-model") => {
                let errors = problem["errors"].as_array().expect("errors");
                assert!(
                    errors.iter().any(|error| error["pointer"] == document.pointer),
                    "{}: {problem}",
                    document.name
                );
            }
            (413, "/problems/body-too-large") => {}
            _ => panic!("{}: {problem}", document.name),
        }
    }
    assert_eq!(server.get_json("/v1/jobs").await["jobs"], json!([]));
}
