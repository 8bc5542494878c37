//! The dashboard's parts as they are served, and the calls that are there for it.

use crate::common::server::TestServer;
use crate::common::service::scene;
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, StatusCode};
use serde_json::Value;

async fn server() -> (tempfile::TempDir, TestServer) {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    (folder, server)
}

/// The addresses in a page or script between this text and a quotation mark.
fn addresses(text: &str, before: &str) -> Vec<String> {
    let found = text.split(before).skip(1).filter_map(|rest| rest.split('"').next());
    found.map(str::to_owned).collect()
}

#[tokio::test]
async fn every_part_of_the_page_is_served_and_nothing_of_it_is_elsewhere() {
    let (_folder, server) = server().await;
    let index = server.get("/").await;
    assert_eq!(index.headers()["content-type"], "text/html; charset=utf-8");
    let policy = index.headers()["content-security-policy"].to_str().expect("text").to_owned();
    assert!(
        policy.contains("default-src 'self'") && !policy.contains("script-src") && !policy.contains("eval"),
        "{policy}"
    );
    let page = index.text().await.expect("a page");
    let mut left = addresses(&page, "\"/assets/");
    let asked_at_once = left.clone();
    assert!(left.iter().any(|name| name == "main.js") && left.iter().any(|name| name == "style.css"), "{left:?}");
    let mut seen = Vec::new();
    while let Some(name) = left.pop() {
        if seen.contains(&name) {
            continue;
        }
        let answer = server.get(&format!("/assets/{name}")).await;
        assert_eq!(answer.status(), StatusCode::OK, "{name}");
        let expected = match name.rsplit_once('.').map(|(_, ending)| ending) {
            Some("js") => "text/javascript; charset=utf-8",
            Some("css") => "text/css; charset=utf-8",
            Some("svg") => "image/svg+xml",
            other => panic!("{other:?}"),
        };
        assert_eq!(answer.headers()["content-type"], expected, "{name}");
        assert_eq!(answer.headers()["x-content-type-options"], "nosniff");
        let tag = answer.headers()["etag"].to_str().expect("text").to_owned();
        let known = server.ask(Method::GET, &format!("/assets/{name}")).header("if-none-match", tag).send().await;
        assert_eq!(known.expect("an answer").status(), StatusCode::NOT_MODIFIED, "{name}");
        if name != "plotly.js" && expected.starts_with("text/javascript") {
            left.extend(addresses(&answer.text().await.expect("a script"), "from \"./"));
        }
        seen.push(name);
    }
    assert!(seen.len() > 12, "{seen:?}");
    // A module that is found only when another has been read is waited for.
    assert!(seen.iter().all(|name| asked_at_once.contains(name)), "{seen:?}");
    for nothing in ["nothing.js", "../mod.rs", "%2e%2e/mod.rs", "index.html/"] {
        assert_eq!(server.get(&format!("/assets/{nothing}")).await.status(), StatusCode::NOT_FOUND, "{nothing}");
    }
}

#[tokio::test]
async fn plotly_is_sent_compressed_to_those_who_read_that() {
    let (_folder, server) = server().await;
    let ask =
        |coding: &'static str| server.ask(Method::GET, "/assets/plotly.js").header("accept-encoding", coding).send();
    let plain = ask("identity").await.expect("an answer");
    assert!(!plain.headers().contains_key("content-encoding"));
    let compressed = ask("gzip").await.expect("an answer");
    assert_eq!(compressed.headers()["content-encoding"], "gzip");
    assert_eq!(compressed.headers()["vary"], "accept-encoding");
    assert_ne!(plain.headers()["etag"], compressed.headers()["etag"], "other bytes, another tag");
    let (plain, compressed) = (plain.bytes().await.expect("a body"), compressed.bytes().await.expect("a body"));
    assert!(3 * compressed.len() < plain.len(), "{} of {}", compressed.len(), plain.len());
    let mut read = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&*compressed), &mut read).expect("gzip");
    assert_eq!(read, plain);
}

#[tokio::test]
async fn columns_hold_what_the_increments_hold() {
    let (_folder, server) = server().await;
    let id = server.submit(&scene("one-bar-truss")).await;
    server.ended(&id).await;
    let whole = server.get_json(&format!("/v1/jobs/{id}/increments")).await;
    let whole = whole["increments"].as_array().expect("a list");
    let of = "load_factor,stage,/displacements/tip/0,/diagnostics/residual,/displacements/nobody/0";
    let place = format!("/v1/jobs/{id}/columns?of={of}");
    let all = server.get_json(&place).await;
    let taken = |pointer: &str| whole.iter().map(|line| line.pointer(pointer).cloned().unwrap_or_default()).collect();
    assert_eq!(all["index"], Value::Array(taken("/index")));
    for name in of.split(',') {
        let pointer = if name.starts_with('/') { name.to_owned() } else { format!("/{name}") };
        assert_eq!(all["columns"][name], Value::Array(taken(&pointer)), "{name}");
    }
    let is_special = |line: &&Value| line["point"]["kind"] != "regular" || line["point"]["bifurcation"] == true;
    let special: Vec<_> = whole.iter().filter(is_special).collect();
    let points = all["points"].as_array().expect("a list");
    assert!(special.len() > 3 && special.len() < whole.len());
    assert_eq!(points.len(), special.len());
    for (point, line) in points.iter().zip(special) {
        assert_eq!((&point["index"], &point["point"]), (&line["index"], &line["point"]));
    }
    // A page at a time comes to the same.
    let (mut index, mut after) = (Vec::new(), String::new());
    loop {
        let page = server.get_json(&format!("{place}&limit=30{after}")).await;
        let found = page["index"].as_array().expect("a list").clone();
        if found.is_empty() {
            break;
        }
        assert!(found.len() <= 30);
        index.extend(found);
        after = format!("&after={}", page["next_after"]);
    }
    assert_eq!(Value::Array(index), all["index"]);
    for (wrong, told) in [("of=a,a", "stands twice"), ("limit=0", "1 to 10000"), ("off=a", "no parameter")] {
        let answer = server.get(&format!("/v1/jobs/{id}/columns?{wrong}")).await;
        assert_eq!(answer.status(), StatusCode::BAD_REQUEST, "{wrong}");
        let text = answer.text().await.expect("a problem");
        assert!(text.contains(told), "{text}");
    }
}

