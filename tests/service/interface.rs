//! What the service says of itself, and that every way to a path gives the same bytes.

use crate::common::server::TestServer;
use crate::common::service::{indices, request, without_elapsed};
use crate::common::solver::MadeUp;
use arcslip::model::input::limits;
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, StatusCode};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

fn arcslip() -> Command {
    Command::new(env!("CARGO_BIN_EXE_arcslip"))
}

#[tokio::test]
async fn the_committed_description_is_the_one_that_is_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let served = server.get("/openapi.json").await.text().await.expect("a body");
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi/openapi.json");
    let committed = std::fs::read_to_string(committed).expect("the committed description");
    assert!(served == committed, "write it anew: cargo run -- openapi > openapi/openapi.json");
    let document: Value = serde_json::from_str(&committed).expect("JSON");
    // Two types of one Rust name must not become one schema.
    let schemas = &document["components"]["schemas"];
    assert_eq!(schemas["Status"]["enum"][0], "free");
    assert_eq!(schemas["JobStatus"]["enum"][0], "queued");
    let printed = arcslip().arg("openapi").output().expect("the program runs");
    assert_eq!(String::from_utf8(printed.stdout).expect("text"), committed);
}

/// The bounds that stand with the fields are those that requests are held to.
#[test]
fn the_description_s_bounds_are_the_model_s_limits() {
    let document: Value =
        serde_json::from_str(&arcslip::service::http::router::openapi_json().expect("a document")).expect("JSON");
    for (schema, field, bound, limit) in [
        ("Analysis", "max_increments", "maximum", limits::MAX_INCREMENTS),
        ("FollowRequest", "max_increments", "maximum", limits::MAX_INCREMENTS),
        ("Analysis", "max_modes", "maximum", limits::MAX_MODES),
        ("Explore", "depth", "maximum", limits::MAX_EXPLORE_DEPTH),
        ("Explore", "max_jobs", "maximum", limits::MAX_EXPLORE_JOBS),
        ("Regularised", "desired_iterations", "maximum", limits::MAX_DESIRED_ITERATIONS),
        ("StudySettings", "repeats", "maximum", limits::MAX_STUDY_REPEATS),
        ("StudySettings", "refinement", "maximum", limits::MAX_STUDY_REFINEMENT),
        ("StudySettings", "arc_lengths", "maxItems", limits::MAX_STUDY_RUNGS as u64),
    ] {
        let found = &document["components"]["schemas"][schema]["properties"][field][bound];
        assert_eq!(found.as_f64(), Some(limit as f64), "{schema}.{field}");
    }
}

#[tokio::test]
async fn pages_probes_and_request_ids() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    assert_eq!(server.get_json("/healthz").await["status"], "alive");
    assert_eq!(server.get_json("/readyz").await["workers"], 2);
    assert!(server.get("/").await.text().await.expect("a body").contains("/assets/main.js"));
    let docs = server.get("/docs").await;
    assert_eq!(docs.status(), StatusCode::OK);
    let docs = docs.text().await.expect("a body");
    assert!(docs.contains("swagger-ui-bundle.js") && !docs.contains("https://"), "the pages work with no network");
    let script = server.get("/docs/swagger-ui-bundle.js").await;
    assert_eq!(script.status(), StatusCode::OK);
    assert!(!script.headers().contains_key("content-encoding"), "gzip is for those who accept it");
    let script = script.text().await.expect("a body");
    assert!(script.contains("SwaggerUIBundle"));
    let asked = server.ask(Method::GET, "/docs/swagger-ui-bundle.js").header("accept-encoding", "gzip");
    let compressed = asked.send().await.expect("an answer");
    assert_eq!(compressed.headers()["content-encoding"], "gzip");
    assert!(3 * compressed.bytes().await.expect("a body").len() < script.len());
    let given = server.ask(Method::GET, "/healthz").header("x-request-id", "mine-1").send().await.expect("an answer");
    assert_eq!(given.headers()["x-request-id"], "mine-1");
    let made = server.ask(Method::GET, "/healthz").header("x-request-id", "a b").send().await.expect("an answer");
    assert_ne!(made.headers()["x-request-id"], "a b");
}

