//! A store that fails: what passes is tried again, what does not fails the job with its reason, and clients are told.

use crate::common::faulty_store::FaultyStore;
use crate::common::server::{TestServer, settings, short_leases};
use crate::common::service::request;
use crate::common::solver::MadeUp;
use arcslip::service::store;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

async fn start(folder: &Path, solver: MadeUp) -> (Arc<FaultyStore>, TestServer) {
    let store = FaultyStore::around(store::open(&folder.join("jobs.db")).await.expect("a store"));
    let server = TestServer::start_on(store.clone(), solver, settings()).await;
    (store, server)
}

#[tokio::test]
async fn a_database_that_is_locked_for_a_moment_costs_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (store, server) = start(folder.path(), MadeUp::default()).await;
    store.locked_appends.store(2, Ordering::Relaxed);
    let id = server.submit(&request("delayed", 600)).await;
    let job = server.ended(&id).await;
    assert_eq!(job["status"], "completed", "{job}");
    assert_eq!(job["attempt"], 1);
    assert_eq!(*store.stored.lock().expect("a list"), (0..600).collect::<Vec<_>>());
}

/// For seconds, and less than the lease: no attempt is lost and nothing fails.
#[tokio::test]
async fn a_database_that_is_away_for_some_time_costs_that_time_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = FaultyStore::around(store::open(&folder.path().join("jobs.db")).await.expect("a store"));
    let server = TestServer::start_on(store.clone(), MadeUp::default(), settings()).await;
    store.locked_appends.store(u32::MAX, Ordering::Relaxed);
    let id = server.submit(&request("delayed", 600)).await;
    tokio::time::sleep(Duration::from_secs(2)).await;
    let job = server.get_json(&format!("/v1/jobs/{id}")).await;
    assert_eq!(job["status"], "running", "{job}");
    store.locked_appends.store(0, Ordering::Relaxed);
    let job = server.ended(&id).await;
    assert_eq!((&job["status"], &job["attempt"]), (&Value::from("completed"), &Value::from(1)), "{job}");
    assert_eq!(*store.stored.lock().expect("a list"), (0..600).collect::<Vec<_>>());
}

/// Longer than the lease: the job goes back to the queue.
#[tokio::test]
async fn a_database_that_is_away_past_the_lease_fails_no_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = FaultyStore::around(store::open(&folder.path().join("jobs.db")).await.expect("a store"));
    let server = TestServer::start_on(store.clone(), MadeUp::default(), short_leases()).await;
    store.locked_appends.store(u32::MAX, Ordering::Relaxed);
    let id = server.submit(&request("delayed", 600)).await;
    server.until(&id, |job| job["attempt"].as_u64() >= Some(2)).await;
    store.locked_appends.store(0, Ordering::Relaxed);
    let job = server.ended(&id).await;
    assert_eq!(job["status"], "completed", "{job}");
    // On a busy machine a later attempt may lose its lease as well; the last one stores every increment once.
    let stored = store.stored.lock().expect("a list").clone();
    let last = stored.iter().rposition(|increment| *increment == 0).expect("a first increment");
    assert_eq!(stored[last..], (0..600).collect::<Vec<_>>());
}

#[tokio::test]
async fn a_worker_that_panics_fails_its_job_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let (store, server) = start(folder.path(), MadeUp::default()).await;
    // More often than there are workers.
    for _ in 0..5 {
        store.panicking_appends.store(1, Ordering::Relaxed);
        let id = server.submit(&request("unlucky", 10)).await;
        let job = server.ended(&id).await;
        assert_eq!((&job["status"], &job["attempt"]), (&Value::from("failed"), &Value::from(1)), "{job}");
        assert!(job["error"].as_str().expect("a text").contains("a made-up defect of the store"), "{job}");
    }
    assert_eq!(server.get_json("/readyz").await["workers"], 2);
    let id = server.submit(&request("next", 10)).await;
    assert_eq!(server.ended(&id).await["status"], "completed");
}

#[tokio::test]
async fn a_full_disk_fails_the_job_keeps_what_is_stored_and_passes() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(5);
    let (store, server) = start(folder.path(), solver.clone()).await;
    let id = server.submit(&request("stuffed", 10)).await;
    server.until(&id, |job| job["progress"]["increments"] == 4).await;
    store.full.store(true, Ordering::Relaxed);
    let refused = server.post("/v1/jobs", &request("another", 5)).await;
    assert_eq!(refused.status(), 507);
    assert!(refused.headers().contains_key("retry-after"));
    let text = refused.text().await.expect("a body");
    assert!(text.contains("/problems/storage-full") && !text.contains("INSERT") && !text.contains("/tmp"), "{text}");
    solver.let_go();
    let job = server.ended(&id).await;
    assert_eq!(job["status"], "failed");
    assert!(job["error"].as_str().expect("a text").contains("disk that holds the database is full"), "{job}");
    assert_eq!(job["progress"]["increments"], 4);
    store.full.store(false, Ordering::Relaxed);
    let next = server.submit(&request("another", 5)).await;
    assert_eq!(server.ended(&next).await["status"], "completed");
}

#[tokio::test]
async fn a_store_that_takes_no_writes_is_not_ready() {
    let folder = tempfile::tempdir().expect("a folder");
    let (store, server) = start(folder.path(), MadeUp::default()).await;
    store.down.store(true, Ordering::Relaxed);
    let answer = server.get("/readyz").await;
    assert_eq!(answer.status(), 503);
    assert!(answer.headers().contains_key("retry-after"));
    let problem: Value = answer.json().await.expect("a problem");
    assert_eq!(problem["type"], "/problems/unavailable");
    assert_eq!(server.get_json("/healthz").await["status"], "alive");
    store.down.store(false, Ordering::Relaxed);
    assert_eq!(server.get_json("/readyz").await["status"], "ready");
}
