//! As many jobs as an hour of ordinary use brings, one a second, in a few minutes: each is streamed and polled, some are
//! followed, cancelled or deleted, some are studies, and what has ended is dropped (`--keep`). The server's memory, open
//! files and database are read on the way; memory, files and database may not grow from the second quarter to the last.
//!
//! `cargo bench --bench soak` (3,600 jobs in 4 minutes), `cargo bench --bench soak -- 36000 40` (ten hours' jobs)

#[allow(dead_code)]
#[path = "../common/process.rs"]
mod process;
#[path = "../common/reader.rs"]
mod reader;
#[allow(dead_code)]
#[path = "../common/service.rs"]
mod service;

use process::{Process, client, get, has_ended, submit, until};
use reader::{Format, Reader, Said};
use reqwest::Client;
use serde_json::{Value, json};
use service::{in_short_steps, scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const CLIENTS: usize = 6;
const KEPT: &str = "300";
const READINGS: usize = 24;
/// The last quarter's readings (their mean, of the database the greatest) over those of the second, and what may come on top.
const GROWTH: f64 = 1.1;
const BESIDE: [f64; 4] = [4.0, 8.0, 8.0, 16.0];
const KINDS: [&str; 4] = ["resident MiB", "open files", "database MiB", "log MiB"];

fn main() {
    let asked: Vec<u64> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let jobs = asked.first().copied().unwrap_or(3600).max(READINGS as u64) as usize;
    let minutes = asked.get(1).copied().unwrap_or(4).max(1);
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(run(jobs, Duration::from_secs(60 * minutes)));
}

async fn run(jobs: usize, time: Duration) {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Process::serve(&folder.path().join("jobs.db"), &["--keep", KEPT]);
    let (began, done) = (Instant::now(), Arc::new(AtomicUsize::new(0)));
    let next = Arc::new(AtomicUsize::new(0));
    let clients: Vec<_> = (0..CLIENTS)
        .map(|_| {
            let (url, done, next) = (server.url.clone(), Arc::clone(&done), Arc::clone(&next));
            tokio::spawn(async move {
                let client = client();
                let mut increments = 0;
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= jobs {
                        return increments;
                    }
                    tokio::time::sleep_until((began + time.mul_f64(number as f64 / jobs as f64)).into()).await;
                    increments += one(&client, &url, number).await;
                    done.fetch_add(1, Ordering::Relaxed);
                }
            })
        })
        .collect();
    println!("| jobs done | {} |\n|--:|--:|--:|--:|--:|", KINDS.join(" | "));
    let mut readings = Vec::new();
    for number in 1..=READINGS {
        while done.load(Ordering::Relaxed) < number * jobs / READINGS {
            assert!(clients.iter().any(|client| !client.is_finished()), "the clients have ended early");
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        let reading = read(server.id(), &folder.path().join("jobs.db"));
        let [memory, files, database, log] = reading;
        println!("| {} | {memory:.1} | {files:.0} | {database:.1} | {log:.1} |", done.load(Ordering::Relaxed));
        readings.push(reading);
    }
    let mut increments = 0;
    for client in clients {
        increments += client.await.expect("a client");
    }
    let kept = get(&client(), &server.url, "/readyz").await.expect("an answer");
    assert_eq!(kept["status"], "ready", "{kept}");
    println!("\n{jobs} jobs, {increments} increments streamed, {:.0} s", began.elapsed().as_secs_f64());
    let of = |kind: usize, quarter: usize| {
        let part = readings[quarter * READINGS / 4..(quarter + 1) * READINGS / 4].iter().map(|reading| reading[kind]);
        let count = part.len() as f64;
        // Ended jobs are dropped now and then: the database is a saw, and a quarter has a tooth and a half.
        if KINDS[kind].starts_with("database") { part.fold(0.0, f64::max) } else { part.sum::<f64>() / count }
    };
    let mut grows = Vec::new();
    for (kind, name) in KINDS.iter().enumerate() {
        let (before, after) = (of(kind, 1), of(kind, 3));
        println!("{name}: {before:.1} in the second quarter, {after:.1} in the last");
        if after > GROWTH * before + BESIDE[kind] {
            grows.push(name);
        }
    }
    assert!(grows.is_empty(), "not flat: {grows:?}");
}

/// What one user does with one job; answers how many increments came over its stream.
async fn one(client: &Client, url: &str, number: usize) -> usize {
    if number % 40 == 39 {
        return study(client, url).await;
    }
    let request = match number % 4 {
        0 => in_short_steps("one-bar-truss", 300, 100),
        1 => scene("klarbring"),
        2 => scene("three-snapping-bars"),
        _ => in_short_steps("arch-type-truss", 200, 100),
    };
    let id = submit(client, url, "/v1/jobs", &request).await;
    let place = format!("/v1/jobs/{id}");
    if number % 11 == 10 {
        let cancelled = client.post(format!("{url}{place}/cancel")).send().await.expect("an answer");
        assert_eq!(cancelled.status(), 202);
    }
    let format = if number.is_multiple_of(2) { Format::Events } else { Format::Lines };
    let mut increments = streamed(client, url, &id, format).await;
    let job = until(client, url, &place, has_ended).await;
    assert_ne!(job["status"], "failed", "{job}");
    for of_the_job in ["increments?limit=100", "path.csv"] {
        let answer = client.get(format!("{url}{place}/{of_the_job}")).send().await.expect("an answer");
        assert!(answer.error_for_status().expect("a good one").bytes().await.is_ok());
    }
    get(client, url, "/v1/jobs").await.expect("a list");
    if number % 4 == 1 && number % 11 != 10 {
        let body = json!({"increment": 7, "direction": 0, "max_increments": 6});
        let answer = client.post(format!("{url}{place}/follow")).json(&body).send().await.expect("an answer");
        let child: Value = answer.error_for_status().expect("followed").json().await.expect("a job");
        increments += streamed(client, url, child["id"].as_str().expect("an id"), Format::Events).await;
    }
    if number % 7 == 6 {
        let deleted = client.delete(format!("{url}{place}")).send().await.expect("an answer");
        assert_eq!(deleted.status(), 204);
    }
    increments
}

async fn study(client: &Client, url: &str) -> usize {
    let mut study = scene("klarbring");
    study["study"] = json!({"methods": ["auto"], "arc_lengths": [0.1, 0.05], "repeats": 2});
    let id = submit(client, url, "/v1/studies", &study).await;
    let ended = until(client, url, &format!("/v1/studies/{id}"), has_ended).await;
    assert_eq!(ended["status"], "completed", "{ended}");
    0
}

async fn streamed(client: &Client, url: &str, id: &str, format: Format) -> usize {
    let mut reader = Reader::open(client, url, id, format, None).await;
    let mut count = 0;
    loop {
        match reader.next().await {
            Said::Increment(index, _) => {
                assert_eq!(index, count as u64, "job {id}");
                count += 1;
            }
            Said::End => return count,
            Said::BrokenOff => panic!("the stream of job {id} broke off after {count} increments"),
        }
    }
}

fn read(process: u32, database: &Path) -> [f64; 4] {
    let of_the_process = PathBuf::from(format!("/proc/{process}"));
    let status = std::fs::read_to_string(of_the_process.join("status")).expect("the process");
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("its memory");
    let kilobytes: f64 = resident.trim().trim_end_matches(" kB").parse().expect("a number");
    let files = std::fs::read_dir(of_the_process.join("fd")).expect("its files").count();
    let mebibytes = |file: &Path| std::fs::metadata(file).map_or(0.0, |found| found.len() as f64 / 1048576.0);
    let log = database.with_extension("db-wal");
    [kilobytes / 1024.0, files as f64, mebibytes(database), mebibytes(&log)]
}
