//! `/metrics`: its text is what Prometheus reads, its values move with what happens, and its labels are few.

use crate::common::faulty_store::FaultyStore;
use crate::common::process::PATIENCE;
use crate::common::server::{TestServer, settings};
use crate::common::service::{in_short_steps, request, scene};
use crate::common::solver::MadeUp;
use arcslip::service::jobs::{PathSolver, Settings};
use arcslip::service::store;
use reqwest::{Method, StatusCode};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Samples by their name with labels, as they are written.
struct Samples(BTreeMap<String, f64>);

impl Samples {
    async fn of(server: &TestServer) -> Self {
        let answer = server.get("/metrics").await;
        assert_eq!(answer.status(), StatusCode::OK);
        let media_type = answer.headers()["content-type"].to_str().expect("text").to_owned();
        assert_eq!(media_type, "application/openmetrics-text; version=1.0.0; charset=utf-8");
        Self::parse(&answer.text().await.expect("a body"))
    }

    /// Line by line: what is described, of what type, and its samples; then the end.
    fn parse(text: &str) -> Self {
        let body = text.strip_suffix("# EOF\n").expect("an end");
        let (mut types, mut described) = (BTreeMap::new(), BTreeSet::new());
        let mut samples = BTreeMap::new();
        for line in body.lines() {
            if let Some(rest) = line.strip_prefix("# ") {
                let mut words = rest.splitn(3, ' ');
                let (what, name, value) = (words.next(), words.next().expect("a name"), words.next().expect("a value"));
                match what {
                    Some("HELP") => assert!(described.insert(name.to_owned()), "{name} is described twice"),
                    Some("TYPE") => {
                        assert!(matches!(value, "counter" | "gauge" | "histogram"), "{line}");
                        assert!(types.insert(name.to_owned(), value.to_owned()).is_none(), "{line}");
                    }
                    _ => panic!("{line}"),
                }
                continue;
            }
            let (sample, value) = line.rsplit_once(' ').unwrap_or_else(|| panic!("no value: {line}"));
            let name = sample.split('{').next().expect("a name");
            let family = types.keys().find(|family| {
                let endings: &[&str] = match types[*family].as_str() {
                    "counter" => &["_total"],
                    "histogram" => &["_bucket", "_sum", "_count"],
                    _ => &[""],
                };
                endings.iter().any(|ending| name == format!("{family}{ending}"))
            });
            assert!(family.is_some_and(|family| described.contains(family)), "{name} is not described");
            assert!(name.starts_with("arcslip_"), "{line}");
            if let Some(labels) = sample.strip_prefix(name).filter(|labels| !labels.is_empty()) {
                let labels = labels.strip_prefix('{').and_then(|labels| labels.strip_suffix('}')).expect("labels");
                // Routes hold braces, and no commas.
                for label in labels.split(',') {
                    let (key, value) = label.split_once('=').unwrap_or_else(|| panic!("{line}"));
                    assert!(key.bytes().all(|byte| byte.is_ascii_lowercase()), "{line}");
                    assert!(value.len() >= 2 && value.starts_with('"') && value.ends_with('"'), "{line}");
                }
            }
            let value: f64 = value.parse().unwrap_or_else(|_| panic!("{line}"));
            assert!(value >= 0.0, "{line}");
            assert!(samples.insert(sample.to_owned(), value).is_none(), "twice: {line}");
        }
        assert_eq!(types.len(), described.len());
        Self(samples)
    }

    fn get(&self, sample: &str) -> f64 {
        self.0.get(&format!("arcslip_{sample}")).copied().unwrap_or(0.0)
    }

    fn jobs(&self, status: &str) -> f64 {
        self.get(&format!("jobs{{status=\"{status}\"}}"))
    }
}

async fn start(folder: &Path, solver: impl arcslip::service::jobs::Solver, settings: Settings) -> TestServer {
    TestServer::start_with(&folder.join("jobs.db"), solver, settings).await
}

