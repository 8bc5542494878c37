//! In which order the store gives jobs out, which losses count, and failed jobs that are queued again; on both engines.

use crate::common::engines::{Database, batch, found, job, line, queued};
use crate::on_both_engines;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{Batch, Ending, NewJob, NewRun, NewSweep, Retried, Status, Submitted, Task};
use std::time::Duration;
use uuid::Uuid;

const MINUTE: Duration = Duration::from_secs(60);

on_both_engines! {
    single_jobs_come_between_the_runs_of_a_sweep,
    owners_take_turns_however_much_one_has_queued,
    studies_and_single_jobs_take_turns_too,
    whoever_comes_new_does_not_wait_for_what_others_have_queued,
    what_is_cancelled_leaves_no_gap_behind,
    a_host_that_goes_down_again_and_again_fails_no_job_that_was_beside_others,
    a_job_that_is_lost_alone_or_as_a_suspect_fails_in_the_end,
    a_failed_job_is_queued_again_with_what_it_has_stored,
}

fn of(owner: &str) -> NewJob {
    NewJob { owner: Some(owner.to_owned()), most_queued: 10_000, ..job(3) }
}

async fn sweep(store: &dyn Store, owner: &str, runs: usize) -> Uuid {
    let run = NewRun {
        name: None,
        request: "{}".to_owned(),
        plan: "{}".to_owned(),
        values: "[]".to_owned(),
        asked: None,
        max_increments: 1,
    };
    let whole = NewJob { task: Task::Sweep, max_increments: runs as u64, ..of(owner) };
    match store.submit_sweep(NewSweep { whole, runs: vec![run; runs], refine: 0 }).await.expect("stored") {
        Submitted::Created(sweep) => sweep.id,
        other => panic!("{other:?}"),
    }
}

/// So many claims, one after the other: the owner of each, in capitals where it is a run of a sweep.
async fn order(store: &dyn Store, claims: usize) -> String {
    let mut order = String::new();
    for _ in 0..claims {
        let Some(claim) = store.claim("worker", MINUTE).await.expect("an answer") else { break };
        let job = found(store, claim.lease.job).await;
        let owner = job.owner.expect("an owner");
        order += &if job.run.is_some() { owner.to_uppercase() } else { owner };
        store.finish(&claim.lease, &Batch::default(), &Ending::failed("so")).await.expect("ended");
    }
    order
}

async fn single_jobs_come_between_the_runs_of_a_sweep(database: Database) {
    let store = database.open().await;
    sweep(store.as_ref(), "a", 12).await;
    for _ in 0..3 {
        queued(store.as_ref(), of("a")).await;
    }
    assert_eq!(order(store.as_ref(), 5).await, "AaAaA");
    // One that comes later does not wait longer than one run, either.
    queued(store.as_ref(), of("a")).await;
    assert_eq!(order(store.as_ref(), 100).await, "aAaAAAAAAAA");
}

async fn owners_take_turns_however_much_one_has_queued(database: Database) {
    let store = database.open().await;
    sweep(store.as_ref(), "a", 1_000).await;
    for _ in 0..3 {
        queued(store.as_ref(), of("b")).await;
    }
    sweep(store.as_ref(), "c", 1_000).await;
    queued(store.as_ref(), of("a")).await;
    let order = order(store.as_ref(), 60).await;
    let served = |owner: char| order.chars().filter(|one| one.eq_ignore_ascii_case(&owner)).count();
    assert_eq!(&order[..9], "AbCbCaAbC", "{order}");
    assert!(served('a').abs_diff(served('c')) <= 1, "{order}");
}

async fn studies_and_single_jobs_take_turns_too(database: Database) {
    let store = database.open().await;
    let study = || NewJob { task: Task::Study, ..of("s") };
    sweep(store.as_ref(), "s", 10).await;
    queued(store.as_ref(), study()).await;
    queued(store.as_ref(), study()).await;
    queued(store.as_ref(), study()).await;
    queued(store.as_ref(), of("s")).await;
    let mut tasks = String::new();
    while let Some(claim) = store.claim("worker", MINUTE).await.expect("an answer") {
        let job = found(store.as_ref(), claim.lease.job).await;
        tasks.push(match (job.task, job.run) {
            (Task::Study, _) => 't',
            (_, Some(_)) => 'R',
            (_, None) => 'j',
        });
    }
    assert_eq!(tasks.len(), 14);
    let place = |kind| tasks.find(kind).expect("one of the kind");
    assert!(place('j') <= 3 && place('t') <= 3, "{tasks}");
    assert!(tasks.rfind('t').is_some_and(|last| last <= 8), "{tasks}");
}

async fn whoever_comes_new_does_not_wait_for_what_others_have_queued(database: Database) {
    let store = database.open().await;
    for _ in 0..30 {
        queued(store.as_ref(), of("a")).await;
    }
    assert_eq!(order(store.as_ref(), 10).await, "aaaaaaaaaa");
    for _ in 0..4 {
        queued(store.as_ref(), of("b")).await;
    }
    assert_eq!(order(store.as_ref(), 10).await, "abababab".to_owned() + "aa");
    // Who is served at once each time takes no more than a turn.
    for _ in 0..3 {
        queued(store.as_ref(), of("b")).await;
        assert_eq!(order(store.as_ref(), 2).await, "ab");
    }
}

