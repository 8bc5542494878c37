//! What the store promises of jobs as clients see them, on both engines: lists, jobs that follow others, explorations,
//! deletion and what is kept.

use crate::common::engines::{Database, batch, found, job, line, queued};
use crate::on_both_engines;
use arcslip::model::request::Explore;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{
    Batch, Branch, Claim, Ending, Keep, LeaseAnswer, Line, ListFilter, NewFollower, NewJob, NewRun, NewSweep, Page,
    Parent, Status, Submitted, SweepRefinement, Task,
};
use std::time::Duration;
use uuid::Uuid;

const MINUTE: Duration = Duration::from_secs(60);
const ALL: Page = Page { rows: 10_000, bytes: usize::MAX };

on_both_engines! {
    lists_are_filtered_and_go_on_from_a_job,
    a_job_that_follows_another_stands_on_its_own,
    an_exploration_queues_each_direction_once_in_order,
    an_exploration_looked_at_by_many_at_once_queues_the_same,
    a_deleted_job_takes_all_its_rows_along,
    what_is_not_to_be_kept_is_dropped,
    a_sweep_ends_with_its_runs_however_they_do,
}

/// An increment with a branch of these alternatives.
fn branching(index: u64, trail: Option<&str>, alternatives: &[u64]) -> Line {
    let branch = Branch {
        body: format!("branch {index}"),
        trail: trail.map(str::to_owned),
        alternatives: alternatives.to_vec(),
    };
    Line { branch: Some(branch), ..line(index, "{}") }
}

