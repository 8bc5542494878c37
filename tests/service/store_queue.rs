//! What the store promises of its queue, on both engines: submissions, claims, losses, cancelling, and changes that wake
//! another process.

use crate::common::engines::{Database, batch, found, job, line, queued};
use crate::on_both_engines;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{Batch, Ending, LeaseAnswer, Location, Status, Submitted, Task};
use std::collections::BTreeSet;
use std::time::Duration;

const MINUTE: Duration = Duration::from_secs(60);
const HELD: LeaseAnswer = LeaseAnswer::Held { cancel_requested: false };

on_both_engines! {
    a_job_is_stored_as_it_was_given,
    a_key_finds_its_job_and_no_other_owners,
    a_key_that_comes_many_times_at_once_queues_one_job,
    a_full_queue_takes_no_more,
    jobs_are_claimed_by_priority_then_in_order,
    many_claims_at_once_take_every_job_once,
    a_job_that_loses_every_worker_fails_with_the_reason,
    of_the_jobs_that_may_have_ended_their_process_one_is_tried_at_a_time,
    of_many_claims_at_once_one_takes_a_suspect,
    a_queued_job_is_cancelled_at_once_and_a_running_one_told,
    what_another_process_changes_is_told,
}

async fn a_job_is_stored_as_it_was_given(database: Database) {
    let store = database.open().await;
    let mut given = job(7);
    given.task = Task::Study;
    given.owner = Some("anna".to_owned());
    given.name = Some("ü ß 'quoted' \u{1F600}".to_owned());
    given.request = "{\"spaced\" :  [1e-3, \"\\u0000\"]}".to_owned();
    given.max_increments = u64::MAX;
    let id = queued(store.as_ref(), given.clone()).await;
    let record = found(database.open().await.as_ref(), id).await;
    assert_eq!((record.task, record.owner, record.name), (Task::Study, given.owner, given.name));
    assert_eq!((record.status, record.attempt, record.max_attempts, record.losses), (Status::Queued, 0, 7, 0));
    assert_eq!(record.max_increments, i64::MAX as u64, "no bound");
    assert!((record.created_at.duration_until(jiff::Timestamp::now())).as_secs().abs() < 60);
    assert!(record.parent.is_none() && record.membership.is_none() && record.children == 0);
    assert_eq!(store.request(id).await.expect("an answer"), Some(given.request));
    let nobody = uuid::Uuid::now_v7();
    assert!(store.job(nobody).await.expect("an answer").is_none());
    assert!(store.standing(nobody).await.expect("an answer").is_none());
    assert!(store.request(nobody).await.expect("an answer").is_none());
    store.probe().await.expect("it takes writes");
    store.probe().await.expect("it takes them again");
    store.check().await.expect("whole");
}

async fn a_key_finds_its_job_and_no_other_owners(database: Database) {
    let store = database.open().await;
    let mut given = job(3);
    given.idempotency_key = Some("key".to_owned());
    let id = queued(store.as_ref(), given.clone()).await;
    match store.submit(given.clone()).await.expect("an answer") {
        Submitted::Repeated(job) => assert_eq!(job.id, id),
        other => panic!("{other:?}"),
    }
    let mut other = given.clone();
    other.request += " ";
    assert!(matches!(store.submit(other).await.expect("an answer"), Submitted::KeyReused));
    let mut study = given.clone();
    study.task = Task::Study;
    assert!(matches!(store.submit(study).await.expect("an answer"), Submitted::KeyReused));
    let mut of_another = given;
    of_another.owner = Some("bert".to_owned());
    assert_ne!(queued(store.as_ref(), of_another).await, id);
}

