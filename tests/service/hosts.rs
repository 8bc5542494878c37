//! Processes of many hosts on one PostgreSQL: the real program as a server that solves nothing and as workers that listen
//! nowhere; killed, halted past their lease, cut off, and with the database restarted under them. Every job ends once, with the
//! increments of one machine.

use crate::common::cut::Proxy;
use crate::common::engines::Database;
use crate::common::kills::{Random, assert_undisturbed, strip};
use crate::common::postgres::{Postgres, shared};
use crate::common::process::{Process, client, get, has_ended, lines, solved, submit, until};
use crate::common::server::EventStream;
use crate::common::service::{in_short_steps, scene};
use reqwest::Client;
use serde_json::{Value, json};
use std::time::Duration;

const SERVER: [&str; 6] = ["--workers", "0", "--lease", "600ms", "--max-attempts", "50"];
const WORKER: [&str; 4] = ["--workers", "2", "--lease", "600ms"];

/// A job of some seconds.
fn long() -> Value {
    in_short_steps("one-bar-truss", 20_000, 20_000)
}

async fn stored(client: &Client, url: &str, id: &str, least: u64) {
    let place = format!("/v1/jobs/{id}");
    until(client, url, &place, |job| job["progress"]["increments"].as_u64() >= Some(least)).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_of_one_process_shows_a_job_solved_by_another_as_it_converges() {
    let Some(postgres) = shared() else { return };
    let database = postgres.database().await;
    let client = client();
    let server = Process::serve(&database, &SERVER);
    let ready = get(&client, &server.url, "/readyz").await.expect("an answer");
    assert_eq!((&ready["status"], &ready["workers"]), (&json!("ready"), &json!(0)));
    let id = submit(&client, &server.url, "/v1/jobs", &long()).await;
    tokio::time::sleep(Duration::from_millis(300)).await;
    let job = get(&client, &server.url, &format!("/v1/jobs/{id}")).await.expect("the job");
    assert_eq!(job["status"], "queued", "nobody works yet: {job}");
    let stream = client.get(format!("{}/v1/jobs/{id}/stream", server.url)).send().await.expect("an answer");
    let mut stream = EventStream::of(stream);
    let worker = Process::work(&database, &WORKER);
    let mut read = Vec::new();
    loop {
        let event = stream.next().await.expect("an event");
        if event.event == "end" {
            assert_eq!(serde_json::from_str::<Value>(&event.data).expect("JSON")["id"], json!(id));
            break;
        }
        read.push(event.data);
    }
    let expected = strip(&solved(&long()));
    assert!(strip(&read) == expected, "{} of {}", read.len(), expected.len());
    // A cancel reaches the other process, too.
    let id = submit(&client, &server.url, "/v1/jobs", &long()).await;
    stored(&client, &server.url, &id, 1).await;
    let cancelled = client.post(format!("{}/v1/jobs/{id}/cancel", server.url)).send().await.expect("an answer");
    assert_eq!(cancelled.status(), 202);
    let job = until(&client, &server.url, &format!("/v1/jobs/{id}"), has_ended).await;
    assert_eq!(job["status"], "cancelled");
    // Both go down in good order.
    assert_eq!(worker.terminated().await.0, Some(0));
    assert_eq!(server.terminated().await.0, Some(0));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_that_is_killed_costs_its_job_nothing_but_time() {
    let Some(postgres) = shared() else { return };
    let database = postgres.database().await;
    let client = client();
    let expected = strip(&solved(&long()));
    let server = Process::serve(&database, &SERVER);
    let mut worker = Process::work(&database, &WORKER);
    let id = submit(&client, &server.url, "/v1/jobs", &long()).await;
    for reached in [1, 3000, 9000] {
        stored(&client, &server.url, &id, reached).await;
        worker.kill();
        worker = Process::work(&database, &WORKER);
    }
    let job = assert_undisturbed(&client, &server.url, &id, &expected).await;
    assert!(job["attempt"].as_u64() >= Some(2), "the kills hit nothing: {job}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_that_was_halted_past_its_lease_writes_nothing_more() {
    let Some(postgres) = shared() else { return };
    let database = postgres.database().await;
    let client = client();
    // It outlasts the first halt where that was the other's.
    let job = in_short_steps("one-bar-truss", 60_000, 60_000);
    let expected = strip(&solved(&job));
    let server = Process::serve(&database, &SERVER);
    let (one, other) = (Process::work(&database, &WORKER), Process::work(&database, &WORKER));
    let id = submit(&client, &server.url, "/v1/jobs", &job).await;
    let place = format!("/v1/jobs/{id}");
    stored(&client, &server.url, &id, 500).await;
    // Whichever has the job: it is taken from that one, and goes on with it.
    one.stop();
    tokio::time::sleep(Duration::from_millis(1500)).await;
    one.go_on();
    other.stop();
    tokio::time::sleep(Duration::from_millis(1500)).await;
    let job = get(&client, &server.url, &place).await.expect("the job");
    other.go_on();
    let ended = assert_undisturbed(&client, &server.url, &id, &expected).await;
    assert!(ended["attempt"].as_u64() >= Some(2), "the halts hit nothing: {job} {ended}");
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert_eq!(get(&client, &server.url, &place).await.expect("the job"), ended);
    assert!(strip(&lines(&client, &server.url, &id).await) == expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_that_is_cut_off_loses_its_job_or_goes_on_and_nothing_else() {
    let Some(postgres) = shared() else { return };
    let database = postgres.database().await;
    let client = client();
    let proxy = Proxy::to(postgres.port()).await;
    let expected = strip(&solved(&long()));
    let server = Process::serve(&database, &SERVER);
    let far = Process::work(&proxy.of(&database, postgres.port()), &WORKER);
    let first = submit(&client, &server.url, "/v1/jobs", &long()).await;
    stored(&client, &server.url, &first, 100).await;
    // Again and again for a moment, in the middle of whatever it is doing.
    for _ in 0..10 {
        proxy.cut();
        tokio::time::sleep(Duration::from_millis(20)).await;
        proxy.whole();
        tokio::time::sleep(Duration::from_millis(60)).await;
    }
    assert_undisturbed(&client, &server.url, &first, &expected).await;
    // For longer than the lease, and without a word: the job is another's.
    let second = submit(&client, &server.url, "/v1/jobs", &long()).await;
    stored(&client, &server.url, &second, 100).await;
    proxy.dumb();
    let near = Process::work(&database, &WORKER);
    let job = assert_undisturbed(&client, &server.url, &second, &expected).await;
    assert!(job["attempt"].as_u64() >= Some(2), "{job}");
    assert_eq!(near.terminated().await.0, Some(0));
    // It comes back and works.
    proxy.whole();
    let third = submit(&client, &server.url, "/v1/jobs", &scene("klarbring")).await;
    assert_undisturbed(&client, &server.url, &third, &strip(&solved(&scene("klarbring")))).await;
    assert!(strip(&lines(&client, &server.url, &second).await) == expected);
    drop(far);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_that_crashes_and_comes_back_loses_nothing() {
    let Some(postgres) = Postgres::start(false) else { return };
    let database = postgres.database().await;
    let client = client();
    let expected = strip(&solved(&long()));
    let server = Process::serve(&database, &SERVER);
    let workers = [Process::work(&database, &WORKER), Process::work(&database, &WORKER)];
    let mut ids = Vec::new();
    for _ in 0..3 {
        ids.push(submit(&client, &server.url, "/v1/jobs", &long()).await);
    }
    for (reached, away) in [(200, 50), (1500, 6000)] {
        stored(&client, &server.url, &ids[0], reached).await;
        let begun = postgres.crash(Duration::from_millis(away));
        let answer = async {
            tokio::time::sleep(Duration::from_millis(away / 10)).await;
            client.get(format!("{}/readyz", server.url)).send().await.expect("an answer").status()
        };
        let ((), ready) = tokio::join!(begun, answer);
        assert!(away < 1000 || ready == 503, "{ready}: not ready while it is away");
    }
    for id in &ids {
        assert_undisturbed(&client, &server.url, id, &expected).await;
    }
    let ready = until(&client, &server.url, "/readyz", |answer| answer["status"] == "ready").await;
    assert_eq!(ready["workers"], 0);
    for worker in workers {
        assert_eq!(worker.terminated().await.0, Some(0));
    }
}

/// Small jobs by the hundred, and workers killed at random: none is lost, and none is worked on to its end twice.
#[tokio::test(flavor = "multi_thread")]
async fn of_many_small_jobs_none_is_lost_or_ends_twice_under_twenty_kills() {
    const JOBS: usize = 400;
    let Some(database) = Database::postgres().await else { return };
    let place = database.location.to_string();
    let client = client();
    // Jobs of the last kind last: some are under way at every kill, however fast the machine.
    let kinds = [scene("klarbring"), scene("one-bar-truss"), in_short_steps("one-bar-truss", 1000, 1000)];
    let expected: Vec<Vec<String>> = kinds.iter().map(|request| strip(&solved(request))).collect();
    let server = Process::serve(&place, &SERVER);
    let mut random = Random::fixed();
    let mut workers = vec![Process::work(&place, &WORKER), Process::work(&place, &WORKER)];
    let mut jobs = Vec::new();
    let mut interrupted = 0;
    for round in 0..20 {
        for number in 0..JOBS / 20 {
            let kind = number % kinds.len();
            jobs.push((kind, submit(&client, &server.url, "/v1/jobs", &kinds[kind]).await));
        }
        tokio::time::sleep(Duration::from_millis(20 + random.next(180))).await;
        if let Some(running) = get(&client, &server.url, "/v1/jobs?status=running").await {
            interrupted += running["jobs"].as_array().map_or(0, Vec::len);
        }
        workers.remove(round % 2).kill();
        workers.insert(round % 2, Process::work(&place, &WORKER));
    }
    let mut attempts = 0;
    for (kind, id) in &jobs {
        let job = assert_undisturbed(&client, &server.url, id, &expected[*kind]).await;
        attempts += job["attempt"].as_u64().expect("a number");
    }
    println!("{} jobs, {attempts} attempts, about {interrupted} running at the kills", jobs.len());
    assert!(attempts > jobs.len() as u64, "the kills hit nothing");
    assert_eq!(database.count("jobs").await, JOBS as i64);
    for left in ["checkpoints", "checkpoint_trails"] {
        assert_eq!(database.count(left).await, 0, "{left}");
    }
}
