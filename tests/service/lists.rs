//! Lists read what they show, however large what they list is; so do pages of large increments, and answers that are large are
//! refused or made in parts.

use crate::common::engines::{Database, batch, job, line, queued};
use crate::common::server::{TestServer, settings};
use crate::common::service::scene;
use crate::on_both_engines;
use arcslip::service::jobs::{PathSolver, Settings};
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{
    Batch, Ending, JobRecord, ListFilter, Listed, NewJob, NewRun, NewSweep, Page, Status, Task,
};
use serde_json::{Value, json};
use std::time::Duration;

const MEGABYTE: usize = 1 << 20;
const MINUTE: Duration = Duration::from_secs(60);

on_both_engines! {
    a_list_reads_what_it_shows_of_large_jobs,
    a_page_of_large_increments_reads_those_that_it_shows,
}

fn all(task: Task, bytes: usize) -> ListFilter {
    ListFilter {
        task,
        owner: None,
        status: None,
        sweep: None,
        parent: None,
        before: None,
        page: Page { rows: 100, bytes },
    }
}

async fn stored(store: &dyn Store, summary: &str) {
    let large = "x".repeat(MEGABYTE);
    let whole = NewJob {
        task: Task::Sweep,
        name: Some(large.clone()),
        plan: large.clone(),
        summary: Some(summary.to_owned()),
        max_increments: 1,
        ..job(3)
    };
    let run = NewRun {
        name: None,
        request: large,
        plan: "{}".to_owned(),
        values: "[]".to_owned(),
        asked: None,
        max_increments: 1,
    };
    store.submit_sweep(NewSweep { whole, runs: vec![run], refine: 0 }).await.expect("stored");
}

async fn a_list_reads_what_it_shows_of_large_jobs(database: Database) {
    let store = database.open().await;
    for _ in 0..12 {
        stored(store.as_ref(), "a summary").await;
    }
    let Listed { jobs, more } = store.jobs(all(Task::Sweep, MEGABYTE)).await.expect("a list");
    assert_eq!((jobs.len(), more), (12, false));
    assert!(jobs.iter().all(|job| job.plan == "a summary"));
    let bytes: usize = jobs.iter().map(JobRecord::bytes).sum();
    assert!(bytes < 10_000, "{bytes}");
    // A study's report is shown by none but the study itself, and an error is cut.
    let large = "y".repeat(MEGABYTE);
    let study = queued(store.as_ref(), NewJob { task: Task::Study, priority: 1, ..job(3) }).await;
    let claim = store.claim("worker", MINUTE).await.expect("a claim").expect("a job");
    assert_eq!(claim.lease.job, study);
    let ending = Ending { report: Some(large.clone()), ..Ending::failed(large) };
    store.finish(&claim.lease, &Batch::default(), &ending).await.expect("ended");
    let Listed { jobs, .. } = store.jobs(all(Task::Study, MEGABYTE)).await.expect("a list");
    assert_eq!((jobs.len(), jobs[0].status, jobs[0].report.is_none()), (1, Status::Failed, true));
    assert!(jobs[0].bytes() < 2_000, "{}", jobs[0].bytes());
    assert_eq!(
        store.job(study).await.expect("an answer").expect("a study").report.map(|text| text.len()),
        Some(MEGABYTE)
    );
    // Where what is shown is large itself, a page ends early and the next goes on.
    for _ in 0..5 {
        stored(store.as_ref(), &"z".repeat(MEGABYTE / 3)).await;
    }
    let first = store.jobs(all(Task::Sweep, MEGABYTE / 2)).await.expect("a list");
    assert_eq!((first.jobs.len(), first.more), (2, true));
    let before = first.jobs.last().map(|job| job.id);
    let rest = store.jobs(ListFilter { before, ..all(Task::Sweep, usize::MAX) }).await.expect("a list");
    assert_eq!((rest.jobs.len(), rest.more), (15, false));
}

async fn a_page_of_large_increments_reads_those_that_it_shows(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(3)).await;
    let claim = store.claim("worker", MINUTE).await.expect("a claim").expect("a job");
    let large: Vec<_> = (0..8).map(|number| line(2 * number, &number.to_string().repeat(MEGABYTE))).collect();
    store.append(&claim.lease, &batch(&large), MINUTE).await.expect("stored");
    let page = async |after, rows, bytes| store.increments(id, after, Page { rows, bytes }).await.expect("a page");
    assert_eq!(page(None, 100, 5 * MEGABYTE / 2).await, large[..3]);
    assert_eq!(page(Some(4), 2, usize::MAX).await, large[3..5]);
    assert_eq!(page(Some(4), 100, 1).await, large[3..4]);
    assert_eq!(page(Some(5), 100, usize::MAX).await, large[3..]);
    assert!(page(Some(14), 100, usize::MAX).await.is_empty());
}

/// A sweep of so many values, short ones that stand in no run's way.
fn sweep(values: usize) -> Value {
    let mut request = scene("one-bar-truss");
    let values: Vec<f64> = (0..values).map(|number| 0.1 + number as f64 * 1e-9).collect();
    request["sweep"] = json!({"replace": {"/model/contacts/0/friction": values}});
    request
}

#[tokio::test(flavor = "multi_thread")]
async fn a_listed_sweep_tells_how_many_values_and_itself_tells_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let idle = Settings { workers: 0, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), PathSolver, idle).await;
    let answer = server.post("/v1/sweeps", &sweep(500)).await;
    assert_eq!(answer.status(), 202);
    let posted: Value = answer.json().await.expect("a sweep");
    assert_eq!(posted["parameters"][0]["values"].as_array().map(Vec::len), Some(500));
    let list = server.get_json("/v1/sweeps").await;
    let listed = &list["sweeps"][0];
    assert_eq!((&listed["id"], &listed["progress"]), (&posted["id"], &posted["progress"]));
    assert_eq!((&listed["parameter_count"], &listed["combine"]), (&json!(1), &json!("grid")));
    let parameter = &listed["parameters"][0];
    assert_eq!((&parameter["pointer"], &parameter["value_count"]), (&json!("/model/contacts/0/friction"), &json!(500)));
    let shown = parameter["values"].as_array().expect("values");
    assert!((1..50).contains(&shown.len()) && shown[0] == 0.1, "{shown:?}");
    let whole = server.get_json(posted["links"]["self"].as_str().expect("an address")).await;
    assert_eq!(whole, posted);
}