#[tokio::test]
async fn every_built_in_scene_can_be_fetched_and_posted() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let scenes = server.get_json("/v1/scenes").await;
    for scene in scenes["scenes"].as_array().expect("scenes") {
        let mut request = server.get_json(scene["link"].as_str().expect("a link")).await;
        request["analysis"]["max_increments"] = 20.into();
        let id = server.submit(&request).await;
        let job = server.ended(&id).await;
        assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
        let lines = server.lines(&id).await;
        let expected: Vec<u64> = (0..lines.len() as u64).collect();
        assert_eq!(indices(lines.iter().map(String::as_str)), expected);
    }
}

#[tokio::test]
async fn http_and_solve_give_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let scene = server.get_json("/v1/scenes/klarbring").await;
    let id = server.submit(&scene).await;
    server.ended(&id).await;
    let solved = arcslip().args(["solve", "klarbring"]).output().expect("the program runs");
    let solved = String::from_utf8(solved.stdout).expect("text");
    assert!(!solved.is_empty());
    let strip = |lines: Vec<&str>| lines.into_iter().map(without_elapsed).collect::<Vec<_>>();
    let served = server.lines(&id).await;
    assert_eq!(strip(served.iter().map(String::as_str).collect()), strip(solved.lines().collect()));

    let table = arcslip().args(["solve", "klarbring", "--format", "csv"]).output().expect("the program runs");
    let table = String::from_utf8(table.stdout).expect("text");
    let served = server.get(&format!("/v1/jobs/{id}/path.csv")).await.text().await.expect("a body");
    let timeless = |table: &str| -> Vec<Vec<String>> {
        let place = table.lines().next().and_then(|header| header.split(',').position(|name| name == "elapsed_s"));
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut rows: Vec<Vec<String>> = table.lines().map(cells).collect();
        for row in &mut rows {
            row.remove(place.expect("a column"));
        }
        rows
    };
    assert_eq!(timeless(&table), timeless(&served));
}

#[test]
fn commands_end_with_their_status() {
    let status = |command: &mut Command| command.output().expect("the program runs").status.code();
    assert_eq!(status(arcslip().args(["check", "klarbring"])), Some(0));
    assert_eq!(status(arcslip().arg("scenes")), Some(0));
    assert_eq!(status(arcslip().args(["solve", "no such file or scene"])), Some(2));
    assert_eq!(status(arcslip().args(["health", "--url", "http://127.0.0.1:1/readyz"])), Some(1));
    assert!(matches!(status(arcslip().args(["solve", "klarbring"])), Some(0 | 1)));

    let mut child =
        arcslip().args(["check", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs");
    let mut broken: Value = request("broken", 5);
    broken["model"]["colour"] = "red".into();
    let mut input = child.stdin.take().expect("an input");
    input.write_all(broken.to_string().as_bytes()).expect("written");
    drop(input);
    let output = child.wait_with_output().expect("an end");
    assert_eq!(output.status.code(), Some(2));
    let complaint = String::from_utf8(output.stderr).expect("text");
    assert!(complaint.contains("colour") && complaint.lines().all(|line| line.contains(": ")), "{complaint}");
}

#[test]
fn serve_goes_down_on_a_signal_and_exits_well() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = arcslip()
        .args(["serve", "--demo", "--listen", "127.0.0.1:0", "--database"])
        .arg(folder.path().join("jobs.db"))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    let mut greeting = String::new();
    BufReader::new(child.stdout.take().expect("an output")).read_line(&mut greeting).expect("a line");
    let url = greeting.trim().rsplit(' ').next().expect("an address").to_owned();
    let health = arcslip().args(["health", "--url", &format!("{url}/readyz")]).output().expect("the program runs");
    assert_eq!(health.status.code(), Some(0));
    let killed = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill runs");
    assert!(killed.success());
    assert_eq!(child.wait().expect("an end").code(), Some(0));
}