async fn a_key_that_comes_many_times_at_once_queues_one_job(database: Database) {
    let mut given = job(3);
    given.idempotency_key = Some("key".to_owned());
    let mut calls = Vec::new();
    for _ in 0..4 {
        let store = database.open().await;
        for _ in 0..5 {
            let (store, given) = (store.clone(), given.clone());
            calls.push(tokio::spawn(async move { store.submit(given).await.expect("an answer") }));
        }
    }
    let (mut ids, mut created) = (BTreeSet::new(), 0);
    for call in calls {
        match call.await.expect("an answer") {
            Submitted::Created(job) => {
                created += 1;
                ids.insert(job.id);
            }
            Submitted::Repeated(job) => _ = ids.insert(job.id),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!((created, ids.len()), (1, 1));
}

async fn a_full_queue_takes_no_more(database: Database) {
    let store = database.open().await;
    let mut given = job(3);
    given.most_queued = 2;
    given.idempotency_key = Some("key".to_owned());
    queued(store.as_ref(), given.clone()).await;
    let mut next = given.clone();
    next.idempotency_key = None;
    queued(store.as_ref(), next.clone()).await;
    assert!(matches!(store.submit(next.clone()).await.expect("an answer"), Submitted::QueueFull { most: 2 }));
    assert!(matches!(store.submit(given).await.expect("an answer"), Submitted::Repeated(_)), "it is there already");
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    queued(store.as_ref(), next).await;
    assert_eq!(tally(store.as_ref()).await, [(Status::Queued, 2), (Status::Running, 1)]);
    store.finish(&claim.lease, &Batch::default(), &Ending::failed("no")).await.expect("an answer");
    assert_eq!(tally(store.as_ref()).await, [(Status::Queued, 2), (Status::Failed, 1)]);
}

/// Those that are not zero.
async fn tally(store: &dyn Store) -> Vec<(Status, u64)> {
    let told = store.tally().await.expect("an answer");
    assert_eq!(told.len(), Status::ALL.len(), "every status is told");
    let of = |status| told.iter().find(|(one, _)| *one == status).map(|(_, jobs)| (status, *jobs));
    Status::ALL.into_iter().filter_map(of).filter(|(_, jobs)| *jobs > 0).collect()
}

async fn jobs_are_claimed_by_priority_then_in_order(database: Database) {
    let store = database.open().await;
    let mut ids = Vec::new();
    for priority in [0, 0, 5, -1, 5] {
        let mut given = job(3);
        given.priority = priority;
        ids.push(queued(store.as_ref(), given).await);
    }
    let mut taken = Vec::new();
    while let Some(claim) = store.claim("worker", MINUTE).await.expect("an answer") {
        assert_eq!((claim.lease.attempt, claim.lease.worker.as_str()), (1, "worker"));
        assert!(
            claim.waited.is_some_and(|waited| waited < MINUTE) && claim.last.is_none() && claim.checkpoint.is_none()
        );
        assert_eq!((claim.max_increments, claim.explores, claim.origin.is_none()), (6, false, true));
        taken.push(claim.lease.job);
    }
    assert_eq!(taken, [ids[2], ids[4], ids[0], ids[1], ids[3]]);
}

async fn many_claims_at_once_take_every_job_once(database: Database) {
    let store = database.open().await;
    let mut ids = BTreeSet::new();
    for _ in 0..60 {
        ids.insert(queued(store.as_ref(), job(3)).await);
    }
    let mut workers = Vec::new();
    for number in 0..6 {
        let store = database.open().await;
        workers.push(tokio::spawn(async move {
            let (mut taken, name) = (Vec::new(), format!("worker {number}"));
            while let Some(claim) = store.claim(&name, MINUTE).await.expect("an answer") {
                let lines = [line(0, "{}"), line(1, "{}")];
                assert_eq!(store.append(&claim.lease, &batch(&lines), MINUTE).await.expect("an answer"), HELD);
                let ending = Ending { status: Status::Completed, ..Ending::failed("") };
                assert_eq!(store.finish(&claim.lease, &Batch::default(), &ending).await.expect("an answer"), HELD);
                taken.push(claim.lease.job);
            }
            taken
        }));
    }
    let mut taken = Vec::new();
    for worker in workers {
        taken.extend(worker.await.expect("it ends"));
    }
    assert_eq!(taken.len(), 60);
    assert_eq!(taken.into_iter().collect::<BTreeSet<_>>(), ids);
    store.reclaim_expired().await.expect("an answer");
    assert_eq!(tally(store.as_ref()).await, [(Status::Completed, 60)]);
}

async fn a_job_that_loses_every_worker_fails_with_the_reason(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), job(2)).await;
    for attempt in 1..=2 {
        let claim = store.claim("lost", Duration::ZERO).await.expect("a claim").expect("a job");
        assert_eq!(claim.lease.attempt, attempt);
        tokio::time::sleep(Duration::from_millis(5)).await;
        assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    }
    assert!(store.claim("another", Duration::ZERO).await.expect("an answer").is_none());
    let job = found(store.as_ref(), id).await;
    assert_eq!(job.status, Status::Failed);
    assert!(job.error.as_deref().is_some_and(|error| error.starts_with("the worker was lost 2 times in a row")));
}

/// Jobs that have lost a worker each.
async fn suspects(store: &dyn Store, count: usize) -> Vec<uuid::Uuid> {
    let mut ids = Vec::new();
    for _ in 0..count {
        ids.push(queued(store, job(9)).await);
    }
    for _ in 0..count {
        store.claim("lost", Duration::ZERO).await.expect("a claim").expect("a job");
    }
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), count as u64);
    ids
}

