//! Going down and coming back: nothing stored is lost, no index is missing or twice.

use crate::common::engines::{batch, job, line, queued};
use crate::common::server::{TestServer, short_leases};
use crate::common::service::{indices, request, without_elapsed};
use crate::common::solver::MadeUp;
use arcslip::service::store::{self, Batch, Ending, LeaseAnswer, Page};
use std::sync::atomic::Ordering;
use std::time::Duration;

const ALL: Page = Page { rows: 10_000, bytes: usize::MAX };

#[tokio::test]
async fn a_job_goes_on_after_a_restart_with_every_index_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let solver = MadeUp::holding_at(40);
    let server = TestServer::start(&database, solver.clone()).await;
    let id = server.submit(&request("restarted", 100)).await;
    server.until(&id, |job| job["progress"]["increments"] == 39).await;
    let mut open_stream = server.stream(&id, None).await;
    let mut events = vec![open_stream.next().await.expect("an event")];
    assert!(server.stop().await, "everything ends within the bound");
    // The open stream ended by itself and says when to come back.
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
    let id = queued(lost.as_ref(), job(3)).await;
    let claim = lost.claim("lost", Duration::from_secs(60)).await.expect("a claim").expect("a job");
    let before = [line(0, "{\"index\":0,\"elapsed_s\":0}"), line(1, "{\"index\":1,\"elapsed_s\":0}")];
    lost.append(&claim.lease, &batch(&before), Duration::from_millis(50)).await.expect("stored");

    let server = TestServer::start_with(&database, MadeUp::default(), short_leases()).await;
    let job = server.ended(&id.to_string()).await;
    assert_eq!(job["status"], "completed");
    assert!(job["attempt"].as_u64() >= Some(2), "{job}");
    let lines = server.lines(&id.to_string()).await;
    assert_eq!(indices(lines.iter().map(String::as_str)), (0..6).collect::<Vec<_>>());
    assert_eq!(lines[..2], [before[0].body.clone(), before[1].body.clone()]);

    let late = [line(6, "{}")];
    let minute = Duration::from_secs(60);
    assert_eq!(lost.append(&claim.lease, &batch(&late), minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(lost.renew(&claim.lease, minute).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(lost.release(&claim.lease).await.expect("an answer"), LeaseAnswer::Lost);
    assert_eq!(
        lost.finish(&claim.lease, &Batch::default(), &Ending::failed("late")).await.expect("an answer"),
        LeaseAnswer::Lost
    );
    assert_eq!(server.ended(&id.to_string()).await, job);
    assert_eq!(lost.increments(id, None, ALL).await.expect("increments").len(), 6);
}
