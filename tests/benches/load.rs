//! The service under load, and beside it idle, in one run: many clients queue small jobs while the workers are busy, then
//! many streams are open at once. Every job is looked at in the end, and every increment of every stream.
//!
//! `cargo bench --bench load` (10,000 jobs by 32 clients, 500 streams), `cargo bench --bench load -- 2000 32 100`

#[path = "../common/load.rs"]
mod load;
#[allow(dead_code)]
#[path = "../common/process.rs"]
mod process;
#[path = "../common/reader.rs"]
mod reader;
#[allow(dead_code)]
#[path = "../common/service.rs"]
mod service;

use load::{are_whole, listed, queue, stream_all, worked_off};
use process::{Process, client, has_ended, solved, submit, until};
use reqwest::{Client, RequestBuilder};
use serde_json::{Value, json};
use service::{occupation, scene};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const CALLS: [&str; 4] = ["`GET /v1/jobs/{id}`", "`GET /v1/jobs`", "`GET .../increments`", "`POST /v1/jobs`"];
/// Rounds of calls while nothing else goes on.
const IDLE: usize = 500;
const BETWEEN_ROUNDS: Duration = Duration::from_millis(5);
/// Solves at a time while streams are open, whatever the machine.
const AT_ONCE: usize = 10;
const STREAMED: usize = 20;
const PATIENCE: Duration = Duration::from_secs(600);

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let [jobs, clients, streams] =
        [(0, 10_000), (1, 32), (2, 500)].map(|(place, usual)| asked.get(place).copied().unwrap_or(usual).max(1));
    tokio::runtime::Runtime::new().expect("a runtime").block_on(run(jobs, clients, streams));
}

async fn run(jobs: usize, clients: usize, streams: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let small = scene("klarbring");
    let expected = solved(&small);
    let server = Process::serve(&database, &[]);
    let url = server.url.clone();
    let caller = Caller::new(&url, &small).await;

    let stop = Arc::new(AtomicBool::new(false));
    let mut idle = caller.clone().calls(IDLE, stop.clone()).await;

    let busy = tokio::spawn(caller.clone().calls(usize::MAX, stop.clone()));
    let began = Instant::now();
    let mut ids = queue(&url, &small, jobs, clients).await;
    let queued_in = began.elapsed();
    stop.store(true, Ordering::Relaxed);
    let mut busy = busy.await.expect("calls");
    let waiting = listed(&url, "queued").await.len();
    worked_off(&url, PATIENCE).await;
    let worked_off_in = began.elapsed();
    for calls in [&mut idle, &mut busy] {
        ids.append(&mut calls.queued);
    }
    let completed = listed(&url, "completed").await;
    assert!(ids.iter().all(|id| completed.contains(id)), "not every job has ended as it should");
    let increments = are_whole(&url, &ids, clients, &expected).await;
    server.kill();

    let server = Process::serve(&database, &["--workers", &AT_ONCE.to_string()]);
    let url = server.url.clone();
    let caller = Caller::new(&url, &small).await;
    let busy_workers = queue(&url, &occupation(), AT_ONCE, 1).await;
    let long = long();
    let path = solved(&long);
    let streamed = queue(&url, &long, STREAMED.min(streams), 1).await;
    let stop = Arc::new(AtomicBool::new(false));
    let mut began = Instant::now();
    let mut followed = None;
    let read = stream_all(&url, &streamed, streams, path.len(), async || {
        began = Instant::now();
        followed = Some(tokio::spawn(caller.clone().calls(usize::MAX, stop.clone())));
        for id in &busy_workers {
            let cancelled = client().post(format!("{url}/v1/jobs/{id}/cancel")).send().await.expect("an answer");
            assert_eq!(cancelled.status(), 202);
        }
    })
    .await;
    let streamed_in = began.elapsed();
    stop.store(true, Ordering::Relaxed);
    let mut followed = followed.expect("the streams were open").await.expect("calls");
    worked_off(&url, PATIENCE).await;
    are_whole(&url, &streamed, clients, &path).await;
    are_whole(&url, &followed.queued, clients, &expected).await;

    println!(
        "| call | idle p50 | p99 | {clients} clients queue {jobs} jobs: p50 | p99 | p99 to idle | \
         {streams} streams open: p50 | p99 | p99 to idle |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|"
    );
    for (call, name) in CALLS.iter().enumerate() {
        let [idle, busy, followed] = [&mut idle, &mut busy, &mut followed].map(|calls| calls.percentiles(call));
        println!(
            "| {name} | {:.2} ms | {:.2} ms | {:.2} ms | {:.2} ms | {:.1} | {:.2} ms | {:.2} ms | {:.1} |",
            idle[0],
            idle[1],
            busy[0],
            busy[1],
            busy[1] / idle[1],
            followed[0],
            followed[1],
            followed[1] / idle[1]
        );
    }
    let behind = |part: f64| read.behind[((read.behind.len() - 1) as f64 * part) as usize].as_secs_f64() * 1e3;
    let per_second = |count: usize, time: Duration| count as f64 / time.as_secs_f64();
    println!(
        "\n| what | |\n|---|--:|\n\
         | calls timed, idle, while jobs were queued, with streams open | {}, {}, {} |\n\
         | jobs queued a second | {:.0} |\n\
         | of {jobs}, jobs still waiting when the last was queued | {waiting} |\n\
         | jobs worked off a second, queueing included | {:.0} |\n\
         | increments of them, each stored once | {increments} |\n\
         | streams at once, of {} jobs, {AT_ONCE} of which ran at a time | {streams} |\n\
         | increments delivered, each once | {} |\n\
         | delivered a second | {:.0} |\n\
         | broken off and resumed | {} |\n\
         | behind the first reader of an increment: p50, p99, longest | {:.1} ms, {:.1} ms, {:.1} ms |",
        idle.count(),
        busy.count(),
        followed.count(),
        per_second(jobs, queued_in),
        per_second(jobs, worked_off_in),
        streamed.len(),
        read.increments,
        per_second(read.increments, streamed_in),
        read.resumed,
        behind(0.5),
        behind(0.99),
        behind(1.0),
    );
}