async fn of_the_jobs_that_may_have_ended_their_process_one_is_tried_at_a_time(database: Database) {
    let store = database.open().await;
    let suspects = suspects(store.as_ref(), 2).await;
    let third = queued(store.as_ref(), job(3)).await;
    let taken = async || store.claim("worker", MINUTE).await.expect("an answer").map(|claim| claim.lease);
    let suspect = taken().await.expect("a job");
    assert_eq!(suspect.job, suspects[0]);
    assert_eq!(taken().await.map(|lease| lease.job), Some(third), "one without a loss goes beside it");
    assert!(taken().await.is_none(), "the other suspect waits");
    store.append(&suspect, &batch(&[line(0, "{}")]), MINUTE).await.expect("stored");
    assert_eq!(taken().await.map(|lease| lease.job), Some(suspects[1]), "what has stored something is none any more");
}

async fn of_many_claims_at_once_one_takes_a_suspect(database: Database) {
    let store = database.open().await;
    suspects(store.as_ref(), 8).await;
    for _ in 0..3 {
        let mut claims = Vec::new();
        for number in 0..8 {
            let store = database.open().await;
            claims.push(tokio::spawn(async move { store.claim(&format!("worker {number}"), MINUTE).await }));
        }
        let mut taken = Vec::new();
        for claim in claims {
            taken.extend(claim.await.expect("it ends").expect("an answer"));
        }
        assert_eq!(taken.len(), 1);
        store.finish(&taken[0].lease, &Batch::default(), &Ending::failed("so")).await.expect("an answer");
    }
}

async fn a_queued_job_is_cancelled_at_once_and_a_running_one_told(database: Database) {
    let store = database.open().await;
    let (running, waiting) = (queued(store.as_ref(), job(3)).await, queued(store.as_ref(), job(3)).await);
    let lease = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    let cancelled = store.request_cancel(waiting).await.expect("an answer").expect("a job");
    assert_eq!((cancelled.status, cancelled.ended_at.is_some()), (Status::Cancelled, true));
    let told = store.request_cancel(running).await.expect("an answer").expect("a job");
    assert_eq!((told.status, told.cancel_requested, told.ended_at), (Status::Running, true, None));
    let cancel = LeaseAnswer::Held { cancel_requested: true };
    assert_eq!(store.renew(&lease, MINUTE).await.expect("an answer"), cancel);
    assert_eq!(store.append(&lease, &batch(&[line(0, "{}")]), MINUTE).await.expect("an answer"), cancel);
    store.finish(&lease, &Batch::default(), &Ending::failed("so")).await.expect("an answer");
    let ended = store.request_cancel(running).await.expect("an answer").expect("a job");
    assert_eq!(ended.status, Status::Failed, "what has ended is left alone");
    assert!(store.request_cancel(uuid::Uuid::now_v7()).await.expect("an answer").is_none());
    assert!(store.claim("worker", MINUTE).await.expect("an answer").is_none());
}

/// On a server: a file's processes look for themselves.
async fn what_another_process_changes_is_told(database: Database) {
    if matches!(database.location, Location::File(_)) {
        return;
    }
    let (here, there) = (database.open().await, database.open().await);
    let mut queue = here.queue_changes();
    // Until it has begun to listen.
    while tokio::time::timeout(Duration::from_millis(100), queue.changed()).await.is_err() {
        queued(there.as_ref(), job(3)).await;
    }
    while let Some(claim) = there.claim("worker", MINUTE).await.expect("an answer") {
        there.finish(&claim.lease, &Batch::default(), &Ending::failed("so")).await.expect("an answer");
    }
    tokio::time::sleep(Duration::from_millis(300)).await;
    queue.borrow_and_update();
    let id = queued(there.as_ref(), job(3)).await;
    tokio::time::timeout(MINUTE, queue.changed()).await.expect("in time").expect("told");
    let mut changes = here.job_changes(id);
    let lease = there.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    tokio::time::timeout(MINUTE, changes.changed()).await.expect("in time").expect("told");
    changes.borrow_and_update();
    there.append(&lease, &batch(&[line(0, "{}")]), MINUTE).await.expect("stored");
    tokio::time::timeout(MINUTE, changes.changed()).await.expect("in time").expect("told");
    assert!(changes.borrow_and_update().latest.is_none(), "what was stored is to be read");
    assert_eq!(here.standing(id).await.expect("an answer").expect("a job").last_index, Some(0));
}
