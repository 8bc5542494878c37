//! Jobs over HTTP: submitted, listed, read, cancelled, deleted.

use crate::common::server::TestServer;
use crate::common::service::{indices, request};
use crate::common::solver::{LOCATES, MadeUp, PANICS};
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use std::time::Duration;

#[tokio::test]
async fn a_job_is_queued_with_its_plan_and_runs_to_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let answer = server.post("/v1/jobs", &request("one", 1234)).await;
    assert_eq!(answer.status(), StatusCode::ACCEPTED);
    let location = answer.headers()["location"].to_str().expect("text").to_owned();
    let queued: Value = answer.json().await.expect("a job");
    assert_eq!(location, format!("/v1/jobs/{}", queued["id"].as_str().expect("an id")));
    assert_eq!(queued["name"], "one");
    assert_eq!(queued["plan"]["unknowns"], 2);

    let id = queued["id"].as_str().expect("an id");
    let job = server.ended(id).await;
    assert_eq!(job["status"], "completed");
    assert_eq!(job["stop_reason"], "max_increments");
    assert_eq!(job["report"]["increments"], 1234);
    assert_eq!(job["progress"], json!({"increments": 1233, "last_index": 1233, "max_increments": 1234}));
    assert!(job["error"].is_null());

    // The whole path, read a page at a time.
    let (mut after, mut seen) = (None, Vec::new());
    loop {
        let query = after.map_or(String::new(), |after: u64| format!("&after={after}"));
        let page = server.get_json(&format!("/v1/jobs/{id}/increments?limit=500{query}")).await;
        let increments = page["increments"].as_array().expect("increments");
        after = page["next_after"].as_u64();
        if increments.is_empty() {
            break;
        }
        seen.extend(increments.iter().map(|increment| increment["index"].as_u64().expect("an index")));
    }
    assert_eq!(after, Some(1233));
    assert_eq!(seen, (0..1234).collect::<Vec<_>>());
}

#[tokio::test]
async fn progress_says_that_a_bifurcation_point_is_being_located() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(2);
    let server = TestServer::start(&folder.path().join("jobs.db"), solver.clone()).await;
    let answer = server.post("/v1/jobs", &request(LOCATES, 5)).await;
    let queued: Value = answer.json().await.expect("a job");
    assert_eq!(queued["progress"].get("locating_bifurcation"), None);
    let id = queued["id"].as_str().expect("an id");
    let is_locating = |job: &Value| job["progress"].get("locating_bifurcation") == Some(&json!(true));
    // It waits there, and says so as often as it is asked.
    while !is_locating(&server.get_json(&format!("/v1/jobs/{id}")).await) {
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
    solver.let_go();
    let job = server.ended(id).await;
    assert_eq!(job["progress"], json!({"increments": 4, "last_index": 4, "max_increments": 5}));
}

#[tokio::test]
async fn validating_answers_the_plan_and_queues_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let answer = server.post("/v1/jobs?validate=true", &request("one", 5)).await;
    assert_eq!(answer.status(), StatusCode::OK);
    let plan: Value = answer.json().await.expect("a plan");
    assert_eq!(plan["unknowns"], 2);
    assert_eq!(server.get_json("/v1/jobs").await["jobs"], json!([]));
}

#[tokio::test]
async fn an_idempotency_key_gives_the_same_job_for_the_same_body_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let post = |body: Value| server.ask(Method::POST, "/v1/jobs").header("idempotency-key", "k-1").json(&body).send();
    let first: Value = post(request("one", 5)).await.expect("an answer").json().await.expect("a job");
    let again = post(request("one", 5)).await.expect("an answer");
    assert_eq!(again.status(), StatusCode::ACCEPTED);
    let again: Value = again.json().await.expect("a job");
    assert_eq!(first["id"], again["id"]);
    let other = post(request("two", 5)).await.expect("an answer");
    assert_eq!(other.status(), StatusCode::UNPROCESSABLE_ENTITY);
    let problem: Value = other.json().await.expect("a problem");
    assert_eq!(problem["type"], "/problems/idempotency-key-reused");
    assert_eq!(server.get_json("/v1/jobs").await["jobs"].as_array().map(Vec::len), Some(1));
}