/// A job whose solver takes about as long for an increment as the service does: its streams have something to wait for.
fn long() -> Value {
    let mut request = arcslip::check::scenes::of_any_size::row_of_bars(6);
    request["analysis"] = json!({
        "max_increments": 2000, "arc_length": {"initial": 1e-3, "min": 1e-6, "max": 1e-3},
        "record": {"nodes": ["tip0"], "contacts": [], "directions": false}
    });
    request
}

/// Makes one call after another, each of which a user waits for.
#[derive(Clone)]
struct Caller {
    client: Client,
    url: String,
    small: Value,
    /// A job that has ended.
    ended: String,
}

/// How long each kind of call took, in milliseconds.
#[derive(Default)]
struct Calls {
    times: [Vec<f64>; CALLS.len()],
    queued: Vec<String>,
}

impl Caller {
    async fn new(url: &str, small: &Value) -> Self {
        let client = client();
        let ended = submit(&client, url, "/v1/jobs", &scene("one-bar-truss")).await;
        until(&client, url, &format!("/v1/jobs/{ended}"), has_ended).await;
        Self { client, url: url.to_owned(), small: small.clone(), ended }
    }

    async fn calls(self, rounds: usize, stop: Arc<AtomicBool>) -> Calls {
        let mut calls = Calls::default();
        for _ in 0..rounds {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let job = format!("{}/v1/jobs/{}", self.url, self.ended);
            let get = |place: String| self.client.get(place);
            calls.time(0, get(job.clone())).await;
            calls.time(1, get(format!("{}/v1/jobs", self.url))).await;
            calls.time(2, get(format!("{job}/increments"))).await;
            let queued = calls.time(3, self.client.post(format!("{}/v1/jobs", self.url)).json(&self.small)).await;
            calls.queued.push(queued["id"].as_str().expect("an id").to_owned());
            tokio::time::sleep(BETWEEN_ROUNDS).await;
        }
        calls
    }
}

impl Calls {
    async fn time(&mut self, call: usize, ask: RequestBuilder) -> Value {
        let began = Instant::now();
        let answer = ask.send().await.expect("an answer").error_for_status().expect("a good one");
        let body = answer.bytes().await.expect("a body");
        self.times[call].push(began.elapsed().as_secs_f64() * 1e3);
        serde_json::from_slice(&body).expect("JSON")
    }

    fn count(&self) -> usize {
        self.times[0].len()
    }

    /// The median and the 99th.
    fn percentiles(&mut self, call: usize) -> [f64; 2] {
        let times = &mut self.times[call];
        times.sort_by(f64::total_cmp);
        [0.5, 0.99].map(|part| times[((times.len() - 1) as f64 * part).round() as usize])
    }
}