/// Claims the next job. An engine that passes over locked rows may have none for a moment, while a transaction ends.
async fn claimed(store: &dyn Store) -> Claim {
    for _ in 0..100 {
        if let Some(claim) = store.claim("worker", MINUTE).await.expect("an answer") {
            return claim;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("no job is free");
}

/// Claims the next job, stores lines and completes it.
async fn completed(store: &dyn Store, lines: &[Line]) -> Uuid {
    let claim = claimed(store).await;
    store.append(&claim.lease, &batch(lines), MINUTE).await.expect("stored");
    let ending = Ending {
        status: Status::Completed,
        stop_reason: None,
        report: Some("{}".to_owned()),
        error: None,
        responses: None,
    };
    store.finish(&claim.lease, &Batch::default(), &ending).await.expect("an answer");
    claim.lease.job
}

fn all(task: Task) -> ListFilter {
    ListFilter {
        task,
        owner: None,
        status: None,
        sweep: None,
        parent: None,
        before: None,
        page: Page { rows: 100, bytes: usize::MAX },
    }
}

/// Runs that complete, fail with their workers, are dropped or cancelled: each has one row, and the last one ends the sweep.
async fn a_sweep_ends_with_its_runs_however_they_do(database: Database) {
    let store = database.open().await;
    let run = |number: u64| NewRun {
        name: Some(format!("name {number}")),
        request: format!("request {number}"),
        plan: "{}".to_owned(),
        values: format!("[{number}.50,\"a \\\"name\\\"\"]"),
        asked: (number == 0).then(|| "{\"load\":{}}".to_owned()),
        max_increments: 9,
    };
    let whole = |key: &str| NewJob {
        task: Task::Sweep,
        max_increments: 5,
        max_attempts: 1,
        most_queued: 7,
        idempotency_key: Some(key.to_owned()),
        ..job(1)
    };
    let new = |key: &str| NewSweep { whole: whole(key), runs: (0..5).map(run).collect(), refine: 0 };
    let Ok(Submitted::Created(sweep)) = store.submit_sweep(new("one")).await else { panic!("not stored") };
    assert_eq!((sweep.task, sweep.status, sweep.last_index), (Task::Sweep, Status::Running, None));
    assert!(matches!(store.submit_sweep(new("one")).await, Ok(Submitted::Repeated(found)) if found.id == sweep.id));
    assert!(
        matches!(store.submit_sweep(new("two")).await, Ok(Submitted::QueueFull { most: 7 })),
        "there is room for two"
    );
    let tally = async || {
        let tallies = store.tally().await.expect("tallies");
        let of = |status| tallies.iter().find(|(known, _)| *known == status).map_or(0, |(_, count)| *count);
        (of(Status::Queued), of(Status::Running))
    };
    assert_eq!(tally().await, (5, 0), "nobody works on the sweep itself");
    let runs = listed(store.as_ref(), ListFilter { sweep: Some(sweep.id), ..all(Task::Path) }).await;
    assert_eq!(runs.len(), 5);
    assert_eq!(store.request(runs[0]).await.expect("an answer").as_deref(), Some("request 4"), "newest first");

    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    for (index, limit) in [(0, "{\"load_factor\":0.10}"), (1, "{\"load_factor\":0.7}")] {
        let batch = Batch { first_limit: Some(limit.to_owned()), ..batch(&[line(index, "{}")]) };
        store.append(&claim.lease, &batch, MINUTE).await.expect("stored");
    }
    let stop_reason = Some("stages_completed".to_owned());
    assert_eq!(claim.asked.as_deref(), Some("{\"load\":{}}"));
    let responses = Some("{\"load\":0.70}".to_owned());
    let ending =
        Ending { status: Status::Completed, stop_reason, report: Some("{}".to_owned()), error: None, responses };
    store.finish(&claim.lease, &Batch::default(), &ending).await.expect("an answer");
    store.claim("lost", Duration::ZERO).await.expect("an answer").expect("a job");
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.reclaim_expired().await.expect("an answer"), 1);
    let working = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    assert!(store.delete(runs[0]).await.expect("an answer"), "the last one, which waits");
    assert_eq!(store.cancel_sweep(sweep.id).await.expect("an answer"), [working.lease.job]);
    store.request_cancel(sweep.id).await.expect("an answer");
    let standing = async || store.standing(sweep.id).await.expect("an answer").expect("a sweep");
    assert_eq!((standing().await.status, standing().await.last_index), (Status::Running, Some(3)), "one is at work");
    assert_eq!(store.release(&working.lease).await.expect("an answer"), LeaseAnswer::Held { cancel_requested: true });
    assert_eq!((standing().await.status, standing().await.last_index), (Status::Cancelled, Some(4)));
    let lines = store.increments(sweep.id, None, ALL).await.expect("rows");
    let rows: Vec<serde_json::Value> = lines.iter().map(|row| serde_json::from_str(&row.body).expect("JSON")).collect();
    let told: Vec<(u64, &str)> = rows
        .iter()
        .map(|row| (row["run"].as_u64().expect("a number"), row["status"].as_str().expect("text")))
        .collect();
    assert_eq!(told, [(0, "completed"), (1, "failed"), (4, "cancelled"), (3, "cancelled"), (2, "cancelled")]);
    assert_eq!(rows[0]["job"], claim.lease.job.to_string());
    let (first, job) = (&lines[0].body, claim.lease.job);
    assert!(
        first.starts_with(&format!("{{\"run\":0,\"job\":\"{job}\",\"values\":[")),
        "as any engine writes it: {first}"
    );
    assert_eq!(found(store.as_ref(), job).await.name.as_deref(), Some("name 0"));
    assert_eq!(rows[0]["values"], serde_json::json!([0.5, "a \"name\""]));
    assert_eq!((&rows[0]["first_limit"]["load_factor"], &rows[0]["last_index"]), (&0.1.into(), &1.into()));
    assert_eq!(rows[0]["stop_reason"], "stages_completed");
    assert_eq!(rows[0]["responses"], serde_json::json!({"load": 0.7}));
    assert!(rows[1]["responses"].is_null());
    assert!(rows[1]["error"].as_str().expect("text").contains("was lost"));
    assert_eq!(rows[2]["error"], "it was deleted");
    let ended = store.job(sweep.id).await.expect("an answer").expect("a sweep");
    assert!(ended.ended_at.is_some() && ended.stop_reason.as_deref() == Some("cancelled"));
    assert_eq!(tally().await, (0, 0));

    // More than end in one statement.
    let many = NewSweep {
        whole: NewJob { max_increments: 1_200, most_queued: 2_000, ..whole("many") },
        runs: (0..1_200).map(run).collect(),
        refine: 7,
    };
    let Ok(Submitted::Created(many)) = store.submit_sweep(many).await else { panic!("not stored") };
    assert!(store.cancel_sweep(many.id).await.expect("an answer").is_empty(), "nobody is at work");
    let standing = store.standing(many.id).await.expect("an answer").expect("a sweep");
    assert_eq!((standing.status, standing.last_index), (Status::Cancelled, Some(1_199)));
    assert_eq!(tally().await, (0, 0));

    // Further runs are queued once, however many see that the others have ended; and a sweep that waits for some is cancelled.
    for cancelled in [false, true] {
        let key = if cancelled { "refined and cancelled" } else { "refined" };
        let new =
            NewSweep { whole: NewJob { max_increments: 2, ..whole(key) }, runs: (0..2).map(run).collect(), refine: 3 };
        let Ok(Submitted::Created(sweep)) = store.submit_sweep(new).await else { panic!("not stored") };
        let end_all = async || {
            while let Some(claim) = store.claim("worker", MINUTE).await.expect("an answer") {
                assert!(!store.refinable_sweeps().await.expect("an answer").contains(&sweep.id));
                let ending = Ending { status: Status::Completed, ..Ending::failed("") };
                store.finish(&claim.lease, &Batch::default(), &ending).await.expect("an answer");
            }
        };
        end_all().await;
        assert_eq!(store.refinable_sweeps().await.expect("an answer"), [sweep.id]);
        let further = |before: u64, runs: u64| SweepRefinement {
            sweep: sweep.id,
            before,
            plan: "[1]".to_owned(),
            summary: None,
            runs: (before..before + runs).map(run).collect(),
        };
        let refined = async |before, runs| store.refine_sweep(further(before, runs)).await.expect("an answer");
        assert!(refined(2, 2).await && !refined(2, 2).await);
        assert!(!refined(4, 1).await, "its runs have not ended");
        end_all().await;
        if cancelled {
            assert!(store.cancel_sweep(sweep.id).await.expect("an answer").is_empty());
            assert!(!refined(4, 1).await);
        } else {
            assert!(refined(4, 0).await, "none is worth while");
        }
        let whole = found(store.as_ref(), sweep.id).await;
        let status = if cancelled { Status::Cancelled } else { Status::Completed };
        assert_eq!((whole.status, whole.last_index, whole.max_increments), (status, Some(3), 4));
        let numbers: Vec<serde_json::Value> = store
            .increments(sweep.id, None, ALL)
            .await
            .expect("rows")
            .iter()
            .map(|row| serde_json::from_str::<serde_json::Value>(&row.body).expect("JSON")["run"].clone())
            .collect();
        assert_eq!(numbers, [0, 1, 2, 3]);
    }

    // Dropped while its runs wait and work: all of it is gone.
    let Ok(Submitted::Created(sweep)) = store.submit_sweep(new("three")).await else { panic!("not stored") };
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    assert!(store.delete(sweep.id).await.expect("an answer"));
    assert_eq!(store.renew(&claim.lease, MINUTE).await.expect("an answer"), LeaseAnswer::Lost);
    assert!(listed(store.as_ref(), ListFilter { sweep: Some(sweep.id), ..all(Task::Path) }).await.is_empty());
    assert!(store.increments(sweep.id, None, ALL).await.expect("rows").is_empty());
    assert_eq!(tally().await, (0, 0));
}

async fn listed(store: &dyn Store, filter: ListFilter) -> Vec<Uuid> {
    store.jobs(filter).await.expect("a list").jobs.into_iter().map(|job| job.id).collect()
}

fn follower(job: Uuid, increment: u64, direction: u64) -> NewFollower {
    let parent = Parent { job, increment, direction };
    NewFollower { parent, owner: None, max_increments: None, idempotency_key: None, most_queued: 100 }
}

async fn lists_are_filtered_and_go_on_from_a_job(database: Database) {
    let store = database.open().await;
    let mut paths = Vec::new();
    for owner in [None, Some("anna"), Some("bert"), Some("anna")] {
        let mut given = job(3);
        given.owner = owner.map(str::to_owned);
        paths.push(queued(store.as_ref(), given).await);
    }
    let mut given = job(3);
    given.task = Task::Study;
    let study = queued(store.as_ref(), given).await;
    let done = completed(store.as_ref(), &[line(0, "{}")]).await;
    assert_eq!(done, paths[0]);
    let newest_first: Vec<Uuid> = paths.iter().rev().copied().collect();
    assert_eq!(listed(store.as_ref(), all(Task::Path)).await, newest_first);
    assert_eq!(listed(store.as_ref(), all(Task::Study)).await, [study]);
    let of_anna = ListFilter { owner: Some("anna".to_owned()), ..all(Task::Path) };
    assert_eq!(listed(store.as_ref(), of_anna.clone()).await, [paths[3], paths[1]]);
    let waiting =
        ListFilter { status: Some(Status::Queued), page: Page { rows: 2, bytes: usize::MAX }, ..all(Task::Path) };
    assert_eq!(listed(store.as_ref(), waiting.clone()).await, newest_first[..2]);
    let rest = ListFilter { before: Some(newest_first[1]), ..waiting };
    assert_eq!(listed(store.as_ref(), rest).await, newest_first[2..3]);
    let none = ListFilter { status: Some(Status::Completed), ..of_anna };
    assert!(listed(store.as_ref(), none).await.is_empty());
}

async fn a_job_that_follows_another_stands_on_its_own(database: Database) {
    let store = database.open().await;
    let mut given = job(4);
    given.owner = Some("anna".to_owned());
    queued(store.as_ref(), given).await;
    let lines = [branching(0, Some("a"), &[]), line(1, "{}"), branching(2, None, &[]), branching(5, Some("b"), &[])];
    let parent = completed(store.as_ref(), &lines).await;
    let branch = store.branch(parent, 4).await.expect("an answer").expect("a branch");
    assert_eq!((branch.body.as_str(), branch.trail.as_str()), ("branch 2", "a"));
    let last = store.branch(parent, u64::MAX).await.expect("an answer").expect("a branch");
    assert_eq!((last.body.as_str(), last.trail.as_str()), ("branch 5", "a\nb"));

    let mut asked = follower(parent, 5, 1);
    asked.idempotency_key = Some("key".to_owned());
    asked.max_increments = Some(9);
    let Some(Submitted::Created(child)) = store.follow(asked.clone()).await.expect("an answer") else { panic!() };
    assert_eq!((child.parent, child.max_increments), (Some(asked.parent), 9));
    assert_eq!((child.owner.as_deref(), child.max_attempts, child.name.as_deref()), (Some("anna"), 4, Some("queued")));
    let again = store.follow(asked.clone()).await.expect("an answer");
    assert!(matches!(again, Some(Submitted::Repeated(job)) if job.id == child.id));
    let mut otherwise = asked.clone();
    otherwise.parent.direction = 2;
    assert!(matches!(store.follow(otherwise).await.expect("an answer"), Some(Submitted::KeyReused)));
    let mut full = follower(parent, 5, 2);
    full.most_queued = 1;
    assert!(matches!(store.follow(full).await.expect("an answer"), Some(Submitted::QueueFull { most: 1 })));
    assert!(store.follow(follower(Uuid::now_v7(), 5, 1)).await.expect("an answer").is_none(), "no such job");
    let record = store.job(parent).await.expect("an answer").expect("a job");
    assert_eq!((record.children, record.report.as_deref()), (1, Some("{}")));
    let children = ListFilter { parent: Some(parent), ..all(Task::Path) };
    assert_eq!(listed(store.as_ref(), children).await, [child.id]);

    assert!(store.delete(parent).await.expect("an answer"));
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    let (from, origin) = claim.origin.expect("where it begins");
    assert_eq!((claim.lease.job, from, origin), (child.id, asked.parent, last));
    // What a branch of an earlier attempt was is told.
    let mut stored = batch(&[branching(6, None, &[])]);
    stored.lines.push(line(7, "{}"));
    store.append(&claim.lease, &stored, MINUTE).await.expect("stored");
    store.release(&claim.lease).await.expect("an answer");
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    assert_eq!((claim.last_branch.as_deref(), claim.last), (Some("branch 6"), Some(line(7, "{}"))));
    assert_eq!(claim.stored_bytes, 2 + 8 + 2);
}

/// Increments, directions and generations of a family's jobs in the order of queueing.
async fn family(store: &dyn Store, first: Uuid) -> Vec<(u64, u64, u64)> {
    let mut found = Vec::new();
    for job in store.jobs(all(Task::Path)).await.expect("a list").jobs.into_iter().rev() {
        let Some(membership) = job.membership else { continue };
        assert_eq!(membership.family, first);
        let (increment, direction) = job.parent.map_or((0, 0), |parent| (parent.increment, parent.direction));
        found.push((increment, direction, membership.generation));
    }
    found
}

async fn an_exploration_queues_each_direction_once_in_order(database: Database) {
    let store = database.open().await;
    let mut given = job(3);
    given.explore = Some(Explore { depth: 2, max_jobs: 4 });
    let first = queued(store.as_ref(), given).await;
    let begun = store.job(first).await.expect("an answer").expect("a job").membership.expect("a family");
    assert_eq!((begun.explore, begun.explored), (Explore { depth: 2, max_jobs: 4 }, false));
    assert_eq!(store.explore().await.expect("an answer"), 0, "it has not ended");
    completed(store.as_ref(), &[branching(0, None, &[1]), branching(3, None, &[0, 2])]).await;
    assert_eq!(store.explore().await.expect("an answer"), 3);
    assert_eq!(store.explore().await.expect("an answer"), 0, "once");
    assert_eq!(family(store.as_ref(), first).await, [(0, 0, 0), (0, 1, 1), (3, 0, 1), (3, 2, 1)]);
    // The second of a generation ends before the first, and waits for it.
    let one = claimed(store.as_ref()).await;
    assert!(one.explores);
    completed(store.as_ref(), &[branching(8, None, &[6])]).await;
    assert_eq!(store.explore().await.expect("an answer"), 0);
    store.append(&one.lease, &batch(&[branching(7, None, &[5])]), MINUTE).await.expect("stored");
    let stopped = Ending { status: Status::Stopped, ..Ending::failed("") };
    store.finish(&one.lease, &Batch::default(), &stopped).await.expect("an answer");
    assert_eq!(store.explore().await.expect("an answer"), 1, "there is room for one more");
    completed(store.as_ref(), &[branching(9, None, &[9])]).await;
    // Too deep.
    completed(store.as_ref(), &[branching(10, None, &[9, 10])]).await;
    assert_eq!(store.explore().await.expect("an answer"), 0);
    let found = family(store.as_ref(), first).await;
    assert_eq!(found, [(0, 0, 0), (0, 1, 1), (3, 0, 1), (3, 2, 1), (7, 5, 2)]);
    let ended = store.job(first).await.expect("an answer").expect("a job").membership.expect("a family");
    assert_eq!((ended.explored, ended.family_queued, ended.family_not_queued), (true, 4, 4));
}

async fn an_exploration_looked_at_by_many_at_once_queues_the_same(database: Database) {
    let store = database.open().await;
    let mut given = job(3);
    given.explore = Some(Explore { depth: 1, max_jobs: 30 });
    let first = queued(store.as_ref(), given).await;
    let lines: Vec<Line> = (0..10).map(|index| branching(index, None, &[1, 2])).collect();
    completed(store.as_ref(), &lines).await;
    let mut looks = Vec::new();
    for _ in 0..6 {
        let store = database.open().await;
        looks.push(tokio::spawn(async move { store.explore().await.expect("an answer") }));
    }
    let mut found = 0;
    for look in looks {
        found += look.await.expect("it ends");
    }
    assert_eq!(found, 20);
    let expected = (0..10).flat_map(|index| [(index, 1, 1), (index, 2, 1)]);
    assert_eq!(family(store.as_ref(), first).await[1..], expected.collect::<Vec<_>>());
}

async fn a_deleted_job_takes_all_its_rows_along(database: Database) {
    let store = database.open().await;
    let mut given = job(3);
    given.explore = Some(Explore { depth: 1, max_jobs: 3 });
    let id = queued(store.as_ref(), given).await;
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    let mut stored = Batch::from(vec![branching(0, Some("a"), &[1])]);
    let body = "at 0".to_owned();
    let trail = Some("a".to_owned());
    stored.checkpoints = vec![arcslip::service::store::Checkpoint { index: 0, body, trail, begins_trail: true }];
    store.append(&claim.lease, &stored, MINUTE).await.expect("stored");
    assert!(store.delete(id).await.expect("an answer"));
    assert!(!store.delete(id).await.expect("an answer"), "once");
    let late = store.append(&claim.lease, &batch(&[line(1, "{}")]), MINUTE).await.expect("an answer");
    assert_eq!(late, arcslip::service::store::LeaseAnswer::Lost);
    assert!(store.job(id).await.expect("an answer").is_none());
    assert!(store.increments(id, None, ALL).await.expect("an answer").is_empty());
    assert!(store.branch(id, 5).await.expect("an answer").is_none());
    assert!(store.tally().await.expect("an answer").iter().all(|(_, jobs)| *jobs == 0));
    for table in ["jobs", "increments", "branches", "checkpoints", "checkpoint_trails", "families"] {
        assert_eq!(database.count(table).await, 0, "{table}");
    }
}

async fn what_is_not_to_be_kept_is_dropped(database: Database) {
    let store = database.open().await;
    for _ in 0..25 {
        queued(store.as_ref(), job(3)).await;
    }
    let mut ended = Vec::new();
    for _ in 0..20 {
        ended.push(completed(store.as_ref(), &[line(0, "{}")]).await);
    }
    let mut given = job(3);
    given.explore = Some(Explore { depth: 1, max_jobs: 3 });
    given.priority = 1;
    queued(store.as_ref(), given).await;
    let explored = completed(store.as_ref(), &[branching(0, None, &[])]).await;
    assert_eq!(store.retire(Keep::For(MINUTE)).await.expect("an answer"), 0);
    let mut dropped = 0;
    loop {
        match store.retire(Keep::Newest(4)).await.expect("an answer") {
            0 => break,
            count => dropped += count,
        }
    }
    assert_eq!(dropped, 16);
    let left = listed(store.as_ref(), ListFilter { status: Some(Status::Completed), ..all(Task::Path) }).await;
    assert_eq!(left, [explored, ended[19], ended[18], ended[17], ended[16]]);
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.retire(Keep::For(Duration::ZERO)).await.expect("an answer"), 4, "not what has to be looked at");
    store.explore().await.expect("an answer");
    assert_eq!(store.retire(Keep::For(Duration::ZERO)).await.expect("an answer"), 1);
    while store.shrink().await.expect("an answer") {}
}