#[tokio::test]
async fn cancelling_stops_a_running_job_and_keeps_what_is_stored() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::holding_at(7)).await;
    let id = server.submit(&request("held", 100)).await;
    server.until(&id, |job| job["progress"]["increments"] == 6).await;
    let answer = server.post(&format!("/v1/jobs/{id}/cancel"), &Value::Null).await;
    assert_eq!(answer.status(), StatusCode::ACCEPTED);
    let job = server.ended(&id).await;
    assert_eq!(job["status"], "cancelled");
    assert_eq!(job["stop_reason"], "cancelled");
    let lines = server.lines(&id).await;
    assert_eq!(indices(lines.iter().map(String::as_str)), (0..7).collect::<Vec<_>>());
    // An ended job stays as it is.
    let again = server.post(&format!("/v1/jobs/{id}/cancel"), &Value::Null).await;
    assert_eq!(again.status(), StatusCode::ACCEPTED);
    assert_eq!(server.ended(&id).await, job);
}

#[tokio::test]
async fn cancelling_a_waiting_job_ends_it_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut settings = crate::common::server::settings();
    settings.workers = 0;
    let server = TestServer::start_with(&folder.path().join("jobs.db"), MadeUp::default(), settings).await;
    let id = server.submit(&request("waiting", 5)).await;
    let answer = server.post(&format!("/v1/jobs/{id}/cancel"), &Value::Null).await;
    let job: Value = answer.json().await.expect("a job");
    assert_eq!(job["status"], "cancelled");
    assert!(job["started_at"].is_null());
}

#[tokio::test]
async fn deleting_drops_a_job_even_while_it_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::pausing(Duration::from_millis(1))).await;
    let id = server.submit(&request("long", 100_000)).await;
    server.until(&id, |job| job["progress"]["increments"].as_u64() > Some(0)).await;
    let path = format!("/v1/jobs/{id}");
    let answer = server.ask(Method::DELETE, &path).send().await.expect("an answer");
    assert_eq!(answer.status(), StatusCode::NO_CONTENT);
    for gone in [path.clone(), format!("{path}/increments"), format!("{path}/stream"), format!("{path}/path.csv")] {
        assert_eq!(server.get(&gone).await.status(), StatusCode::NOT_FOUND);
    }
    // Its worker is free again.
    let next = server.submit(&request("next", 5)).await;
    assert_eq!(server.ended(&next).await["status"], "completed");
}

#[tokio::test]
async fn lists_go_newest_first_by_cursor_and_status() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let mut ids = Vec::new();
    for number in 0..5 {
        ids.push(server.submit(&request(&format!("job {number}"), 2)).await);
    }
    for id in &ids {
        server.ended(id).await;
    }
    ids.reverse();
    let (mut cursor, mut seen) = (String::new(), Vec::new());
    loop {
        let page = server.get_json(&format!("/v1/jobs?limit=2&status=completed{cursor}")).await;
        let jobs = page["jobs"].as_array().expect("jobs").clone();
        seen.extend(jobs.iter().map(|job| job["id"].as_str().expect("an id").to_owned()));
        match page["next_cursor"].as_str() {
            Some(next) => cursor = format!("&cursor={next}"),
            None => break,
        }
    }
    assert_eq!(seen, ids);
    assert_eq!(server.get_json("/v1/jobs?status=failed").await, json!({"jobs": [], "next_cursor": null}));
}

#[tokio::test]
async fn a_panic_in_a_solve_fails_that_job_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let doomed = server.submit(&request(PANICS, 10)).await;
    let sound = server.submit(&request("sound", 10)).await;
    let job = server.ended(&doomed).await;
    assert_eq!(job["status"], "failed");
    assert!(job["error"].as_str().expect("a text").contains("a made-up defect"));
    // What converged before stands.
    assert_eq!(job["progress"]["increments"], 2);
    assert_eq!(server.ended(&sound).await["status"], "completed");
    assert_eq!(server.get("/readyz").await.status(), StatusCode::OK);
}

#[tokio::test]
async fn the_path_is_a_table_with_named_columns() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let id = server.submit(&request("table", 700)).await;
    server.ended(&id).await;
    let answer = server.get(&format!("/v1/jobs/{id}/path.csv")).await;
    assert_eq!(answer.headers()["content-type"], "text/csv; charset=utf-8");
    let text = answer.text().await.expect("a body");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    assert_eq!(
        header[..14],
        [
            "index",
            "stage",
            "load_factor",
            "arc_length",
            "step",
            "point",
            "bifurcation",
            "event",
            "pin.x",
            "pin.y",
            "tip.x",
            "tip.y",
            "tip/floor.status",
            "tip/floor.gap"
        ]
    );
    let rows: Vec<&str> = lines.collect();
    assert_eq!(rows.len(), 700);
    assert!(rows[0].starts_with("0,\"push, \"\"slowly\"\"\",0.0,0.0,0.1,start,false,,"), "{}", rows[0]);
    assert!(rows[3].contains(",-1e-300,"), "{}", rows[3]);
}

