//! Checking what is posted: long checks hold nobody up, end with their callers, and have a bound.

use crate::common::server::{TestServer, settings};
use crate::common::service::{request, scene};
use crate::common::solver::MadeUp;
use arcslip::check::judged::{JudgedCheckpoint, JudgedReport};
use arcslip::model::{InputErrors, JobRequest};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::plan::Plan;
use arcslip::service::jobs::solving::solver::{Accept, Beginning, ResumeError};
use arcslip::service::jobs::{Limits, Settings, Solver};
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// What every run of these sweeps takes to be checked, and how many there are.
const EACH: Duration = Duration::from_millis(5);
const RUNS: u64 = 20_000;

/// Plans of models that are friction's take their time, and are counted.
#[derive(Clone, Default)]
struct Slow {
    made_up: MadeUp,
    planned: Arc<AtomicU64>,
}

impl Solver for Slow {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        if request.model.contacts[0].friction < 0.2 {
            std::thread::sleep(EACH);
            self.planned.fetch_add(1, Ordering::Relaxed);
        }
        self.made_up.plan(request)
    }

    fn check_beginning(&self, request: &JobRequest, beginning: Beginning) -> Result<(), InputErrors> {
        self.made_up.check_beginning(request, beginning)
    }

    fn solve(
        &self,
        request: &JobRequest,
        beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, InputErrors> {
        self.made_up.solve(request, beginning, cancel, accept)
    }

    fn resume(
        &self,
        request: &JobRequest,
        checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, ResumeError> {
        self.made_up.resume(request, checkpoint, cancel, accept)
    }
}

fn long_sweep() -> Value {
    let mut request = scene("one-bar-truss");
    let values: Vec<f64> = (0..RUNS).map(|number| 0.1 + number as f64 * 1e-6).collect();
    request["sweep"] = json!({"replace": {"/model/contacts/0/friction": values}});
    request
}

/// Posts it and does not wait for the answer.
fn posted(server: &TestServer, place: &str, body: &Value) -> TcpStream {
    let body = body.to_string();
    let mut stream = TcpStream::connect(server.address()).expect("connected");
    let (host, length) = (server.address(), body.len());
    let head = format!(
        "POST {place} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\ncontent-length: {length}\r\n\r\n"
    );
    stream.write_all((head + &body).as_bytes()).expect("sent");
    stream
}

#[tokio::test(flavor = "multi_thread")]
async fn long_checks_hold_nobody_up_and_end_when_their_callers_have_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let solver = Slow::default();
    let server = TestServer::start_with(&folder.path().join("jobs.db"), solver.clone(), settings()).await;
    // Twice as many as can be checked at a time.
    let many = 4 * std::thread::available_parallelism().map_or(1, usize::from);
    let callers: Vec<TcpStream> = (0..many).map(|_| posted(&server, "/v1/sweeps", &long_sweep())).collect();
    let planned = || solver.planned.load(Ordering::Relaxed);
    while planned() < 200 {
        tokio::time::sleep(EACH).await;
    }
    for number in 0..20 {
        server.submit(&request(&format!("beside {number}"), 2)).await;
    }
    let all = many as u64 * RUNS;
    assert!(planned() < all / 2, "they were checked before");
    drop(callers);
    // Until none is checked any more.
    let mut before = planned();
    loop {
        tokio::time::sleep(100 * EACH).await;
        let now = planned();
        if now == before {
            break;
        }
        before = now;
    }
    assert!(planned() < all / 2, "{} of {all} were checked to the end", planned());
    assert!(server.get_json("/v1/sweeps").await["sweeps"].as_array().expect("sweeps").is_empty());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_check_that_takes_too_long_is_refused_with_the_bound() {
    let folder = tempfile::tempdir().expect("a folder");
    let limits = Limits { check_time: Duration::from_millis(500), ..Limits::default() };
    let settings = Settings { limits, ..settings() };
    let server = TestServer::start_with(&folder.path().join("jobs.db"), Slow::default(), settings).await;
    let answer = server.post("/v1/sweeps", &long_sweep()).await;
    assert_eq!(answer.status(), 422);
    let problem: Value = answer.json().await.expect("a problem");
    assert_eq!(problem["type"], "/problems/check-time-limit", "{problem}");
    assert!(problem["detail"].as_str().expect("text").contains("0.500 s"), "{problem}");
    assert!(server.get_json("/v1/jobs").await["jobs"].as_array().expect("jobs").is_empty());
}

/// Announced bodies take no room before they come.
#[tokio::test(flavor = "multi_thread")]
async fn slow_bodies_hold_nobody_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let (host, length) = (server.address(), 16 << 20);
    let slow: Vec<TcpStream> = (0..40)
        .map(|_| {
            let mut stream = TcpStream::connect(host).expect("connected");
            let head = format!("POST /v1/jobs HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\n");
            write!(stream, "{head}content-length: {length}\r\n\r\n{{").expect("sent");
            stream.set_nonblocking(true).expect("it does not block");
            stream
        })
        .collect();
    // Until they are being read, or most of them.
    tokio::time::sleep(100 * EACH).await;
    server.submit(&request("beside slow bodies", 2)).await;
    for stream in slow {
        let read = stream.peek(&mut [0]);
        assert!(read.is_err_and(|error| error.kind() == std::io::ErrorKind::WouldBlock), "it has been answered before");
    }
}
