//! What the service stores and serves carries the measure; jobs that follow another go on with that one's history.

use crate::common::server::TestServer;
use arcslip::check::judged::JudgedIncrement;
use arcslip::check::measure::Errors;
use arcslip::service::jobs::PathSolver;
use serde_json::{Value, json};
use std::path::Path;

fn scene(name: &str) -> Value {
    serde_json::from_str(arcslip::check::scenes::find(name).expect("a scene").request).expect("JSON")
}

async fn increments(server: &TestServer, id: &str) -> Vec<JudgedIncrement> {
    server.lines(id).await.iter().map(|line| serde_json::from_str(line).expect("a judged increment")).collect()
}

async fn pool(database: &Path) -> sqlx::SqlitePool {
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    sqlx::SqlitePool::connect_with(options).await.expect("a pool")
}

/// Cells of the table's columns that hold the measure, the header's first.
async fn measure_columns(server: &TestServer, id: &str) -> Vec<Vec<String>> {
    let table = server.get(&format!("/v1/jobs/{id}/path.csv")).await.text().await.expect("a body");
    let last = |line: &str| {
        let cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[cells.len() - Errors::NAMES.len()..].to_vec()
    };
    table.lines().map(last).collect()
}

#[tokio::test]
async fn increments_report_and_table_carry_the_measure() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let id = server.submit(&scene("klarbring")).await;
    let job = server.ended(&id).await;
    let path = increments(&server, &id).await;
    let largest = path.iter().map(|judged| judged.measure.arc_length).fold(0.0, f64::max);
    assert!(largest > 0.0 && path.iter().all(|judged| judged.measure.largest_of_state() <= 1e-10));
    let measure = &job["report"]["measure"];
    assert_eq!(measure["largest"]["arc_length"]["value"], largest);
    let index = measure["largest"]["arc_length"]["index"].as_u64().expect("an index");
    assert!(path[index as usize].measure.arc_length == largest);
    assert_eq!((&measure["bar"], &measure["off_measure"]), (&json!(1e-9), &json!(0)));

    let columns = measure_columns(&server, &id).await;
    assert_eq!(columns[0], Errors::NAMES.map(|name| format!("measure.{name}")));
    for (cells, judged) in columns[1..].iter().zip(&path) {
        let values: Vec<f64> = cells.iter().map(|cell| cell.parse().expect("a number")).collect();
        assert_eq!(values, judged.measure.values());
    }
    // What was stored before increments carried it.
    let stored = "UPDATE increments SET body = json_remove(body, '$.measure') WHERE increment_index = 0";
    sqlx::query(stored).execute(&pool(&database).await).await.expect("changed");
    let columns = measure_columns(&server, &id).await;
    assert!(columns[1].iter().all(String::is_empty) && columns[2].iter().all(|cell| !cell.is_empty()));
}

#[tokio::test]
async fn a_follower_is_judged_as_its_parent_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    // In the second stage: what the first one holds is part of the history.
    let id = server.submit(&scene("klarbring")).await;
    server.ended(&id).await;
    let path = increments(&server, &id).await;
    let from = path.iter().rfind(|judged| judged.increment.point.bifurcation).expect("a bifurcation point");
    let (index, directions) = (from.increment.index, from.increment.directions.as_ref().expect("directions"));
    let place = format!("/v1/jobs/{id}/follow");
    for (direction, listed) in directions.iter().enumerate().filter(|(_, listed)| !listed.retrace) {
        let asked = json!({"increment": index, "direction": direction, "max_increments": 10});
        let queued: Value = server.post(&place, &asked).await.json().await.expect("a job");
        let follower = queued["id"].as_str().unwrap_or_else(|| panic!("{queued}"));
        let job = server.ended(follower).await;
        let followed = increments(&server, follower).await;
        assert!(followed.len() > 1 && followed.iter().all(|judged| judged.measure.largest_of_state() <= 1e-10));
        assert_eq!(job["report"]["measure"]["off_measure"], 0);
        if listed.taken {
            let parent = &path[index as usize + 1..];
            assert!(followed[1..].iter().zip(parent).all(|(judged, parent)| judged.measure == parent.measure));
        }
    }
    // A point that was stored before the judge's history was kept with it.
    let stored = "UPDATE branches SET body = json_extract(body, '$.path')";
    sqlx::query(stored).execute(&pool(&database).await).await.expect("changed");
    let asked = json!({"increment": index, "direction": 0});
    let problem: Value = server.post(&place, &asked).await.json().await.expect("a problem");
    assert_eq!((&problem["status"], &problem["errors"][0]["pointer"]), (&json!(422), &json!("/increment")));
    assert!(problem["detail"].as_str().expect("text").contains("trace the path anew"), "{problem}");
}
