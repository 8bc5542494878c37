//! What the store promises of a worker's writes, on both engines: leases, batches, checkpoints, and jobs handed back.

use crate::common::engines::{Database, batch, found, job, line, queued};
use crate::on_both_engines;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{Batch, Checkpoint, Ending, LeaseAnswer, Line, Page, Status, StoreError};
use std::time::Duration;

const ALL: Page = Page { rows: 10_000, bytes: usize::MAX };
const MINUTE: Duration = Duration::from_secs(60);
const HELD: LeaseAnswer = LeaseAnswer::Held { cancel_requested: false };

on_both_engines! {
    a_lease_that_has_run_out_writes_nothing_even_if_nobody_has_taken_the_job,
    a_claim_brings_what_an_earlier_attempt_stored,
    a_batch_is_stored_whole_or_not_at_all,
    an_append_whose_answer_was_lost_is_repeated_and_stored_once,
    a_job_handed_back_costs_no_attempt,
}

async fn a_lease_that_has_run_out_writes_nothing_even_if_nobody_has_taken_the_job(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(3)).await;
    let short = Duration::from_millis(20);
    let stopped = store.claim("stopped", short).await.expect("a claim").expect("a job").lease;
    tokio::time::sleep(2 * short).await;
    let lines = [line(0, "{}")];
    let lost = async |store: &dyn Store| {
        for lines in [&lines[..], &[]] {
            assert_eq!(store.append(&stopped, &batch(lines), MINUTE).await.expect("an answer"), LeaseAnswer::Lost);
            let finished = store.finish(&stopped, &batch(lines), &Ending::failed("late")).await;
            assert_eq!(finished.expect("an answer"), LeaseAnswer::Lost);
        }
        assert_eq!(store.renew(&stopped, MINUTE).await.expect("an answer"), LeaseAnswer::Lost);
        assert_eq!(store.release(&stopped).await.expect("an answer"), LeaseAnswer::Lost);
    };
    lost(store.as_ref()).await;
    let job = found(store.as_ref(), id).await;
    assert_eq!((job.status, job.last_index, job.attempt), (Status::Running, None, 1), "nothing was written");
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    lost(store.as_ref()).await;
    let next = store.claim("next", MINUTE).await.expect("a claim").expect("a job").lease;
    lost(store.as_ref()).await;
    assert_eq!(store.append(&next, &batch(&lines), MINUTE).await.expect("an answer"), HELD);
    assert_eq!(found(store.as_ref(), id).await.losses, 0, "a loss counts until something is stored");
    assert_eq!(store.finish(&next, &Batch::default(), &Ending::failed("so")).await.expect("an answer"), HELD);
    lost(store.as_ref()).await;
    assert_eq!(store.increments(id, None, ALL).await.expect("increments"), lines);
}

fn checkpoint(index: u64, trail: &str, begins_trail: bool) -> Checkpoint {
    Checkpoint { index, body: format!("at {index}"), trail: Some(trail.to_owned()), begins_trail }
}

async fn a_claim_brings_what_an_earlier_attempt_stored(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(3)).await;
    let first = store.claim("first", MINUTE).await.expect("a claim").expect("a job");
    let mut stored = batch(&[line(0, "zero"), line(3, "three")]);
    stored.checkpoints = vec![checkpoint(1, "given up", true), checkpoint(2, "a", true)];
    store.append(&first.lease, &stored, MINUTE).await.expect("stored");
    // Between two rows that are recorded.
    let between = Batch { checkpoints: vec![checkpoint(4, "b", false)], ..Batch::default() };
    assert_eq!(store.append(&first.lease, &between, Duration::from_millis(1)).await.expect("stored"), HELD);
    tokio::time::sleep(Duration::from_millis(20)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    let second = database.open().await.claim("second", MINUTE).await.expect("a claim").expect("a job");
    assert_eq!((second.lease.job, second.lease.attempt), (id, 2));
    assert_eq!(second.last, Some(line(3, "three")));
    let checkpoint = second.checkpoint.expect("a checkpoint");
    assert_eq!((checkpoint.body.as_str(), checkpoint.trail.as_str()), ("at 4", "a\nb"));
    assert_eq!((second.waited, second.stored_bytes), (None, 9));
    store.finish(&second.lease, &Batch::default(), &Ending::failed("so")).await.expect("an answer");
    assert_eq!(store.standing(id).await.expect("an answer").expect("a job").last_index, Some(3));
}

