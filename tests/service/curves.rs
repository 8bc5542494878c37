//! Curves of limit points over HTTP: of a job and of a model, streamed, read, resumed, cancelled and deleted; mistakes.

use crate::common::process::PATIENCE;
use crate::common::server::{EventStream, TestServer};
use crate::common::service::scene;
use arcslip::service::jobs::PathSolver;
use reqwest::Method;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const FRICTION: &str = "/model/contacts/*/friction";

async fn accepted(server: &TestServer, place: &str, request: &Value) -> String {
    let answer = server.post(place, request).await;
    let (status, location) = (answer.status(), answer.headers().get("location").cloned());
    let curve: Value = answer.json().await.expect("JSON");
    assert_eq!(status, 202, "{curve}");
    let place = location.expect("a place").to_str().expect("text").to_owned();
    assert_eq!(curve["links"]["self"], place.as_str());
    place
}

async fn ended(server: &TestServer, place: &str) -> Value {
    let began = Instant::now();
    loop {
        let curve = server.get_json(place).await;
        if !curve["ended_at"].is_null() {
            return curve;
        }
        assert!(began.elapsed() < PATIENCE, "still {curve}");
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

#[tokio::test]
async fn a_limit_point_of_a_job_is_followed_in_friction() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let id = server.submit(&scene("arch-type-truss")).await;
    server.ended(&id).await;
    let increments = server.get_json(&format!("/v1/jobs/{id}/increments")).await;
    let all = increments["increments"].as_array().expect("increments");
    let limit = all.iter().find(|one| one["point"]["kind"] == "smooth_limit").expect("a limit point");
    let settings = json!({"parameter": FRICTION, "range": [0, 1], "step": 0.1, "increment": limit["index"]});
    let place = accepted(&server, &format!("/v1/jobs/{id}/continue"), &settings).await;

    let stream = server.ask(Method::GET, &format!("{place}/stream")).send().await.expect("an answer");
    let events = EventStream::of(stream).rest().await;
    let rows: Vec<Value> = events
        .iter()
        .filter(|event| event.event == "row")
        .map(|event| serde_json::from_str(&event.data).expect("JSON"))
        .collect();
    assert_eq!(events.last().expect("an event").event, "end");
    assert_eq!(rows.len(), 11);
    assert_eq!((&rows[0]["value"], &rows[0]["from_path"]), (&json!(0.4), &json!(true)));
    // The point itself, found once more by its own equations.
    for (node, moved) in limit["displacements"].as_object().expect("displacements") {
        for (one, other) in
            moved.as_array().expect("components").iter().zip(rows[0]["displacements"][node].as_array().unwrap())
        {
            assert!((one.as_f64().unwrap() - other.as_f64().unwrap()).abs() < 1e-7, "{node}: {one} {other}");
        }
    }
    let curve = ended(&server, &place).await;
    assert_eq!((&curve["status"], &curve["report"]["complete"]), (&json!("completed"), &json!(true)));
    assert_eq!(curve["progress"], json!({"points": 11, "of": 11}));
    let page = server.get_json(&format!("{place}/rows?limit=4")).await;
    assert_eq!(page["rows"].as_array().expect("rows"), &rows[..4]);
    assert_eq!(page["next_after"], 3);
    let table = server.get(&format!("{place}/table.csv")).await.text().await.expect("text");
    assert_eq!(table.lines().count(), 12);
    let values: Vec<f64> =
        table.lines().skip(1).map(|line| line.split(',').nth(1).expect("a value").parse().expect("a number")).collect();
    assert!(values.is_sorted() && values[0] == 0.0 && values[10] == 1.0, "{values:?}");
    assert!(server.get(&format!("{place}/table.txt")).await.text().await.expect("text").contains("smooth_limit"));
    let svg = server.get(&format!("{place}/picture.svg")).await.text().await.expect("text");
    roxmltree::Document::parse(&svg).expect("XML");
    assert_eq!(server.get_json("/v1/curves").await["curves"][0]["id"], curve["id"]);
    assert!(server.get_json("/v1/jobs").await["jobs"].as_array().expect("jobs").len() == 1, "a curve is no job");
    assert!(server.stop().await);

    // The same points, bit for bit, of the whole model posted with its settings, and after a restart.
    let server = TestServer::start(&database, PathSolver).await;
    let mut whole = scene("arch-type-truss");
    whole["curve"] = json!({"parameter": FRICTION, "range": [0, 1], "step": 0.1});
    let other = accepted(&server, "/v1/curves", &whole).await;
    ended(&server, &other).await;
    assert_eq!(server.get_json(&format!("{other}/rows")).await["rows"].as_array().expect("rows"), &rows);
    let plan: Value = server.post("/v1/curves?validate=true", &whole).await.json().await.expect("a plan");
    assert_eq!((&plan["points"], &plan["start"]), (&json!(11), &json!(0.4)));
    assert_eq!(server.ask(Method::DELETE, &place).send().await.expect("an answer").status(), 204);
    assert_eq!(server.get(&place).await.status(), 404);
    let gone: Value = server.get(&place).await.json().await.expect("JSON");
    assert!(gone["detail"].as_str().expect("a detail").contains("curve"), "{gone}");
}

#[tokio::test]
async fn mistakes_of_a_curve_are_told_at_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let id = server.submit(&scene("von-mises-truss")).await;
    server.ended(&id).await;
    let at = "/model/nodes/apex/1";
    for (settings, pointer, told) in [
        (json!({"parameter": at, "range": [0.6, 0.9]}), "/range", "own value 0.5"),
        (json!({"parameter": at, "range": [0.9, 0.2]}), "/range", "the second larger"),
        (json!({"parameter": at, "range": [0.2, 0.9], "step": 1e-9}), "/step", "10000 steps"),
        (json!({"parameter": at, "range": [0.2, 0.9], "limit_point": 0}), "/limit_point", "from 1"),
        (json!({"parameter": at, "range": [0.2, 0.9], "limit_point": 1, "increment": 3}), "", "leave one out"),
        (json!({"parameter": at, "range": [0.2, 0.9], "increment": 1}), "/increment", "cannot be followed"),
        (json!({"parameter": at, "range": [0.2, 0.9], "increment": 999}), "/increment", "not stored"),
        (json!({"parameter": "/model/name", "range": [0.2, 0.9]}), "/parameter", "a number is expected"),
        (json!({"parameter": "/analysis/max_increments", "range": [1, 9]}), "/parameter", "`/model/`"),
        (
            json!({"parameter": "/model/contacts/0/friction", "range": [0, 1]}),
            "/parameter",
            "`/model/contacts/0/friction`",
        ),
        (json!({"parameter": at, "range": [0.2, 0.9], "steps": 3}), "/steps", "step"),
    ] {
        let answer = server.post(&format!("/v1/jobs/{id}/continue"), &settings).await;
        assert_eq!(answer.status(), 422, "{settings}");
        let problem: Value = answer.json().await.expect("a problem");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], pointer, "{settings}: {problem}");
        assert!(error["detail"].as_str().expect("a detail").contains(told), "{settings}: {problem}");
    }
    // What only the path tells ends the curve, with its reason.
    let settings = json!({"parameter": at, "range": [0.2, 0.9], "limit_point": 7});
    let place = accepted(&server, &format!("/v1/jobs/{id}/continue"), &settings).await;
    let curve = ended(&server, &place).await;
    assert_eq!((&curve["status"], &curve["stop_reason"]), (&json!("stopped"), &json!("no_limit_point")));
    assert!(curve["error"].as_str().expect("a reason").contains("limit point 7 was asked for"), "{curve}");
    assert_eq!(server.get(&format!("{place}/picture.svg")).await.status(), 404);
}