async fn what_is_cancelled_leaves_no_gap_behind(database: Database) {
    let store = database.open().await;
    let given_up = sweep(store.as_ref(), "a", 200).await;
    sweep(store.as_ref(), "a", 5).await;
    for _ in 0..50 {
        queued(store.as_ref(), of("b")).await;
    }
    store.cancel_sweep(given_up).await.expect("cancelled");
    store.reclaim_expired().await.expect("an answer");
    let order = order(store.as_ref(), 12).await;
    assert_eq!(order.matches('A').count(), 5, "{order}");
}

/// Every lease runs out at once, as where a host goes down.
async fn lost(store: &dyn Store, workers: &[&str]) -> Vec<Uuid> {
    let mut taken = Vec::new();
    for worker in workers {
        taken.extend(store.claim(worker, Duration::ZERO).await.expect("a claim").map(|claim| claim.lease.job));
    }
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), taken.len() as u64);
    taken
}

async fn a_host_that_goes_down_again_and_again_fails_no_job_that_was_beside_others(database: Database) {
    let store = database.open().await;
    let mut ids = Vec::new();
    for _ in 0..6 {
        ids.push(queued(store.as_ref(), job(3)).await);
    }
    for round in 0..3 {
        let lost = lost(store.as_ref(), &["one host/0", "one host/1", "one host/2"]).await;
        assert!(lost.len() >= 2);
        for id in lost {
            let job = found(store.as_ref(), id).await;
            assert!(round > 0 || (job.losses, job.counted_losses) == (1, 0), "{job:?}");
        }
    }
    for id in ids {
        let job = found(store.as_ref(), id).await;
        assert_eq!(job.status, Status::Queued, "{job:?}");
        assert!(job.counted_losses < 3 && job.counted_losses <= job.losses, "{job:?}");
    }
}

async fn a_job_that_is_lost_alone_or_as_a_suspect_fails_in_the_end(database: Database) {
    let store = database.open().await;
    let counted = async |id| {
        let job = found(store.as_ref(), id).await;
        (job.losses, job.counted_losses, job.status)
    };
    let first = queued(store.as_ref(), job(3)).await;
    queued(store.as_ref(), job(3)).await;
    // Leases of one process that run out one after the other.
    let process = Uuid::now_v7();
    let early = store.claim(&format!("{process}/0"), Duration::ZERO).await.expect("a claim").expect("a job").lease;
    let late = store.claim(&format!("{process}/1"), MINUTE).await.expect("a claim").expect("a job").lease;
    tokio::time::sleep(Duration::from_millis(5)).await;
    store.reclaim_expired().await.expect("an answer");
    assert_eq!(counted(early.job).await, (1, 0, Status::Queued), "the other was there");
    store.renew(&late, Duration::ZERO).await.expect("an answer");
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    assert_eq!(counted(late.job).await, (1, 0, Status::Queued), "it was not alone, though it is the last");
    // As suspects they are alone, and each loss counts.
    for losses in 2..=4 {
        assert_eq!(lost(store.as_ref(), &["another process/0"]).await, [first]);
        let status = if losses < 4 { Status::Queued } else { Status::Failed };
        assert_eq!(counted(first).await, (losses, losses - 1, status));
    }
    let error = found(store.as_ref(), first).await.error.expect("a text");
    assert!(error.starts_with("the worker was lost 4 times in a row"), "{error}");
}

async fn a_failed_job_is_queued_again_with_what_it_has_stored(database: Database) {
    let store = database.open().await;
    let id = queued(store.as_ref(), NewJob { most_queued: 1, ..job(1) }).await;
    let retried = async |most| store.retry(id, most).await.expect("an answer");
    assert!(matches!(retried(9).await, Some(Retried::NotRetryable(job)) if job.status == Status::Queued));
    let lease = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    store.append(&lease, &batch(&[line(0, "{}"), line(1, "{}")]), MINUTE).await.expect("stored");
    store.finish(&lease, &Batch::default(), &Ending::failed("so")).await.expect("ended");
    let other = queued(store.as_ref(), NewJob { most_queued: 9, ..job(1) }).await;
    assert!(matches!(retried(1).await, Some(Retried::QueueFull { most: 1 })));
    let Some(Retried::Queued(again)) = retried(2).await else { panic!("it waits again") };
    assert_eq!((again.status, again.error, again.ended_at, again.last_index), (Status::Queued, None, None, Some(1)));
    assert_eq!((again.losses, again.counted_losses), (0, 0));
    let order = [
        store.claim("worker", MINUTE).await.expect("a claim").expect("a job"),
        store.claim("worker", MINUTE).await.expect("a claim").expect("a job"),
    ];
    assert_eq!([order[0].lease.job, order[1].lease.job], [other, id], "it is the last in the queue");
    assert_eq!(order[1].last, Some(line(1, "{}")));
    assert!(store.retry(Uuid::now_v7(), 9).await.expect("an answer").is_none());
    // A run of a sweep stands in its table.
    sweep(store.as_ref(), "a", 1).await;
    let run = store.claim("worker", MINUTE).await.expect("a claim").expect("a job").lease;
    store.finish(&run, &Batch::default(), &Ending::failed("so")).await.expect("ended");
    let refused = store.retry(run.job, 9).await.expect("an answer");
    assert!(matches!(refused, Some(Retried::NotRetryable(job)) if job.run.is_some()));
}
