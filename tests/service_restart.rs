//! Going down and coming back: nothing stored is lost, no index is missing or twice.
#![cfg(feature = "server")]

mod common;

use arcslip::store::{self, Batch, Ending, LeaseAnswer, Line, NewJob, Page, Status, Submitted, Task};
use common::server::TestServer;
use common::service::{indices, request, without_elapsed};
use common::solver::MadeUp;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

const ALL: Page = Page { rows: 10_000, bytes: usize::MAX };

#[tokio::test]
async fn a_job_goes_on_after_a_restart_with_every_index_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let solver = MadeUp::holding_at(40);
    let server = TestServer::start(&database, solver.clone()).await;
    let id = server.submit(&request("restarted", 100)).await;
    server.until(&id, |job| job["progress"]["increments"] == 40).await;
    let mut open_stream = server.stream(&id, None).await;
    let began = Instant::now();
    assert!(server.stop().await, "everything ends within the bound");
    assert!(began.elapsed() < Duration::from_secs(5));
    // The open stream ended by itself and says when to come back.
    let mut events = Vec::new();
    while let Some(event) = open_stream.next().await {
        events.push(event);
    }
    assert_eq!(events.len(), 41);
    assert_eq!(events[40].retry, "2000");

    solver.let_go();
    let server = TestServer::start(&database, solver.clone()).await;
    let job = server.ended(&id).await;
    assert_eq!(job["status"], "completed");
    assert_eq!(job["attempt"], 1, "going down in good order costs no attempt");
    assert_eq!(solver.runs.load(Ordering::Relaxed), 2);
    let lines = server.lines(&id).await;
    assert_eq!(indices(lines.iter().map(String::as_str)), (0..100).collect::<Vec<_>>());
    // What was stored before is not rewritten: it still carries the first run's time.
    for (place, line) in lines.iter().enumerate() {
        // The time goes on from there: that of the second run, and of the first.
        let run = if place < 40 { "\"elapsed_s\":1.0" } else { "\"elapsed_s\":3.0" };
        assert!(line.contains(run), "{line}");
    }
    let undisturbed = server.submit(&request("restarted", 100)).await;
    server.ended(&undisturbed).await;
    let strip = |lines: Vec<String>| lines.iter().map(|line| without_elapsed(line)).collect::<Vec<_>>();
    assert_eq!(strip(lines), strip(server.lines(&undisturbed).await));
    assert!(server.stop().await);
}