#[tokio::test]
async fn what_a_job_does_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path(), PathSolver, settings()).await;
    let before = Samples::of(&server).await;
    assert_eq!((before.get("increments_total"), before.jobs("completed")), (0.0, 0.0));
    assert_eq!((before.get("workers_alive"), before.get("workers_expected")), (2.0, 2.0));
    assert!(before.get("resident_memory_bytes") > 1e6 && before.get("open_files") > 3.0);
    let id = server.submit(&scene("klarbring")).await;
    let job = server.ended(&id).await;
    let lines = server.lines(&id).await.len() as f64;
    let after = Samples::of(&server).await;
    assert_eq!(after.get("increments_total"), lines);
    assert_eq!(after.jobs("completed"), 1.0);
    assert_eq!(after.get("queue_wait_seconds_count"), 1.0);
    let is_counted = |samples: &Samples, write: &str| {
        let of = |part: &str| samples.get(&format!("store_write_seconds_{part}{{write=\"{write}\"}}"));
        of("count") >= 1.0 && of("sum") > 0.0 && of("sum") < 60.0
    };
    assert!(is_counted(&after, "submit") && is_counted(&after, "finish"));
    assert!(after.get("store_write_seconds_count{write=\"claim\"}") > 1.0, "one took the job, another found none");
    for (kind, reported) in [
        ("factorisation", "factorisations"),
        ("newton_iteration", "newton_iterations"),
        ("qp_solve", "qp_solves"),
        ("mpec_solve", "mpec_solves"),
    ] {
        let counted = after.get(&format!("solver_steps_total{{kind=\"{kind}\"}}"));
        let reported = job["report"][reported].as_f64().expect("a number");
        assert!(counted <= reported && counted >= 0.5 * reported, "{kind}: {counted} of {reported}");
    }
    let solved = after.get("solve_seconds_total");
    assert!(solved > 0.0 && solved < 60.0, "{solved}");
    // The increments of a short job are stored with its end, those of a longer one before.
    let long = server.submit(&in_short_steps("one-bar-truss", 3_000, 5_500)).await;
    server.ended(&long).await;
    assert!(is_counted(&Samples::of(&server).await, "append"));
}

#[tokio::test]
async fn calls_are_counted_by_route_and_never_by_what_they_ask_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path(), MadeUp::default(), settings()).await;
    let id = server.submit(&request("counted", 4)).await;
    server.ended(&id).await;
    let before = Samples::of(&server).await;
    for _ in 0..3 {
        assert_eq!(server.get(&format!("/v1/jobs/{id}")).await.status(), 200);
    }
    assert_eq!(server.get(&format!("/v1/jobs/{id}?cut=short")).await.status(), 400, "it has no parameters");
    assert_eq!(server.get("/v1/jobs/none").await.status(), 400);
    assert_eq!(server.get(&format!("/nowhere/{id}")).await.status(), 404);
    let strange = Method::from_bytes(id.replace('-', "").as_bytes()).expect("a method");
    assert_eq!(server.ask(strange, "/healthz").send().await.expect("an answer").status(), 405);
    let after = Samples::of(&server).await;
    let moved = |sample: &str| after.get(sample) - before.get(sample);
    let answered = |method: &str, route: &str, status: u16| {
        moved(&format!("http_requests_total{{method=\"{method}\",route=\"{route}\",status=\"{status}\"}}"))
    };
    assert_eq!(answered("GET", "/v1/jobs/{id}", 200), 3.0);
    assert_eq!(answered("GET", "/v1/jobs/{id}", 400), 2.0);
    assert_eq!(answered("GET", "none", 404), 1.0);
    assert_eq!(answered("other", "/healthz", 405), 1.0);
    assert_eq!(moved("http_request_seconds_count{method=\"GET\",route=\"/v1/jobs/{id}\"}"), 5.0);
    let labelled = after.0.keys().filter(|sample| sample.contains(&id) || sample.contains(&id.replace('-', "")));
    assert_eq!(labelled.count(), 0, "no id is a label");
}

