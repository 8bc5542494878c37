//! What the service costs: a job posted and polled until it has ended, against `arcslip solve` of it, in turn. Medians.
//!
//! `cargo bench --bench overhead` (10,000 increments, 9 times), `cargo bench --bench overhead -- 2000 21`

#[allow(dead_code)]
#[path = "../common/process.rs"]
mod process;
#[allow(dead_code)]
#[path = "../common/service.rs"]
mod service;

use process::{Process, client, get, has_ended, submit};
use serde_json::json;
use service::in_short_steps;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const POLLED: Duration = Duration::from_millis(5);

fn main() {
    let asked: Vec<u64> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let increments = asked.first().copied().unwrap_or(10_000);
    let times = asked.get(1).copied().unwrap_or(9).max(1);
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    println!("| job of {increments} increments | `arcslip solve` | service | ratio | stored |\n|---|--:|--:|--:|--:|");
    for (name, record) in [
        ("one-bar truss", json!({"directions": false})),
        ("one-bar truss, with directions", json!({})),
        ("Klarbring's node, with directions", json!({})),
    ] {
        let scene = if name.starts_with('o') { "one-bar-truss" } else { "klarbring" };
        let of_a_unit = if scene == "klarbring" { increments / 3 } else { increments };
        let mut request = in_short_steps(scene, increments, of_a_unit);
        request["analysis"]["record"] = record;
        let folder = tempfile::tempdir().expect("a folder");
        let (file, lines) = (folder.path().join("request.json"), folder.path().join("path.ndjson"));
        std::fs::write(&file, request.to_string()).expect("written");
        let server = Process::serve(&folder.path().join("jobs.db"), &["--workers", "1"]);
        let client = client();
        let (mut alone, mut served) = (Vec::new(), Vec::new());
        for _ in 0..times {
            let began = Instant::now();
            let status = Command::new(env!("CARGO_BIN_EXE_arcslip"))
                .args(["solve".as_ref(), file.as_os_str(), "--out".as_ref(), lines.as_os_str()])
                .stderr(Stdio::null())
                .status();
            assert!(matches!(status.expect("the program runs").code(), Some(0 | 1)));
            alone.push(began.elapsed().as_secs_f64());
            let began = Instant::now();
            runtime.block_on(async {
                let id = submit(&client, &server.url, "/v1/jobs", &request).await;
                let place = format!("/v1/jobs/{id}");
                let job = loop {
                    let job = get(&client, &server.url, &place).await.expect("the job");
                    if has_ended(&job) {
                        break job;
                    }
                    tokio::time::sleep(POLLED).await;
                };
                assert_ne!(job["status"], "failed", "{job}");
            });
            served.push(began.elapsed().as_secs_f64());
        }
        let stored = std::fs::metadata(&lines).expect("a file").len() as f64 / 1e6;
        let (alone, served) = (median(alone), median(served));
        println!("| {name} | {alone:.3} s | {served:.3} s | {:.2} | {stored:.1} MB |", served / alone);
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
