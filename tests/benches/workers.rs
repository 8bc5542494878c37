//! Small jobs by one, two and four worker processes on one PostgreSQL, whose commits are synced, and on one SQLite file beside
//! it in one run: jobs and increments a second, how long an idle service lets a job wait, and what the database takes of the
//! time. Every job is looked at in the end: each ended once, with all of its increments.
//!
//! `cargo bench --bench workers` (5,000 jobs), `cargo bench --bench workers -- 500`. Needs Debian's `postgresql`.

#[allow(dead_code)]
#[path = "../common/load.rs"]
mod load;
#[allow(dead_code)]
#[path = "../common/postgres.rs"]
mod postgres;
#[allow(dead_code)]
#[path = "../common/process.rs"]
mod process;
#[path = "../common/reader.rs"]
mod reader;
#[allow(dead_code)]
#[path = "../common/service.rs"]
mod service;

use arcslip::service::store::{self, Batch, Ending, Line, Location, NewJob, Status, Task};
use load::{are_whole, listed, queue, worked_off};
use postgres::Postgres;
use process::{Process, client, has_ended, solved, submit, until};
use serde_json::Value;
use service::scene;
use std::time::{Duration, Instant};

const WORKERS: [usize; 3] = [1, 2, 4];
const CLIENTS: usize = 16;
/// Jobs that come one by one while nobody is busy.
const ALONE: usize = 40;
/// Lines of one append: as the first of a job come, as those of a fast path do, and as many as go together.
const BATCHES: [usize; 3] = [1, 20, 2000];
const REPEATS: usize = 40;
const PATIENCE: Duration = Duration::from_secs(1800);
const MINUTE: Duration = Duration::from_secs(60);

struct Row {
    engine: &'static str,
    workers: usize,
    took: Duration,
    increments: usize,
    /// Of jobs that come alone, in milliseconds.
    waits: Vec<u64>,
}

fn main() {
    let jobs = std::env::args().find_map(|word| word.parse().ok()).unwrap_or(5000);
    tokio::runtime::Runtime::new().expect("a runtime").block_on(run(jobs));
}

async fn run(jobs: usize) {
    let Some(server) = Postgres::start(true) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let mut rows = Vec::new();
    for workers in WORKERS {
        let file = folder.path().join(format!("{workers}.db")).display().to_string();
        rows.push(measured("SQLite", &file, workers, jobs).await);
        rows.push(measured("PostgreSQL", &server.database().await, workers, jobs).await);
    }
    println!(
        "\n| engine | worker processes | jobs a second | increments a second | against one on SQLite | wait of a job alone |"
    );
    println!("|---|---|---|---|---|---|");
    let one = rows[0].took.as_secs_f64();
    for Row { engine, workers, took, increments, waits } in &rows {
        let seconds = took.as_secs_f64();
        println!(
            "| {engine} | {workers} | {:.0} | {:.0} | {:.2} | {} ms, {} ms at most |",
            jobs as f64 / seconds,
            *increments as f64 / seconds,
            one / seconds,
            waits[waits.len() / 2],
            waits[waits.len() - 1]
        );
    }
    println!("\n| call | SQLite | PostgreSQL |\n|---|---|---|");
    let file: Location = folder.path().join("calls.db").as_path().into();
    let on_a_server = server.database().await;
    let (sqlite, postgres) = (calls(file).await, calls(on_a_server.as_str().into()).await);
    for ((call, one), (_, other)) in sqlite.iter().zip(&postgres) {
        println!("| {call} | {} | {} |", microseconds(*one), microseconds(*other));
    }
}

fn microseconds(time: Duration) -> String {
    format!("{:.1} µs", time.as_secs_f64() * 1e6)
}

/// All jobs queued before anybody works.
async fn measured(engine: &'static str, database: &str, workers: usize, jobs: usize) -> Row {
    let small = scene("klarbring");
    let expected = solved(&small);
    let server = Process::serve(database, &["--workers", "0"]);
    let ids = queue(&server.url, &small, jobs, CLIENTS).await;
    let began = Instant::now();
    let at_work: Vec<Process> = (0..workers).map(|_| Process::work(database, &["--workers", "1"])).collect();
    worked_off(&server.url, PATIENCE).await;
    let took = began.elapsed();
    let completed = listed(&server.url, "completed").await;
    assert!(ids.len() == completed.len() && ids.iter().all(|id| completed.contains(id)), "not every job ended once");
    let increments = are_whole(&server.url, &ids, CLIENTS, &expected).await;
    let waits = alone(&server, &small).await;
    drop(at_work);
    println!("{engine}, {workers}: {jobs} jobs in {took:?}");
    Row { engine, workers, took, increments, waits }
}

/// From taking a job to its start, one job at a time; sorted.
async fn alone(server: &Process, request: &Value) -> Vec<u64> {
    let client = client();
    let mut waits = Vec::new();
    for _ in 0..ALONE {
        let id = submit(&client, &server.url, "/v1/jobs", request).await;
        let job = until(&client, &server.url, &format!("/v1/jobs/{id}"), has_ended).await;
        let time = |name: &str| -> jiff::Timestamp { job[name].as_str().expect("a time").parse().expect("a time") };
        let wait = time("started_at").duration_since(time("created_at")).as_millis();
        waits.push(u64::try_from(wait).unwrap_or(0));
    }
    waits.sort_unstable();
    waits
}

/// How long the calls of one worker take, the median; appends for each increment.
async fn calls(location: Location) -> Vec<(String, Duration)> {
    let store = store::open(location).await.expect("a store");
    let body = solved(&scene("klarbring")).pop().expect("a line");
    let mut times: Vec<(String, Vec<Duration>)> = Vec::new();
    let mut note = |call: &str, took: Duration| match times.iter_mut().find(|(name, _)| name == call) {
        Some((_, times)) => times.push(took),
        None => times.push((call.to_owned(), vec![took])),
    };
    for _ in 0..REPEATS {
        let began = Instant::now();
        store.submit(small_job()).await.expect("queued");
        note("submit", began.elapsed());
        let began = Instant::now();
        let lease = store.claim("worker", MINUTE).await.expect("an answer").expect("a job").lease;
        note("claim", began.elapsed());
        let mut next = 0;
        for lines in BATCHES {
            let batch = Batch::from(lines_from(next, lines, &body));
            next += lines as u64;
            let began = Instant::now();
            store.append(&lease, &batch, MINUTE).await.expect("stored");
            note(&format!("append {lines}, an increment"), began.elapsed() / lines as u32);
        }
        let began = Instant::now();
        store.renew(&lease, MINUTE).await.expect("an answer");
        note("renew", began.elapsed());
        let began = Instant::now();
        let ending = Ending { status: Status::Completed, ..Ending::failed("") };
        store.finish(&lease, &Batch::default(), &ending).await.expect("an answer");
        note("finish", began.elapsed());
    }
    store.close().await;
    let median = |mut times: Vec<Duration>| {
        times.sort_unstable();
        times[times.len() / 2]
    };
    times.into_iter().map(|(call, times)| (call, median(times))).collect()
}

fn lines_from(first: u64, count: usize, body: &str) -> Vec<Line> {
    (first..first + count as u64).map(|index| Line { index, body: body.to_owned(), branch: None }).collect()
}

fn small_job() -> NewJob {
    NewJob {
        task: Task::Path,
        owner: None,
        name: None,
        request: scene("klarbring").to_string(),
        plan: "{}".to_owned(),
        summary: None,
        max_increments: 10_000,
        max_attempts: 3,
        most_queued: 100_000,
        priority: 0,
        idempotency_key: None,
        explore: None,
    }
}