#[tokio::test]
async fn open_streams_and_their_lag_are_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(2);
    let server = start(folder.path(), solver.clone(), settings()).await;
    let id = server.submit(&request("followed", 6)).await;
    let mut streams = vec![server.stream(&id, None).await, server.stream(&id, None).await];
    for stream in &mut streams {
        assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some("0"));
        assert_eq!(stream.next().await.map(|event| event.id).as_deref(), Some("1"));
    }
    assert_eq!(Samples::of(&server).await.get("streams_open"), 2.0);
    let before = Samples::of(&server).await.get("stream_lag_seconds_count");
    // One goes away, the other one waits for what comes.
    drop(streams.pop());
    solver.let_go();
    let rest = streams.pop().expect("a stream").rest().await;
    assert_eq!(rest.len(), 5, "four increments and the end");
    let began = Instant::now();
    let after = loop {
        let samples = Samples::of(&server).await;
        if samples.get("streams_open") == 0.0 {
            break samples;
        }
        assert!(began.elapsed() < PATIENCE, "a stream is still counted");
        tokio::time::sleep(Duration::from_millis(20)).await;
    };
    let lags = after.get("stream_lag_seconds_count") - before;
    assert!((1.0..=8.0).contains(&lags), "{lags}");
    assert!(after.get("stream_lag_seconds_sum") < 10.0);
}

/// The tally is kept, not counted: whatever becomes of jobs, it stays what a count would give.
#[tokio::test]
async fn jobs_by_status_are_what_is_stored() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = MadeUp::holding_at(3);
    let one = Settings { workers: 1, ..settings() };
    let server = start(folder.path(), solver.clone(), one).await;
    let mut ids = Vec::new();
    for name in ["runs", "is cancelled", "is dropped", "waits"] {
        ids.push(server.submit(&request(name, 5)).await);
    }
    server.until(&ids[0], |job| job["progress"]["increments"] == 2).await;
    let told = |samples: &Samples| {
        ["queued", "running", "completed", "stopped", "cancelled", "failed"].map(|status| samples.jobs(status))
    };
    assert_eq!(told(&Samples::of(&server).await), [3.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    server.post(&format!("/v1/jobs/{}/cancel", ids[1]), &serde_json::Value::Null).await;
    server.ask(Method::DELETE, &format!("/v1/jobs/{}", ids[2])).send().await.expect("an answer");
    assert_eq!(told(&Samples::of(&server).await), [1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    solver.let_go();
    server.ended(&ids[0]).await;
    server.ended(&ids[3]).await;
    server.submit(&request(crate::common::solver::PANICS, 5)).await;
    let began = Instant::now();
    while Samples::of(&server).await.jobs("failed") < 1.0 {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    assert_eq!(told(&Samples::of(&server).await), [0.0, 0.0, 2.0, 0.0, 1.0, 1.0]);
    server.ask(Method::DELETE, &format!("/v1/jobs/{}", ids[3])).send().await.expect("an answer");
    assert_eq!(told(&Samples::of(&server).await), [0.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
}

#[tokio::test]
async fn without_its_database_the_service_still_tells_the_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = FaultyStore::around(store::open(&folder.path().join("jobs.db")).await.expect("a store"));
    let server = TestServer::start_on(store.clone(), MadeUp::default(), settings()).await;
    let id = server.submit(&request("stored", 5)).await;
    server.ended(&id).await;
    store.down.store(true, Ordering::Relaxed);
    let samples = Samples::of(&server).await;
    assert!(!samples.0.keys().any(|sample| sample.starts_with("arcslip_jobs")), "what is not known is not told");
    assert_eq!(samples.get("increments_total"), 5.0);
    store.down.store(false, Ordering::Relaxed);
    assert_eq!(Samples::of(&server).await.jobs("completed"), 1.0);
}
