//! How a service is reached, and what a spreadsheet makes of its tables.

use crate::common::server::{TestServer, any_port, settings};
use crate::common::service::{request, scene};
use crate::common::solver::MadeUp;
use arcslip::service::http::access::Access;
use arcslip::service::http::listen::Connections;
use arcslip::service::http::server::{ListenOptions, Server};
use arcslip::service::jobs::{PathSolver, Settings};
use arcslip::service::store;
use serde_json::{Value, json};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

/// Of those past the ones that are served as many wait as are served, and the system's own one or two.
#[tokio::test(flavor = "multi_thread")]
async fn as_many_connections_wait_as_are_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let connections = Connections { all: 2, waiting: 2, an_address: None };
    let front = ListenOptions { listen: any_port(), connections, access: Access::loopback() };
    let server = Server::start(front, store, Arc::new(MadeUp::default()), settings()).await.expect("it starts");
    let place = server.address();
    let connected: Vec<TcpStream> =
        (0..12).filter_map(|_| TcpStream::connect_timeout(&place, Duration::from_millis(200)).ok()).collect();
    assert!(connected.len() <= 7, "{} are connected", connected.len());
    drop(connected);
    assert!(server.stop().await);
}

async fn text(server: &TestServer, place: &str) -> String {
    let answer = server.get(place).await;
    assert_eq!(answer.status(), 200, "{place}");
    answer.text().await.expect("text")
}

#[tokio::test(flavor = "multi_thread")]
async fn text_in_tables_is_no_formula() {
    let folder = tempfile::tempdir().expect("a folder");
    let one = Settings { workers: 1, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, one).await;
    let mut named = request("formulas", 3);
    named["model"] = serde_json::from_str(&named["model"].to_string().replace("\"tip\"", "\"=1+1\"")).expect("JSON");
    named["model"]["stages"][0]["name"] = json!("@push");
    let id = server.submit(&named).await;
    server.ended(&id).await;
    let table = text(&server, &format!("/v1/jobs/{id}/path.csv")).await;
    let header = table.lines().next().expect("a header");
    assert!(header.contains(",'=1+1.x,") && header.contains(",'=1+1/floor.status,"), "{header}");
    assert!(!table.contains(",=") && !table.contains(",@") && table.contains(",'@push,"), "{table}");
    let first = table.lines().nth(1).expect("a row").split(',').nth(3).expect("a cell").parse::<f64>();
    assert!(first.is_ok(), "numbers are numbers: {first:?}");

    let mut sweep = scene("one-bar-truss");
    sweep["sweep"] = json!({"replace": {"/model/name": ["=1+1", "-2", "plain"], "/model/nodes/tip/0": [-1.5]}});
    let posted: Value = server.post("/v1/sweeps", &sweep).await.json().await.expect("a sweep");
    let place = posted["links"]["self"].as_str().expect("an address").to_owned();
    while server.get_json(&place).await["status"] == "running" {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let table = text(&server, &format!("{place}/table.csv")).await;
    for values in [",'=1+1,-1.5,", ",'-2,-1.5,", ",plain,-1.5,"] {
        assert!(table.contains(values), "{values} {table}");
    }
}