/// A request with a mesh is stored as it was posted; expanded, it has the nodes and elements that pages draw.
#[tokio::test]
async fn a_mesh_is_posted_within_the_request() {
    let (_folder, server) = server().await;
    let deck = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPE4,ELSET=body\n1,1,2,3,4\n\
                *NSET,NSET=foot\n1,2\n*SURFACE,NAME=top\nbody,S3\n";
    let request = serde_json::json!({"model": {"dimension": 2, "mesh": {"content": deck},
        "materials": {"rubber": {"kind": "neo_hookean", "young": 1, "poisson": 0.3}},
        "elements": [{"kind": "solid", "group": "body", "material": "rubber"}],
        "supports": {"@foot": ["x", "y"]},
        "stages": [{"name": "press", "pressures": {"top": 0.1}, "until": {"load_above": 1}}]}});
    let id = server.submit(&request).await;
    assert_eq!(server.ended(&id).await["status"], "completed");
    assert_eq!(server.get_json(&format!("/v1/jobs/{id}/request")).await, request);
    let expanded = server.get_json(&format!("/v1/jobs/{id}/request?expanded=true")).await;
    assert_eq!(expanded["model"]["nodes"]["3"], serde_json::json!([1.0, 1.0]));
    assert_eq!(expanded["model"]["elements"][0]["kind"], "quadrilateral4");
    assert_eq!(expanded["model"]["supports"]["2"], serde_json::json!(["x", "y"]));
    let mut by_file = request.clone();
    by_file["model"]["mesh"] = serde_json::json!({"file": "/etc/hostname"});
    let refused = server.post("/v1/jobs", &by_file).await;
    assert_eq!(refused.status(), StatusCode::UNPROCESSABLE_ENTITY);
    let text = refused.text().await.expect("a problem");
    assert!(text.contains("files are opened by the command line alone"), "{text}");
}

#[tokio::test]
async fn a_jobs_request_can_be_posted_again() {
    let (_folder, server) = server().await;
    let id = server.submit(&scene("klarbring")).await;
    let request = server.get_json(&format!("/v1/jobs/{id}/request")).await;
    assert_eq!(request, scene("klarbring"));
    assert_eq!(
        server.get("/v1/jobs/00000000-0000-7000-8000-000000000000/request").await.status(),
        StatusCode::NOT_FOUND
    );
}

#[tokio::test]
async fn the_exact_path_is_given_where_one_is_known() {
    let (_folder, server) = server().await;
    let id = server.submit(&scene("klarbring")).await;
    server.ended(&id).await;
    let exact = server.get_json(&format!("/v1/jobs/{id}/exact?load=3&displacement=7")).await;
    let stages = exact["stages"].as_array().expect("a list");
    let names: Vec<_> = stages.iter().map(|stage| stage["name"].as_str().expect("text")).collect();
    assert_eq!((exact["name"].is_string(), names), (true, vec!["press", "pull"]));
    let numbers = |values: &Value| -> Vec<f64> {
        values.as_array().expect("a list").iter().map(|value| value.as_f64().expect("a number")).collect()
    };
    let (loads, along) = (numbers(&stages[1]["load_factor"]), numbers(&stages[1]["displacements"]["node"][0]));
    assert_eq!(loads.len(), along.len());
    // It sticks up to a load of 1.5, slips back to 1.25 and comes off: the events that the computed path is named by.
    for (load, index) in [(1.5, 3), (1.25, 10)] {
        let line = server.get_json(&format!("/v1/jobs/{id}/increments?after={}&limit=1", index - 1)).await;
        let computed = &line["increments"][0];
        let x = computed["displacements"]["node"][0].as_f64().expect("a number");
        assert!((computed["load_factor"].as_f64().expect("a number") - load).abs() < 1e-12);
        let is_there = |(&found, &place): (&f64, &f64)| (found - load).abs() < 1e-12 && (place - x).abs() < 1e-12;
        assert!(loads.iter().zip(&along).any(is_there), "{load} at {x}");
    }
    let id = server.submit(&scene("two-snapping-bars")).await;
    let unknown = server.get_json(&format!("/v1/jobs/{id}/exact")).await;
    assert_eq!((&unknown["name"], unknown["stages"].as_array().map(Vec::len)), (&Value::Null, Some(0)));
    for wrong in ["load=0", "displacement=-1", "load=x"] {
        let answer = server.get(&format!("/v1/jobs/{id}/exact?{wrong}")).await;
        assert_eq!(answer.status(), StatusCode::BAD_REQUEST, "{wrong}");
    }
}