#[tokio::test]
async fn a_lost_workers_job_is_taken_over_and_its_late_writes_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let lost = store::open(&database).await.expect("a store");
    let id = queue(lost.as_ref(), 3).await;
    let claim = lost.claim("lost", Duration::from_secs(5)).await.expect("a claim").expect("a job");
    let before = [line(0, "{\"index\":0,\"elapsed_s\":0}"), line(1, "{\"index\":1,\"elapsed_s\":0}")];
    lost.append(&claim.lease, &batch(&before), Duration::from_millis(50)).await.expect("stored");

    let server = TestServer::start(&database, MadeUp::default()).await;
    let job = server.ended(&id.to_string()).await;
    assert_eq!(job["status"], "completed");
    assert_eq!(job["attempt"], 2);
    let lines = server.lines(&id.to_string()).await;
    assert_eq!(indices(lines.iter().map(String::as_str)), (0..6).collect::<Vec<_>>());
    assert_eq!(lines[..2], [before[0].body.clone(), before[1].body.clone()]);

    let late = [line(6, "{}")];
    let minute = Duration::from_secs(60);
    assert_eq!(lost.append(&claim.lease, &batch(&late), minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(lost.renew(&claim.lease, minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(lost.release(&claim.lease).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(lost.finish(&claim.lease, Ending::failed("late")).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(server.ended(&id.to_string()).await, job);
    assert_eq!(lost.increments(id, None, ALL).await.expect("increments").len(), 6);
}

/// The clock that counts is the system's: a worker that is stopped between taking its lease and writing is late, whether or
/// not somebody else has taken the job meanwhile.
#[tokio::test]
async fn a_lease_that_has_run_out_writes_nothing_even_if_nobody_has_taken_the_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let id = queue(store.as_ref(), 3).await;
    let (short, minute) = (Duration::from_millis(20), Duration::from_secs(60));
    let stopped = store.claim("stopped", short).await.expect("a claim").expect("a job").lease;
    tokio::time::sleep(2 * short).await;
    let lines = [line(0, "{}")];
    assert_eq!(store.append(&stopped, &batch(&lines), minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(store.append(&stopped, &batch(&[]), minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(store.renew(&stopped, minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(store.release(&stopped).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(store.finish(&stopped, Ending::failed("late")).await.expect("an answer"), LeaseAnswer::Lost);
    let job = store.job(id).await.expect("an answer").expect("a job");
    assert_eq!((job.status, job.last_index, job.attempt), (Status::Running, None, 1), "nothing was written");
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    let next = store.claim("next", minute).await.expect("a claim").expect("a job").lease;
    assert_eq!(store.append(&stopped, &batch(&lines), minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(
        store.append(&next, &batch(&lines), minute).await.expect("an answer"),
        LeaseAnswer::Held { cancel_requested: false }
    );
    assert_eq!(
        store.job(id).await.expect("an answer").expect("a job").losses,
        0,
        "a loss counts until something is stored"
    );
}

#[tokio::test]
async fn of_the_jobs_that_may_have_ended_their_process_one_is_tried_at_a_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let minute = Duration::from_secs(60);
    let (first, second) = (queue(store.as_ref(), 3).await, queue(store.as_ref(), 3).await);
    for _ in 0..2 {
        store.claim("lost", Duration::ZERO).await.expect("a claim").expect("a job");
    }
    let third = queue(store.as_ref(), 3).await;
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 2);
    let taken = async || store.claim("worker", minute).await.expect("an answer").map(|claim| claim.lease);
    let suspect = taken().await.expect("a job");
    assert_eq!(suspect.job, first);
    assert_eq!(taken().await.map(|lease| lease.job), Some(third), "one without a loss goes beside it");
    assert!(taken().await.is_none(), "the other suspect waits");
    store.append(&suspect, &batch(&[line(0, "{}")]), minute).await.expect("stored");
    assert_eq!(taken().await.map(|lease| lease.job), Some(second), "what has stored something is none any more");
}

#[tokio::test]
async fn a_job_that_loses_every_worker_fails_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let id = queue(store.as_ref(), 2).await;
    for attempt in 1..=2 {
        let claim = store.claim("lost", Duration::ZERO).await.expect("a claim").expect("a job");
        assert_eq!(claim.lease.attempt, attempt);
        tokio::time::sleep(Duration::from_millis(5)).await;
        assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    }
    assert!(store.claim("another", Duration::ZERO).await.expect("an answer").is_none());
    let job = store.job(id).await.expect("an answer").expect("a job");
    assert_eq!(job.status, Status::Failed);
    assert!(job.error.as_deref().is_some_and(|error| error.starts_with("the worker was lost 2 times in a row")));
}

#[tokio::test]
async fn a_batch_is_stored_whole_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let id = queue(store.as_ref(), 2).await;
    let minute = Duration::from_secs(60);
    let claim = store.claim("worker", minute).await.expect("a claim").expect("a job");
    let first: Vec<Line> = (0..1200).map(|index| line(index, "{}")).collect();
    store.append(&claim.lease, &batch(&first), minute).await.expect("stored");
    let with_repeat = [line(1200, "{}"), line(1199, "{}")];
    assert!(store.append(&claim.lease, &batch(&with_repeat), minute).await.is_err());
    let stored = store.increments(id, Some(1000), ALL).await.expect("increments");
    assert_eq!(stored.len(), 199);
    assert_eq!(store.job(id).await.expect("an answer").expect("a job").last_index, Some(1199));
    // Large increments come in smaller pages.
    let page = store.increments(id, None, Page { rows: 100, bytes: 10 }).await.expect("increments");
    assert_eq!(page.len(), 5);
}

async fn queue(store: &dyn store::Store, max_attempts: u32) -> uuid::Uuid {
    let job = NewJob {
        task: Task::Path,
        owner: None,
        name: None,
        request: request("queued", 6).to_string(),
        plan: "{}".to_owned(),
        max_increments: 6,
        max_attempts,
        most_queued: 100,
        priority: 0,
        idempotency_key: None,
        explore: None,
    };
    match store.submit(job).await.expect("queued") {
        Submitted::Created(job) => job.id,
        other => panic!("{other:?}"),
    }
}

fn line(index: u64, body: &str) -> Line {
    Line { index, body: body.to_owned(), branch: None }
}

fn batch(lines: &[Line]) -> Batch {
    Batch::from(lines.to_vec())
}