/// The files of an archive with their texts or bytes.
async fn unpacked(server: &TestServer, place: &str) -> Vec<(String, Vec<u8>)> {
    let answer = server.get(place).await;
    assert_eq!(answer.headers()["content-type"], "application/zip");
    let bytes = std::io::Cursor::new(answer.bytes().await.expect("a body"));
    let mut archive = zip::ZipArchive::new(bytes).expect("an archive");
    let mut files = Vec::new();
    for place in 0..archive.len() {
        let mut file = archive.by_index(place).expect("a file");
        let mut content = Vec::new();
        std::io::Read::read_to_end(&mut file, &mut content).expect("its content");
        let name = file.name().expect("a name").into_owned();
        files.push((name, content));
    }
    files
}

/// That the values are those of the increments is seen by `tests/result_files.sh`, with the programs the files are for.
#[tokio::test]
async fn the_path_is_there_for_other_programs_while_it_grows_and_after() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(600);
    let server = TestServer::start(&folder.path().join("jobs.db"), solver.clone()).await;
    let id = server.submit(&request("files", 700)).await;
    let job = server.until(&id, |job| job["progress"]["increments"] == 599).await;
    let (pvd, parquet) = (&job["links"]["results_pvd"], &job["links"]["results_parquet"]);
    let (pvd, parquet) = (pvd.as_str().expect("a place"), parquet.as_str().expect("a place"));
    assert_eq!(unpacked(&server, pvd).await.len(), 601);
    solver.let_go();
    server.ended(&id).await;
    let files = unpacked(&server, pvd).await;
    assert_eq!(files.len(), 701);
    let (name, list) = files.last().expect("a list");
    let list = String::from_utf8(list.clone()).expect("text");
    assert_eq!((name.as_str(), list.matches("<DataSet ").count()), ("path.pvd", 700));
    let times: Vec<f64> =
        list.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse().unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "times rise");
    for (name, piece) in &files[..700] {
        assert!(list.contains(name.as_str()));
        let piece = String::from_utf8(piece.clone()).expect("text");
        let document = roxmltree::Document::parse(&piece).expect("XML");
        let array = |name: &str| document.descendants().any(|node| node.attribute("Name") == Some(name));
        assert!(array("displacement") && array("contact_status") && array("load_factor") && array("event"));
    }
    let files = unpacked(&server, parquet).await;
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["increments.parquet", "nodes.parquet", "elements.parquet", "contacts.parquet"]);
    assert!(files.iter().all(|(_, bytes)| bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1")));
    assert_eq!(unpacked(&server, parquet).await, files);
}

#[tokio::test]
async fn a_failed_job_can_be_queued_again_and_another_cannot() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let retry = async |id: &str| {
        let answer = server.ask(Method::POST, &format!("/v1/jobs/{id}/retry")).send().await.expect("an answer");
        let (status, place) = (answer.status(), answer.headers().get("location").cloned());
        (status, place, answer.json::<Value>().await.expect("JSON"))
    };
    let id = server.submit(&request(PANICS, 10)).await;
    assert_eq!(server.ended(&id).await["status"], "failed");
    let (status, place, again) = retry(&id).await;
    assert_eq!((status, &again["id"], &again["error"]), (StatusCode::ACCEPTED, &json!(id), &Value::Null));
    assert_eq!(place.expect("a place"), format!("/v1/jobs/{id}").as_str());
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&json!("failed"), &json!(2)), "{job}");
    let whole = server.submit(&request("whole", 3)).await;
    server.ended(&whole).await;
    let (status, _, problem) = retry(&whole).await;
    assert_eq!((status, &problem["type"]), (StatusCode::CONFLICT, &json!("/problems/not-retryable")));
    assert!(problem["detail"].as_str().expect("text").contains("is completed; only one that has failed"), "{problem}");
    let (status, ..) = retry("00000000-0000-7000-8000-000000000000").await;
    assert_eq!(status, StatusCode::NOT_FOUND);
}