async fn a_batch_is_stored_whole_or_not_at_all(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(2)).await;
    let claim = store.claim("worker", MINUTE).await.expect("a claim").expect("a job");
    let first: Vec<Line> = (0..1200).map(|index| line(index, "{}")).collect();
    store.append(&claim.lease, &batch(&first), MINUTE).await.expect("stored");
    let with_repeat = [line(1200, "{}"), line(1199, "{}")];
    let refused = store.append(&claim.lease, &batch(&with_repeat), MINUTE).await;
    assert!(matches!(refused, Err(StoreError::Refused(_))), "{refused:?}");
    let stored = store.increments(id, Some(1000), ALL).await.expect("increments");
    assert_eq!(stored, first[1001..]);
    assert_eq!(found(store.as_ref(), id).await.last_index, Some(1199));
    // Large increments come in smaller pages, and the last is empty.
    let page = store.increments(id, None, Page { rows: 100, bytes: 10 }).await.expect("increments");
    assert_eq!(page, first[..5]);
    assert_eq!(
        store.increments(id, Some(6), Page { rows: 3, bytes: 1 << 20 }).await.expect("increments"),
        first[7..10]
    );
    assert!(store.increments(id, Some(1199), ALL).await.expect("increments").is_empty());
    assert!(store.increments(id, Some(u64::MAX), ALL).await.expect("increments").is_empty());
    // So it is with those that come with the end.
    let refused = store.finish(&claim.lease, &batch(&with_repeat), &Ending::failed("so")).await;
    assert!(matches!(refused, Err(StoreError::Refused(_))), "{refused:?}");
    assert_eq!(found(store.as_ref(), id).await.status, Status::Running);
    let last = [line(1200, "{}"), line(1201, "last")];
    assert_eq!(store.finish(&claim.lease, &batch(&last), &Ending::failed("so")).await.expect("an answer"), HELD);
    let job = found(store.as_ref(), id).await;
    assert_eq!((job.status, job.last_index), (Status::Failed, Some(1201)));
    assert_eq!(store.increments(id, Some(1199), ALL).await.expect("increments"), last);
}

async fn an_append_whose_answer_was_lost_is_repeated_and_stored_once(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(2)).await;
    let lease = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    let mut again = batch(&[line(0, "zero"), line(2, "two")]);
    again.checkpoints = vec![checkpoint(2, "a", true)];
    for _ in 0..3 {
        assert_eq!(store.append(&lease, &again, MINUTE).await.expect("an answer"), HELD);
    }
    let apart = Batch { checkpoints: vec![checkpoint(3, "b", false)], ..Batch::default() };
    for _ in 0..2 {
        assert_eq!(store.append(&lease, &apart, MINUTE).await.expect("an answer"), HELD);
    }
    assert_eq!(store.increments(id, None, ALL).await.expect("increments"), again.lines);
    // What only looks like it, or comes from another, is not taken for it.
    let otherwise = batch(&[line(0, "zero"), line(2, "otherwise")]);
    assert!(store.append(&lease, &otherwise, MINUTE).await.is_err());
    let longer = batch(&[line(2, "two"), line(3, "three")]);
    assert!(store.append(&lease, &longer, MINUTE).await.is_err());
    store.release(&lease).await.expect("an answer");
    assert_eq!(store.append(&lease, &again, MINUTE).await.expect("an answer"), LeaseAnswer::Lost);
    let next = store.claim("next", MINUTE).await.expect("a claim").expect("a job");
    assert_eq!((next.last, next.stored_bytes), (Some(line(2, "two")), 7));
    assert_eq!(next.checkpoint.expect("a checkpoint").trail, "a\nb");
}

async fn a_job_handed_back_costs_no_attempt(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(1)).await;
    for _ in 0..3 {
        let lease = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
        assert_eq!(lease.attempt, 1);
        assert_eq!(store.release(&lease).await.expect("an answer"), HELD);
    }
    let lease = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    store.request_cancel(id).await.expect("an answer").expect("a job");
    let cancelled = LeaseAnswer::Held { cancel_requested: true };
    assert_eq!(store.release(&lease).await.expect("an answer"), cancelled);
    let job = found(store.as_ref(), id).await;
    assert_eq!((job.status, job.stop_reason.as_deref()), (Status::Cancelled, Some("cancelled")));
    assert!(job.ended_at.is_some());
}
